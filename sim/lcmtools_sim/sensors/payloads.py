"""The payloads of many robots' messages of one kind, filled by arrays."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from lcmtools.messages.payload_template import PayloadTemplate

Row = Sequence[float]
"""The numbers of one hole of a template; arrays, where they are many robots'."""

_Bytes = npt.NDArray[np.uint8]


class Payloads:
    """Payloads of which only the numbers in the templates' holes change.

    Args:
        templates: Of one kind of message; each with its robot's place in the rows.
    """

    def __init__(self, templates: Sequence[tuple[PayloadTemplate, int]]) -> None:
        alike: dict[object, list[int]] = {}
        for number, (template, _) in enumerate(templates):
            # the robots' names are in the payloads, and may differ in length
            alike.setdefault((len(template.payload), template.holes), []).append(number)
        self._tables = [_Table(numbers, templates) for numbers in alike.values()]
        self._count = len(templates)

    def fill(self, rows: Sequence[Row], count: int) -> list[bytes]:
        """The payloads with these numbers of so many robots, a row for each hole."""
        packed = [_packed(row, count) for row in rows]
        payloads = [b""] * self._count
        for table in self._tables:
            for number, payload in table.filled(packed):
                payloads[number] = payload
        return payloads


class _Table:
    """Payloads with holes at the same places, one a row.

    Args:
        numbers: Theirs among all.
        templates: All.
    """

    def __init__(
        self, numbers: Sequence[int], templates: Sequence[tuple[PayloadTemplate, int]]
    ) -> None:
        self._numbers = numbers
        self._holes = templates[numbers[0]][0].holes
        payloads = [np.frombuffer(templates[number][0].payload, np.uint8) for number in numbers]
        self._bytes = np.array(payloads)
        places = [templates[number][1] for number in numbers]
        first, count = places[0], len(places)
        is_run = places == list(range(first, first + count))
        self._robots = slice(first, first + count) if is_run else np.array(places)  # a view is fast

    def filled(self, packed: Sequence[_Bytes]) -> Iterator[tuple[int, bytes]]:
        """The payloads with these bytes of all robots in the holes; each with its number."""
        for (start, end), row in zip(self._holes, packed, strict=True):
            self._bytes[:, start:end] = row[self._robots]
        payloads = self._bytes.view(f"V{self._bytes.shape[1]}")[:, 0]
        return zip(self._numbers, payloads.tolist(), strict=True)


def _packed(row: Row, count: int) -> _Bytes:
    """The bytes of a row's numbers in a message, for each robot."""
    numbers = np.empty((count, len(row)), ">i4" if isinstance(row[0], int) else ">f8")
    for column, values in enumerate(row):
        numbers[:, column] = values
    return numbers.view(np.uint8)
