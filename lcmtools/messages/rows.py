"""The innermost dimension of an array: numbers, bytes or strings in a payload.

Belongs here: LCM's encoding of primitive values, and the cursor that never reads past a payload's
end. Must not know messages. Writing raises whatever Python raises for a value that is not plain;
reading raises Malformed.

Numbers are big-endian; a boolean is one byte; a string is its length with the closing NUL (4
bytes), UTF-8 and NUL.
"""

import struct
from collections.abc import Sized
from typing import Protocol

from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.messages.shape import as_bytes, as_sequence

FORMATS = {
    "bool": "?",
    "uint8": "B",
    "int8": "b",
    "int16": "h",
    "int32": "i",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}
"""The ``struct`` codes of the primitive types of fixed size."""

BOOLEANS: dict[object, bool] = {False: False, True: True}
"""The values accepted as booleans; ``struct`` alone takes any object for true."""

MOST_WEIGHTLESS = 65_536
"""Elements without bytes (empty messages, empty rows) that one payload may claim to hold. Without
a limit, 4 bytes could ask for two thousand million of them."""


DEEPEST = 100
"""Levels of arrays of messages in a payload. Only a type that holds itself could have as many."""


class Malformed(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """A payload that cannot be what its fingerprint says."""


class Cursor:
    """A payload and how much of it has been read.

    ``stray`` is what becomes of bytes in strings that are not UTF-8, as Python's decoders call it.
    """

    __slots__ = ("data", "depth", "offset", "stray", "weightless")

    def __init__(self, data: bytes, offset: int, stray: str = "replace") -> None:
        self.data = data
        self.stray = stray
        self.offset = offset
        self.depth = 0
        self.weightless = MOST_WEIGHTLESS

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
        if self.depth > DEEPEST:
            raise Malformed(f"nested more than {DEEPEST} levels deep at {where}")

    def _wrong_size(self, size: int, where: str) -> Malformed:
        if size < 0:
            return Malformed(f"negative length at {where}")
        left = len(self.data) - self.offset
        return Malformed(f"{size} bytes wanted at {where}, {left} left")


class Row(Protocol):
    """The elements of an array of one dimension."""

    def smallest(self) -> int:
        """The smallest size of an element [byte]."""

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append the bytes of all elements, of which there must be so many."""

    def read(self, count: int, cursor: Cursor) -> object:
        """So many elements."""


class Numbers:
    """Numbers or booleans."""

    def __init__(self, type_name: str, where: str) -> None:
        code = FORMATS[type_name]
        self._code = code
        self._where = where
        self._size = struct.calcsize(f">{code}")

    def smallest(self) -> int:
        """The size of one number."""
        return self._size

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append them all."""
        numbers = as_sequence(values)
        if self._code == "?":
            numbers = [BOOLEANS[value] for value in numbers]
        parts.append(struct.pack(f">{count}{self._code}", *numbers))

    def read(self, count: int, cursor: Cursor) -> object:
        """Numbers as a tuple, booleans as a list: what lcm-gen's decoders give."""
        data, start = cursor.data, cursor.offset
        end = start + count * self._size
        if not start <= end <= len(data):  # not take() at once: short arrays are slower by its call
            cursor.take(count * self._size, self._where)
        cursor.offset = end
        numbers = struct.unpack_from(f">{count}{self._code}", data, start)
        return list(numbers) if self._code == "?" else numbers


class Bytes:
    """Bytes, as one ``bytes``."""

    def __init__(self, where: str) -> None:
        self._where = where

    def smallest(self) -> int:
        """One byte."""
        return 1

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append them, without a copy where they are a ``bytes``."""
        data = values if type(values) is bytes else as_bytes(values)
        check_count(data, count)
        parts.append(data)

    def read(self, count: int, cursor: Cursor) -> bytes:
        """So many bytes."""
        start = cursor.take(count, self._where)
        return cursor.data[start : start + count]


class Strings:
    """Strings."""

    def __init__(self, where: str) -> None:
        self._where = where

    def smallest(self) -> int:
        """The bytes of a string's length."""
        return 4

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append them all."""
        strings = as_sequence(values)
        check_count(strings, count)
        for value in strings:
            self.write_one(value, parts)

    def read(self, count: int, cursor: Cursor) -> list[str]:
        """A list of them."""
        cursor.expect(count, self.smallest(), self._where)
        return [self.read_one(cursor) for _ in range(count)]

    def write_one(self, value: object, parts: list[bytes]) -> None:
        """Append one."""
        # TypeError for all but text
        text = str.encode(value, "utf-8", STRAY_BYTES)  # type: ignore[arg-type]
        parts += (_LENGTH.pack(len(text) + 1), text, b"\0")

    def read_one(self, cursor: Cursor) -> str:
        """One string; bytes that are not UTF-8 become U+FFFD, as in lcm-gen's, or are kept."""
        data = cursor.data
        start = cursor.take(4, self._where) + 4
        end = start + _LENGTH.unpack_from(data, start - 4)[0]
        if end > len(data):
            cursor.take(end - start, self._where)
        cursor.offset = end
        if start == end:  # no NUL either, which lcm-gen's decoders let pass
            return ""
        if data[end - 1]:
            raise Malformed(f"no NUL at the end of {self._where}")
        return data[start : end - 1].decode("utf-8", cursor.stray)


def check_count(values: Sized, count: int) -> None:
    """Raise ValueError where there are not so many values."""
    if len(values) != count:
        raise ValueError("wrong length")


_LENGTH = struct.Struct(">I")
