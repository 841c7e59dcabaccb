"""LCM's encoding of arrays and strings, and the cursor that never reads past a payload's end.

Numbers are big-endian; a boolean is one byte; a string is its length including the closing NUL (4
bytes), UTF-8 and NUL; an array is its elements row by row, and its sizes are elsewhere. Must not
know messages. For a value that is not plain, writing raises whatever Python raises; reading, which
``coder`` generates, raises Malformed.
"""

import struct
import sys
from array import array
from collections.abc import Callable, Sequence, Sized
from functools import lru_cache
from typing import Any, TypeAlias

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
MOST_KEPT = 4096
"""Bytes of strings in an array that are kept, as a robot's joints have the same names in each
message: comparing them is ten times as fast as reading or writing them again."""
IS_LITTLE = sys.byteorder == "little"
"""True if a payload's numbers have to be byte-swapped."""

# Elements without bytes (empty messages, empty rows) that one payload may contain: without a limit,
# 4 bytes could claim two billion of them.
_MOST_WEIGHTLESS = 65_536
_DEEPEST = 100  # levels of arrays of messages; only a type that contains itself could have as many
_SHORT = 64  # numbers: an array of a fixed size up to this is decoded as a tuple
_LISTS = (list, tuple)
_LENGTH = struct.Struct(">I")
_LONG = "q" if struct.calcsize("l") > struct.calcsize("i") else "i"  # by C's long here
_SAME = {code: (code, "l") if code == _LONG else (code,) for code in FORMATS.values()}

WriteArray: TypeAlias = Callable[[object, Any], bytes]
"""Returns the bytes of an array of this size, or of these sizes, outermost first.

ValueError is raised for another size.
"""


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


def primitive_writer(type_name: str) -> WriteArray:
    """Return the function that writes arrays of a primitive type."""
    if type_name == "string":
        return _string_writer()
    return write_bytes if type_name == "uint8" else _number_writer(FORMATS[type_name])


def row_writer(write_row: WriteArray) -> WriteArray:
    """Return the function that writes arrays of several dimensions by that of their rows."""

    def write(values: object, sizes: Sequence[int]) -> bytes:
        count, inner = sizes[0], sizes[1:]
        if not inner:
            return write_row(values, count)
        rows = as_sequence(values)
        check_count(rows, count)
        return b"".join([write(row, inner) for row in rows])

    return write


def _number_writer(code: str) -> WriteArray:
    def write(values: object, count: int) -> bytes:
        if type(values) not in _LISTS and (own := _own_numbers(values, code)) is not None:
            check_count(own, count)
            if IS_LITTLE:
                own.byteswap()
            return own.tobytes()
        numbers = as_sequence(values)
        if code == "?":
            numbers = [BOOLEANS[value] for value in numbers]
        return numbers_struct(count, code).pack(*numbers)

    return write


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


def write_bytes(values: object, count: int) -> bytes:
    """Return bytes, without a copy if given as such."""
    data = values if type(values) is bytes else as_bytes(values)
    check_count(data, count)
    return data


def _string_writer() -> WriteArray:
    kept: tuple[list[object], bytes] = [], b""

    def write(values: object, count: int) -> bytes:
        nonlocal kept
        strings = as_sequence(values)
        check_count(strings, count)
        last, data = kept
        if strings != last:
            data = b"".join(map(_string_bytes, strings))
            if len(data) <= MOST_KEPT:
                kept = [*strings], data
        return data

    return write


def _string_bytes(value: object) -> bytes:
    """Return a string's bytes; TypeError for anything but text."""
    text = str.encode(value, "utf-8", STRAY_BYTES)  # type: ignore[arg-type] # as said
    return _LENGTH.pack(len(text) + 1) + text + b"\0"


def is_short(size: int | str) -> bool:
    """Return True if an array of numbers of this size is decoded as a tuple."""
    return isinstance(size, int) and size <= _SHORT


@lru_cache
def numbers_struct(count: int, code: str) -> struct.Struct:
    """Return the ``struct`` of some numbers of one type."""
    return struct.Struct(f">{count}{code}")


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
