"""The functions that write and read a type, created once per type.

Belongs here: the encoder, which sets length fields, the fast decoder, and the careful one, which is
slower and reports the fault. Must not know the errors that users see.
"""

import struct
from collections.abc import Sequence
from functools import cache
from itertools import groupby
from typing import NamedTuple, cast

from lcmtools.messages.compiled import Codecs, Scan, Write, compiled
from lcmtools.messages.enums import EnumType, EnumValue
from lcmtools.messages.fields import length_values
from lcmtools.messages.layout import Layout, Leaf, check_type, is_bounded, layout, smallest
from lcmtools.messages.registry import Message, fingerprint
from lcmtools.messages.rows import (
    FORMATS,
    Array,
    ArrayCodec,
    Cursor,
    Malformed,
    check_count,
    primitive_array,
    read_string,
)
from lcmtools.messages.shape import as_sequence


class Coder(NamedTuple):
    """The functions of one type; they leave out the fingerprint."""

    fingerprint: bytes  # the first 8 bytes of a payload
    write: Write
    scan: Scan
    layout: Layout
    codecs: Codecs

    def read(self, cursor: Cursor) -> Message:
        """Return the message at a cursor; Malformed describes a fault."""
        made: list[Message] = []
        for part in self.layout.parts:
            made.append(object.__new__(part.cls))
            if part.name:
                setattr(made[part.owner], part.name, made[-1])
        leaves = zip(self.layout.leaves, self.codecs, strict=True)
        for is_number, run in groupby(leaves, lambda pair: pair[0].is_number):
            if is_number:
                _read_numbers([leaf for leaf, _ in run], made, cursor)
                continue
            for leaf, codec in run:
                value = _read_other(leaf, codec, made[leaf.part], cursor)
                setattr(made[leaf.part], leaf.field.attribute, value)
        return made[0]

    def read_available(self, cursor: Cursor) -> Message:
        """Return the message in the rest of the bytes; fields without bytes have their defaults."""
        outermost, *parts = self.layout.parts
        made = [outermost.cls()]
        for part in parts:
            made.append(getattr(made[part.owner], part.name))
        for leaf, codec in zip(self.layout.leaves, self.codecs, strict=True):
            if cursor.offset == len(cursor.data):
                break
            if leaf.is_number:
                _read_numbers([leaf], made, cursor)
            else:
                value = _read_other(leaf, codec, made[leaf.part], cursor)
                setattr(made[leaf.part], leaf.field.attribute, value)
        return made[0]


@cache
def coder(cls: type[Message]) -> Coder:
    """Return the functions of a class."""
    whole = layout(cls)
    codecs = tuple(_codec(leaf) for leaf in whole.leaves)
    functions = compiled(whole, codecs)
    return Coder(fingerprint(cls).to_bytes(8, "big"), *functions, whole, codecs)


def _codec(leaf: Leaf) -> ArrayCodec | Array | None:
    sizes, row = leaf.field.dimensions, leaf.field.message_class
    if not sizes:
        return None
    if row:
        codec: ArrayCodec = _Messages(row, leaf.where)
    else:
        codec = primitive_array(leaf.field.type, leaf.where, sizes[-1])
        if isinstance(leaf.field.type, EnumType):
            codec = _Enums(leaf.field.type, codec)
    return codec if len(sizes) == 1 else Array(codec, leaf.where)


def _read_numbers(run: list[Leaf], made: list[Message], cursor: Cursor) -> None:
    packer = struct.Struct(">" + "".join(FORMATS[leaf.field.type] for leaf in run))
    values = packer.unpack_from(cursor.data, cursor.advance(packer.size, run[0].where))
    for leaf, value in zip(run, values, strict=True):
        kind = leaf.field.type
        named = kind.cls(value) if isinstance(kind, EnumType) else value
        setattr(made[leaf.part], leaf.field.attribute, named)


def _read_other(
    leaf: Leaf, codec: ArrayCodec | Array | None, owner: Message, cursor: Cursor
) -> object:
    if codec is None:
        return read_string(cursor, leaf.where)
    sizes = length_values(owner, leaf.field)
    return codec.read(sizes, cursor) if isinstance(codec, Array) else codec.read(sizes[0], cursor)


class _Enums(ArrayCodec):
    """An array of an enum's values, which are numbers with names; ``numbers`` are these."""

    def __init__(self, enum: EnumType, numbers: ArrayCodec) -> None:
        self._enum, self._numbers = enum.cls, numbers
        self.smallest = numbers.smallest

    def write(self, values: object, count: int) -> bytes:
        return self._numbers.write(values, count)

    def read(self, count: int, cursor: Cursor) -> list[EnumValue]:
        numbers = as_sequence(self._numbers.read(count, cursor))
        return list(map(self._enum, cast("Sequence[int]", numbers)))


class _Messages(ArrayCodec):
    """An array of messages."""

    def __init__(self, cls: type[Message], where: str) -> None:
        self._cls = cls
        self._where = where
        self.smallest = smallest(cls)

    def write(self, values: object, count: int) -> bytes:
        messages = as_sequence(values)
        check_count(messages, count)
        write = coder(self._cls).write
        parts: list[bytes] = []
        for value in messages:
            check_type(value, self._cls)
            parts += write(value)
        return b"".join(parts)

    def read(self, count: int, cursor: Cursor) -> list[Message]:
        cursor.expect(count, self.smallest, self._where)
        cursor.enter(self._where)
        read = coder(self._cls).read
        messages = [read(cursor) for _ in range(count)]
        cursor.depth -= 1
        return messages

    def scan(self, data: bytes, start: int, count: int) -> tuple[list[Message], int]:
        if count < 0 or not is_bounded(self._cls):
            raise Malformed
        scan, end = coder(self._cls).scan, start
        messages = []
        for _ in range(count):
            message, end = scan(data, end)
            messages.append(message)
        return messages, end
