"""Arrays and strings in a payload, and the cursor that never reads past a payload's end.

Belongs here: LCM's encoding. Numbers are big-endian; a boolean is one byte; a string is its length
including the closing NUL (4 bytes), UTF-8 and NUL; an array is its elements row by row, and its
sizes are elsewhere. Must not know messages. For a value that is not plain, writing raises whatever
Python raises; reading raises Malformed.
"""

import struct
import sys
from abc import ABC, abstractmethod
from array import array
from collections.abc import Sequence, Sized
from functools import lru_cache
from math import prod

from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.messages.shape import as_bytes, as_sequence

_TYPES = ("bool", "uint8", "int8", "int16", "int32", "int64", "float32", "float64")
FORMATS = dict(zip(_TYPES, "?Bbhiqfd", strict=True))
"""The ``struct`` codes of the primitive types of fixed size."""
BOOLEANS: dict[object, bool] = {False: False, True: True}
"""The values accepted as booleans; ``struct`` itself accepts any object as true."""
STRING_BYTES = 4
"""The size of an empty string: its length, which counts its NUL."""

# Elements without bytes (empty messages, empty rows) that one payload may contain: without a limit,
# 4 bytes could claim two billion of them.
_MOST_WEIGHTLESS = 65_536
_DEEPEST = 100  # levels of arrays of messages; only a type that contains itself could have as many
_LENGTH = struct.Struct(">I")
IS_LITTLE = sys.byteorder == "little"
"""True if a payload's numbers have to be byte-swapped."""
_SHORT = 64  # numbers: an array of a fixed size up to this is decoded as a tuple
_MOST_KEPT = 4096  # bytes of strings that are kept
_LISTS = (list, tuple)
_LONG = "q" if struct.calcsize("l") > struct.calcsize("i") else "i"  # by C's long here
_SAME = {code: (code, "l") if code == _LONG else (code,) for code in FORMATS.values()}


class Malformed(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """A payload that cannot be what its fingerprint says."""


class Cursor:
    """A payload and the offset of its unread rest.

    ``stray`` is the error handler for bytes in strings that are not UTF-8.
    """

    __slots__ = ("data", "depth", "offset", "stray", "weightless")

    def __init__(self, data: bytes, offset: int, stray: str = "replace") -> None:
        self.data, self.offset, self.stray = data, offset, stray
        self.depth, self.weightless = 0, _MOST_WEIGHTLESS

    def advance(self, size: int, where: str) -> int:
        """Advance by ``size`` bytes and return their offset."""
        start = self.offset
        end = start + size
        if not start <= end <= len(self.data):
            raise self._wrong_size(size, where)
        self.offset = end
        return start

    def expect(self, count: int, size: int, where: str) -> None:
        """Check, before allocating, that ``count`` elements of ``size`` bytes can follow."""
        if count < 0 or count * size > len(self.data) - self.offset:
            raise self._wrong_size(count * size or count, where)
        if not size:
            self.weightless -= count
            if self.weightless < 0:
                raise Malformed(f"{count} elements of no size claimed at {where}")

    def enter(self, where: str) -> None:
        """Begin an array of messages; the caller must lower ``depth`` at its end."""
        self.depth += 1
        if self.depth > _DEEPEST:
            raise Malformed(f"nested more than {_DEEPEST} levels deep at {where}")

    def _wrong_size(self, size: int, where: str) -> Malformed:
        if size < 0:
            return Malformed(f"negative length at {where}")
        return Malformed(f"{size} bytes wanted at {where}, {len(self.data) - self.offset} left")


class ArrayCodec(ABC):
    """An array of one dimension: ``smallest`` is the least size of an element [byte]."""

    smallest: int

    @abstractmethod
    def write(self, values: object, count: int) -> bytes:
        """Return the bytes of all elements; there must be ``count``."""

    @abstractmethod
    def read(self, count: int, cursor: Cursor) -> object:
        """Return ``count`` elements."""

    def scan(self, data: bytes, start: int, count: int) -> tuple[object, int]:
        """Return elements and their end; after any exception, ``read`` reports the fault."""
        cursor = Cursor(data, start)
        return self.read(count, cursor), cursor.offset


def primitive_array(type_name: str, where: str, size: int | str) -> ArrayCodec:
    """Return the codec of arrays of a primitive type, with a fixed size or one in a length field.

    ``where`` is its place, for errors.
    """
    if type_name == "string":
        return _Strings(where)
    if type_name == "uint8":
        return _Bytes(where)
    return _Numbers(FORMATS[type_name], where, size)


class _Numbers(ArrayCodec):
    """Numbers: a tuple for a small fixed size, else a NumberArray; booleans: a list."""

    def __init__(self, code: str, where: str, size: int | str) -> None:
        self._code = code
        self._is_tuple = is_short(size)
        self._where = where
        self.smallest = struct.calcsize(f">{code}")

    def write(self, values: object, count: int) -> bytes:
        if type(values) not in _LISTS and (own := _own_numbers(values, self._code)) is not None:
            check_count(own, count)
            return _swap(own).tobytes()
        numbers = as_sequence(values)
        if self._code == "?":
            numbers = [BOOLEANS[value] for value in numbers]
        return numbers_struct(count, self._code).pack(*numbers)

    def read(self, count: int, cursor: Cursor) -> object:
        start = cursor.advance(count * self.smallest, self._where)
        if self._code != "?" and not self._is_tuple:
            return _swap(NumberArray(self._code, cursor.data[start : cursor.offset]))
        numbers = numbers_struct(count, self._code).unpack_from(cursor.data, start)
        return list(numbers) if self._code == "?" else numbers


def is_short(size: int | str) -> bool:
    """Return True if an array of numbers of this size is decoded as a tuple."""
    return isinstance(size, int) and size <= _SHORT


@lru_cache
def numbers_struct(count: int, code: str) -> struct.Struct:
    """Return the ``struct`` of some numbers of one type."""
    return struct.Struct(f">{count}{code}")


def _swap(numbers: "array[float]") -> "array[float]":
    """Convert between the machine's and the payload's byte order, in place; return the array."""
    if IS_LITTLE:
        numbers.byteswap()
    return numbers


def _own_numbers(values: object, code: str) -> "array[float] | None":
    """Copy an object that already has numbers of exactly this type (array, numpy); else None."""
    if type(values) is NumberArray and values.typecode == code:
        return values[:]
    try:
        view = memoryview(values)  # type: ignore[arg-type] # TypeError, if it has no buffer
    except TypeError:
        return None
    if view.ndim != 1 or view.format not in _SAME[code]:
        return None
    return array(code, view.tobytes())


class _Bytes(ArrayCodec):
    """Bytes, as one ``bytes``; written without a copy if given as one."""

    smallest = 1

    def __init__(self, where: str) -> None:
        self._where = where

    def write(self, values: object, count: int) -> bytes:
        data = values if type(values) is bytes else as_bytes(values)
        check_count(data, count)
        return data

    def read(self, count: int, cursor: Cursor) -> bytes:
        start = cursor.advance(count, self._where)
        return cursor.data[start : start + count]


class _Strings(ArrayCodec):
    """Strings, as a list.

    A robot's joints have the same names in each message. So the last strings and their bytes are
    kept: comparing them is ten times as fast as reading or writing them again.
    """

    smallest = STRING_BYTES

    def __init__(self, where: str) -> None:
        self._where = where
        self._written: tuple[list[object], bytes] = [], b""
        self._read: tuple[list[str], bytes] = [], b""

    def write(self, values: object, count: int) -> bytes:
        strings = as_sequence(values)
        check_count(strings, count)
        last, data = self._written
        if strings != last:
            data = b"".join(map(string_bytes, strings))
            if len(data) <= _MOST_KEPT:
                self._written = [*strings], data
        return data

    def read(self, count: int, cursor: Cursor) -> list[str]:
        cursor.expect(count, self.smallest, self._where)
        return [read_string(cursor, self._where) for _ in range(count)]

    def scan(self, data: bytes, start: int, count: int) -> tuple[list[str], int]:
        last, block = self._read
        if count == len(last) and data.startswith(block, start):
            return last.copy(), start + len(block)
        if count < 0:
            raise Malformed
        strings, end = [], start
        for _ in range(count):
            begin = end + STRING_BYTES
            end = begin + _LENGTH.unpack_from(data, end)[0]
            strings.append(data[begin : end - 1].decode())
            if data[end - 1]:
                raise Malformed
        if end - start <= _MOST_KEPT:
            self._read = strings.copy(), data[start:end]
        return strings, end


class Array:
    """An array of several dimensions, made of rows of one kind."""

    def __init__(self, row: ArrayCodec, where: str) -> None:
        self._row = row
        self._where = where

    def write(self, values: object, sizes: Sequence[int]) -> bytes:
        """Return its bytes; a wrong size raises ValueError."""
        count, inner = sizes[0], sizes[1:]
        if not inner:
            return self._row.write(values, count)
        rows = as_sequence(values)
        check_count(rows, count)
        return b"".join([self.write(row, inner) for row in rows])

    def read(self, sizes: Sequence[int], cursor: Cursor) -> object:
        """Return the array of these sizes, outermost first."""
        count, inner = sizes[0], sizes[1:]
        if not inner:
            return self._row.read(count, cursor)
        if min(sizes) < 0:
            raise Malformed(f"negative length at {self._where}")
        cursor.expect(count, prod(inner) * self._row.smallest, self._where)
        return [self.read(inner, cursor) for _ in range(count)]

    def scan(self, data: bytes, start: int, sizes: Sequence[int]) -> tuple[object, int]:
        """Return the array and its end, like ``ArrayCodec.scan``."""
        cursor = Cursor(data, start, "strict")
        return self.read(sizes, cursor), cursor.offset


def string_bytes(value: object) -> bytes:
    """Return a string's bytes; TypeError for anything but text."""
    text = str.encode(value, "utf-8", STRAY_BYTES)  # type: ignore[arg-type] # as said
    return _LENGTH.pack(len(text) + 1) + text + b"\0"


def read_string(cursor: Cursor, where: str) -> str:
    """Return a string; bytes that are not UTF-8 become U+FFFD, as with lcm-gen, or are kept."""
    data = cursor.data
    start = cursor.advance(STRING_BYTES, where) + STRING_BYTES
    end = start + _LENGTH.unpack_from(data, start - STRING_BYTES)[0]
    if end > len(data):
        cursor.advance(end - start, where)
    cursor.offset = end
    if start == end:  # no NUL at all, which lcm-gen's decoders accept
        return ""
    if data[end - 1]:
        raise Malformed(f"no NUL at the end of {where}")
    return data[start : end - 1].decode("utf-8", cursor.stray)


def length(old: int, *arrays: tuple[object, int]) -> int:
    """Return the value of a length field: the length of the first array that depends on it.

    Each array that shares the field comes with its dimension of this length, 0 for the outermost.
    The ``old`` value is kept if no array has this dimension (an inner one, without any row).
    """
    for values, depth in arrays:
        for _ in range(depth):
            rows = as_sequence(values)
            if not rows:
                break
            values = rows[0]  # noqa: PLW2901 - one level further in
        else:
            return len(values)  # type: ignore[arg-type] # TypeError if it is not an array
    return old


def check_count(values: Sized, count: int) -> None:
    """Raise ValueError unless there are ``count`` values."""
    if len(values) != count:
        raise ValueError("wrong length")
