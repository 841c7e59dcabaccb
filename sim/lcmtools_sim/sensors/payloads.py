"""The payloads of many robots' messages of one kind, filled from arrays."""

import re
import struct
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from lcmtools.messages.payload_template import PayloadTemplate

Row = Sequence[float]  # the numbers of a template's hole; arrays for many robots (see ``Value``)


class Payloads:
    """Payloads of which only the numbers in the templates' holes change.

    The templates are of one kind of message, each with its robot's index in the rows.
    """

    def __init__(self, templates: Sequence[tuple[PayloadTemplate, int]]) -> None:
        alike: dict[object, list[int]] = {}
        for number, (template, _) in enumerate(templates):
            # the robots' names are in the payloads, and may differ in length
            alike.setdefault((len(template.payload), template.holes), []).append(number)
        self._tables = [_Table(numbers, templates) for numbers in alike.values()]
        self._count = len(templates)

    def fill(self, rows: Sequence[Row]) -> list[bytes]:
        """Return the payloads with these numbers, a row for each hole."""
        payloads = [b""] * self._count
        for table in self._tables:
            for number, payload in table.filled(rows):
                payloads[number] = payload
        return payloads


class _Table:
    """Payloads with holes at the same offsets, one per row, for the templates of these numbers."""

    def __init__(
        self, numbers: Sequence[int], templates: Sequence[tuple[PayloadTemplate, int]]
    ) -> None:
        self._numbers = numbers
        chosen = [templates[number] for number in numbers]
        self._bytes = np.array([np.frombuffer(one.payload, np.uint8) for one, _ in chosen])
        self._columns = [list(self._of_hole(*hole)) for hole in chosen[0][0].holes]
        indices = [index for _, index in chosen]
        run = range(indices[0], indices[0] + len(indices))
        # a slice, which is a view, is faster than indices
        self._robots = slice(run.start, run.stop) if indices == list(run) else np.array(indices)

    def filled(self, rows: Sequence[Row]) -> Iterator[tuple[int, bytes]]:
        """Yield the payloads filled with all robots' numbers, each with its template's number."""
        for columns, row in zip(self._columns, rows, strict=True):
            for column, values in zip(columns, row, strict=True):
                is_one = isinstance(values, (int, float))
                column[...] = values if is_one else values[self._robots]  # type: ignore[index] # an array
        payloads = self._bytes.view(f"V{self._bytes.shape[1]}")[:, 0]
        return zip(self._numbers, payloads.tolist(), strict=True)

    def _of_hole(self, start: int, codes: str) -> Iterator[npt.NDArray[np.generic]]:
        """Yield the numbers of a hole in all payloads, as views of their bytes."""
        count, size = self._bytes.shape
        for times, code in re.findall(r"(\d+)(\D)", codes):
            for _ in range(int(times)):
                yield np.ndarray(count, f">{code}", self._bytes, start, (size,))
                start += struct.calcsize(f">{code}")
