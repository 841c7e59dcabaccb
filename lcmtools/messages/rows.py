"""Arrays and strings in a payload, and the cursor that never reads past a payload's end.

Belongs here: LCM's encoding. Numbers are big-endian; a boolean is one byte; a string is its length
with the closing NUL (4 bytes), UTF-8 and NUL; an array is its elements row by row, its sizes are
elsewhere. Must not know messages. Writing raises whatever Python raises for a value that is not
plain; reading raises Malformed.
"""

import struct
from collections.abc import Sequence, Sized
from dataclasses import dataclass
from math import prod
from typing import Protocol

from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.messages.shape import as_bytes, as_sequence

_TYPES = ("bool", "uint8", "int8", "int16", "int32", "int64", "float32", "float64")
FORMATS = dict(zip(_TYPES, "?Bbhiqfd", strict=True))
"""The ``struct`` codes of the primitive types of fixed size."""
BOOLEANS: dict[object, bool] = {False: False, True: True}
"""The values accepted as booleans; ``struct`` alone takes any object for true."""
STRING_BYTES = 4
"""The size of an empty string: its length, which counts its NUL."""

# Elements without bytes (empty messages, empty rows) that one payload may claim to hold: without a
# limit, 4 bytes could claim two thousand million of them.
_MOST_WEIGHTLESS = 65_536
_DEEPEST = 100  # levels of arrays of messages; only a type that holds itself could have as many
_LENGTH = struct.Struct(">I")


class Malformed(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """A payload that cannot be what its fingerprint says."""


@dataclass(slots=True)
class Cursor:
    """A payload and the offset of its unread rest."""

    data: bytes
    offset: int
    stray: str = "replace"  # the error handler for bytes in strings that are not UTF-8
    depth: int = 0
    weightless: int = _MOST_WEIGHTLESS

    def take(self, size: int, where: str) -> int:
        """Go on by ``size`` bytes and return where they start."""
        start = self.offset
        end = start + size
        if not start <= end <= len(self.data):
            raise self._wrong_size(size, where)
        self.offset = end
        return start

    def expect(self, count: int, size: int, where: str) -> None:
        """Check, before anything is made, that ``count`` elements of ``size`` bytes can follow."""
        if count < 0 or count * size > len(self.data) - self.offset:
            raise self._wrong_size(count * size or count, where)
        if not size:
            self.weightless -= count
            if self.weightless < 0:
                raise Malformed(f"{count} elements of no size claimed at {where}")

    def enter(self, where: str) -> None:
        """Begin an array of messages; ``depth`` is to be lowered at its end."""
        self.depth += 1
        if self.depth > _DEEPEST:
            raise Malformed(f"nested more than {_DEEPEST} levels deep at {where}")

    def _wrong_size(self, size: int, where: str) -> Malformed:
        if size < 0:
            return Malformed(f"negative length at {where}")
        return Malformed(f"{size} bytes wanted at {where}, {len(self.data) - self.offset} left")


class ArrayCodec(Protocol):
    """An array of one dimension: ``smallest`` is the least size of an element [byte]."""

    smallest: int

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append the bytes of all elements, of which there must be ``count``."""

    def read(self, count: int, cursor: Cursor) -> object:
        """Return ``count`` elements."""


def primitive_array(type_name: str, where: str, *, is_bytes: bool) -> ArrayCodec:
    """Return the codec of arrays of a primitive type; ``where`` is its place, for errors."""
    if type_name == "string":
        return _Strings(where)
    return _Bytes(where) if is_bytes else _Numbers(FORMATS[type_name], where)


class _Numbers:
    def __init__(self, code: str, where: str) -> None:
        self._code = code
        self._where = where
        self.smallest = struct.calcsize(f">{code}")

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        numbers = as_sequence(values)
        if self._code == "?":
            numbers = [BOOLEANS[value] for value in numbers]
        parts.append(struct.pack(f">{count}{self._code}", *numbers))

    def read(self, count: int, cursor: Cursor) -> object:
        """Return numbers as a tuple, booleans as a list, as lcm-gen's decoders do."""
        data, start = cursor.data, cursor.offset
        end = start + count * self.smallest
        if not start <= end <= len(data):  # not take() at once: short arrays are slower by its call
            cursor.take(count * self.smallest, self._where)
        cursor.offset = end
        numbers = struct.unpack_from(f">{count}{self._code}", data, start)
        return list(numbers) if self._code == "?" else numbers


class _Bytes:
    """Bytes, as one ``bytes``; written without a copy where they are one."""

    smallest = 1

    def __init__(self, where: str) -> None:
        self._where = where

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        data = values if type(values) is bytes else as_bytes(values)
        check_count(data, count)
        parts.append(data)

    def read(self, count: int, cursor: Cursor) -> bytes:
        start = cursor.take(count, self._where)
        return cursor.data[start : start + count]


class _Strings:
    smallest = STRING_BYTES

    def __init__(self, where: str) -> None:
        self._where = where

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        strings = as_sequence(values)
        check_count(strings, count)
        for value in strings:
            write_string(value, parts)

    def read(self, count: int, cursor: Cursor) -> list[str]:
        cursor.expect(count, self.smallest, self._where)
        return [read_string(cursor, self._where) for _ in range(count)]


class Array:
    """An array of several dimensions, made of rows of one kind."""

    def __init__(self, row: ArrayCodec, where: str) -> None:
        self._row = row
        self._where = where

    def write(self, values: object, sizes: Sequence[int], parts: list[bytes]) -> None:
        """Append its bytes; a wrong size raises ValueError."""
        count, inner = sizes[0], sizes[1:]
        if not inner:
            self._row.write(values, count, parts)
            return
        rows = as_sequence(values)
        check_count(rows, count)
        for row in rows:
            self.write(row, inner, parts)

    def read(self, sizes: Sequence[int], cursor: Cursor) -> object:
        """Return the array of these sizes, outermost first."""
        count, inner = sizes[0], sizes[1:]
        if not inner:
            return self._row.read(count, cursor)
        if min(sizes) < 0:
            raise Malformed(f"negative length at {self._where}")
        cursor.expect(count, prod(inner) * self._row.smallest, self._where)
        return [self.read(inner, cursor) for _ in range(count)]


def write_string(value: object, parts: list[bytes]) -> None:
    """Append a string; TypeError for all but text."""
    text = str.encode(value, "utf-8", STRAY_BYTES)  # type: ignore[arg-type] # as said
    parts += (_LENGTH.pack(len(text) + 1), text, b"\0")


def read_string(cursor: Cursor, where: str) -> str:
    """Return a string; bytes that are not UTF-8 become U+FFFD, as in lcm-gen's, or are kept."""
    data = cursor.data
    start = cursor.take(STRING_BYTES, where) + STRING_BYTES
    end = start + _LENGTH.unpack_from(data, start - STRING_BYTES)[0]
    if end > len(data):
        cursor.take(end - start, where)
    cursor.offset = end
    if start == end:  # no NUL either, which lcm-gen's decoders let pass
        return ""
    if data[end - 1]:
        raise Malformed(f"no NUL at the end of {where}")
    return data[start : end - 1].decode("utf-8", cursor.stray)


def length(old: int, *arrays: tuple[object, int]) -> int:
    """Return the value of a length field: the length of the first array that depends on it.

    The arrays that share it come with the dimension that it gives, 0 the outermost. The ``old``
    value stays where no array has the size (an inner size without any row).
    """
    for values, depth in arrays:
        for _ in range(depth):
            rows = as_sequence(values)
            if not rows:
                break
            values = rows[0]  # noqa: PLW2901 - the way in
        else:
            return len(values)  # type: ignore[arg-type] # TypeError, when it is no array
    return old


def check_count(values: Sized, count: int) -> None:
    """Raise ValueError unless there are ``count`` values."""
    if len(values) != count:
        raise ValueError("wrong length")
