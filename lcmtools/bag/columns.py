"""Messages of one type as columns: an array for each field, read without decoding each message.

The messages of a topic mostly have the same size and the same lengths of strings and arrays. Such
messages are rows of a table with one memory layout, taken from the first of them, and numpy reads a
field of all rows at once. Messages with other lengths form another table; if every message has its
own lengths, this is as slow as decoding each.
"""

import struct
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import TYPE_CHECKING, Any, TypeAlias

from lcmtools.errors import DecodeError
from lcmtools.messages.array_codec import FORMATS, Cursor, Malformed
from lcmtools.messages.fields import Field, fields, holds_itself, visible_fields
from lcmtools.messages.registry import Message, fingerprint, type_name

if TYPE_CHECKING:
    import numpy as np

    Array: TypeAlias = np.ndarray[Any, np.dtype[Any]]

TIME = "%time"  # the column of the times of arrival [ns since 1970]

_FINGERPRINT_BYTES = 8


@dataclass(frozen=True, slots=True)
class Table:
    """The decoded messages, as columns.

    Attributes:
        columns: An array for each field by its path ("pose.pose.position.x"), a row for each
            message. An array field has further axes, one for each of its dimensions; so has a
            field of an array of messages ("transforms.header.frame_id"). Where the lengths
            differ between messages, the elements of a column are arrays.
        malformed: The indices of the payloads that could not be decoded, which have no row.
    """

    columns: Mapping[str, "Array"]
    malformed: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class _Numbers:
    """A field of numbers, at the same offset in every row."""

    start: int
    code: str  # ``struct`` code
    sizes: tuple[int, ...]

    def read(self, rows: "Array") -> "Array":
        # numpy has the same codes as ``struct``; bytes other than 0 and 1 are booleans too
        code = "B" if self.code == "?" else f">{self.code}"
        found = _at(rows, self.start, code, self.sizes)
        numbers: Array = found != 0 if self.code == "?" else found
        return numbers.astype(numbers.dtype.newbyteorder("="))


@dataclass(frozen=True, slots=True)
class _Text:
    """A string, at the same offset in every row."""

    start: int
    size: int  # without its NUL [byte]

    def read(self, rows: "Array") -> "Array":
        import numpy as np

        first = rows[0, self.start : self.start + self.size].tobytes()
        found = _at(rows, self.start, f"S{self.size}") if self.size else None
        if found is None or (found == found[0]).all():  # the usual case for frame_id
            return np.full(len(rows), first.decode("utf-8", "replace"))
        decoded: Array = np.char.decode(found, "utf-8", "replace")
        return decoded


@dataclass(frozen=True, slots=True)
class _Stack:
    """The same field of each element of an array of messages, or an array of strings."""

    elements: "list[_Column]" = field(default_factory=list)

    def read(self, rows: "Array") -> "Array":
        import numpy as np

        found = [element.read(rows) for element in self.elements]
        if len({one.shape for one in found}) == 1:
            return np.stack(found, axis=1)
        ragged = np.empty((len(rows), len(found)), object)
        for place, one in enumerate(found):
            ragged[:, place] = list(one)
        return ragged


_Column: TypeAlias = "_Numbers | _Text | _Stack"


class _Plan:
    """The memory layout of a message, and of all others with the same size and lengths.

    Raises:
        Malformed: The payload cannot be a message of the class.
    """

    def __init__(self, cls: type[Message], payload: bytes) -> None:
        self.columns: dict[str, _Column] = {}
        self._cursor = Cursor(payload, _FINGERPRINT_BYTES)
        self._lengths: list[slice] = []  # the offsets of lengths
        self._add(cls, "", self.columns)

    def fits(self, rows: "Array") -> "Array":
        """Return for each row whether it has the plan's lengths."""
        import numpy as np

        fits = np.ones(len(rows), bool)
        for place in self._lengths:
            fits &= _are(rows, place.start, self._cursor.data[place])
        return fits

    def _add(self, cls: type[Message], path: str, columns: dict[str, _Column]) -> None:
        lengths: dict[str, int] = {}
        for part in fields(cls):
            where = f"{path}{part.name}"
            if part.is_length:
                lengths[part.name] = self._length(f">{FORMATS[part.type]}", where)
                continue
            sizes = [lengths[size] if isinstance(size, str) else size for size in part.dimensions]
            if min(sizes, default=0) < 0:
                raise Malformed(f"negative length at {where}")
            self._add_field(part, sizes, where, columns)

    def _add_field(
        self, part: Field, sizes: Sequence[int], where: str, columns: dict[str, _Column]
    ) -> None:
        code = FORMATS.get(part.type)
        if code:
            start = self._cursor.advance(prod(sizes) * struct.calcsize(code), where)
            columns[where] = _Numbers(start, code, tuple(sizes))
        elif part.message_class is None:
            columns[where] = self._text(sizes, where)
        elif not sizes:
            self._add(part.message_class, f"{where}.", columns)
        else:
            columns.update(self._messages(part.message_class, sizes, f"{where}."))

    def _messages(self, cls: type[Message], sizes: Sequence[int], path: str) -> dict[str, _Column]:
        """Return the columns of an array of messages: a stack for each field."""
        stacks = {name: _Stack() for name in _paths(cls, path)}
        self._cursor.enter(path)
        for _ in self._elements(sizes[0], bool(fields(cls)), path):
            found: dict[str, _Column] = {}
            if sizes[1:]:
                found = self._messages(cls, sizes[1:], path)
            else:
                self._add(cls, path, found)
            for name, column in found.items():
                stacks[name].elements.append(column)
        self._cursor.depth -= 1
        return dict(stacks)

    def _text(self, sizes: Sequence[int], where: str) -> _Column:
        if sizes:
            elements = self._elements(sizes[0], 1, where)
            return _Stack([self._text(sizes[1:], where) for _ in elements])
        size = self._length(">I", where)
        start = self._cursor.advance(size, where)
        return _Text(start, max(0, size - 1))

    def _elements(self, count: int, least_bytes: int, where: str) -> range:
        self._cursor.expect(count, least_bytes, where)
        return range(count)

    def _length(self, form: str, where: str) -> int:
        size = struct.calcsize(form)
        start = self._cursor.advance(size, where)
        self._lengths.append(slice(start, start + size))
        (length,) = struct.unpack_from(form, self._cursor.data, start)
        return int(length)


def require_columns(cls: type[Message]) -> None:
    """Raise DecodeError for a type that contains itself: it would have infinitely many columns."""
    if holds_itself(cls):
        raise DecodeError(f"{type_name(cls)} contains itself, which columns cannot represent")


def table(cls: type[Message], payloads: Sequence[bytes]) -> Table:
    """Return messages of a type as columns; payloads of other types count as malformed.

    Raises:
        DecodeError: The type contains itself.
    """
    require_columns(cls)
    tables: list[tuple[Array, dict[str, Array]]] = []
    malformed: list[int] = []
    start = fingerprint(cls).to_bytes(_FINGERPRINT_BYTES, "big")
    for places, rows in _by_size(payloads):
        if rows.shape[1] < _FINGERPRINT_BYTES:
            malformed += places.tolist()
            continue
        is_of_class = _are(rows, 0, start)
        malformed += places[~is_of_class].tolist()
        malformed += _read(cls, *_some(is_of_class, places, rows), tables)
    return Table(_joined(cls, tables), tuple(sorted(malformed)))


def with_times(times: Sequence[int], made: Table) -> "Mapping[str, Array]":
    """Return the columns of messages that arrived at these times [ns], the times first."""
    import numpy as np

    arrived = np.array(times, np.int64)
    if made.malformed:
        arrived = np.delete(arrived, made.malformed)
    return {TIME: arrived, **made.columns}


def _read(
    cls: type[Message],
    places: "Array",
    rows: "Array",
    tables: "list[tuple[Array, dict[str, Array]]]",
) -> list[int]:
    """Add the columns of messages of one size, with indices; return the malformed ones'."""
    malformed = []
    while len(places):
        try:
            plan = _Plan(cls, rows[0].tobytes())
        except Malformed:
            malformed.append(int(places[0]))
            places, rows = places[1:], rows[1:]
            continue
        fits = plan.fits(rows)
        there, some = _some(fits, places, rows)
        tables.append((there, {name: one.read(some) for name, one in plan.columns.items()}))
        places, rows = _some(~fits, places, rows)
    return malformed


def _by_size(payloads: Sequence[bytes]) -> "Iterator[tuple[Array, Array]]":
    """Yield the indices of the payloads of each size, and their bytes, one row each."""
    import numpy as np

    sizes = np.fromiter(map(len, payloads), np.int64, len(payloads))
    for size in np.unique(sizes).tolist():
        places = np.flatnonzero(sizes == size)
        data = b"".join(payloads[place] for place in places.tolist())
        yield places, np.frombuffer(data, np.uint8).reshape(len(places), size)


def _some(fits: "Array", places: "Array", rows: "Array") -> "tuple[Array, Array]":
    return (places, rows) if fits.all() else (places[fits], rows[fits])


def _joined(
    cls: type[Message], tables: "Sequence[tuple[Array, dict[str, Array]]]"
) -> "dict[str, Array]":
    """Return the rows of all tables in order; the first of each pair has the rows' indices."""
    import numpy as np

    if not tables:
        return {name: np.empty(0) for name in _paths(cls, "")}
    if len(tables) == 1:
        return tables[0][1]
    order = np.argsort(np.concatenate([places for places, _ in tables]))
    return {name: _rows([columns[name] for _, columns in tables])[order] for name in tables[0][1]}


def _rows(parts: "Sequence[Array]") -> "Array":
    import numpy as np

    if len({part.shape[1:] for part in parts}) == 1:
        return np.concatenate(parts)
    rows = np.empty(sum(map(len, parts)), object)
    rows[:] = [row for part in parts for row in part]
    return rows


def _paths(cls: type[Message], path: str) -> Iterator[str]:
    for part in visible_fields(cls):
        if part.message_class is None:
            yield f"{path}{part.name}"
        else:
            yield from _paths(part.message_class, f"{path}{part.name}.")


def _are(rows: "Array", start: int, data: bytes) -> "Array":
    """Return for each row whether these bytes, of one number, are at an offset."""
    found: Array = _at(rows, start, f"u{len(data)}") == int.from_bytes(data, sys.byteorder)
    return found


def _at(rows: "Array", start: int, code: str, sizes: tuple[int, ...] = ()) -> "Array":
    """Return a view of the values at one offset in every row."""
    import numpy as np

    form = np.dtype(code)
    inner = [form.itemsize * prod(sizes[place + 1 :]) for place in range(len(sizes))]
    strides = (rows.strides[0], *inner)
    return np.ndarray((len(rows), *sizes), form, rows, start, strides)
