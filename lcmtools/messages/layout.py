"""The code that writes and reads a type, made once from lcm-gen's tables.

Belongs here: LCM's encoding of whole messages: which fields lie next to each other, and when length
fields are set. Must not know what an error looks like to the user (see ``rows``).

A nested message is its fields and no more, so the numbers of neighbouring messages are packed in
one go. That and plain assignments make it faster than lcm-gen's own code, whence source text,
compiled, as ``dataclasses`` does it. The two functions of a Twist:

    def write(m0, parts):
        m1 = m0.linear
        check(m1, c1)
        m2 = m0.angular
        check(m2, c2)
        parts.append(s0.pack(m1.x, m1.y, m1.z, m2.x, m2.y, m2.z))

    def read(cursor):
        m0 = new(c0)
        m1 = m0.linear = new(c1)
        m2 = m0.angular = new(c2)
        m1.x, m1.y, m1.z, m2.x, m2.y, m2.z, = s0.unpack_from(cursor.data, cursor.take(48, "..."))
        return m0
"""

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cache
from itertools import groupby
from math import prod
from typing import cast

from lcmtools.messages.arrays import Array, length
from lcmtools.messages.conform import has_wire_type
from lcmtools.messages.fields import Field, fields, visible_fields
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.messages.rows import (
    BOOLEANS,
    FORMATS,
    Bytes,
    Cursor,
    Numbers,
    Row,
    Strings,
    check_count,
)
from lcmtools.messages.shape import as_sequence

_STRING_BYTES = 4  # of an empty string's length, which counts its NUL


@dataclass(frozen=True, slots=True)
class Layout:
    """The encoder and the decoder of one type.

    Attributes:
        fingerprint: The first 8 bytes of a payload.
        write: Sets the length fields of a message and appends its bytes, without a fingerprint.
        read: Makes a new message from the bytes at a cursor.
    """

    fingerprint: bytes
    write: Callable[[object, list[bytes]], None]
    read: Callable[[Cursor], Message]


@cache
def layout(cls: type[Message]) -> Layout:
    """The layout of a class."""
    source = _Source(type_name(cls))
    source.add_message("m0 =", cls, "")
    source.add_fields()
    write, read = source.functions()
    return Layout(
        fingerprint(cls).to_bytes(8, "big"),
        cast("Callable[[object, list[bytes]], None]", write),
        cast("Callable[[Cursor], Message]", read),
    )


@cache
def smallest(cls: type[Message]) -> int:
    """The smallest size of a message [byte], with all arrays of variable size empty."""
    return sum(_smallest(part) for part in fields(cls))


class Messages:
    """Nested messages: a row of an array."""

    def __init__(self, cls: type[Message], where: str) -> None:
        self._cls = cls
        self._where = where

    def smallest(self) -> int:
        """The bytes of a message with empty arrays."""
        return smallest(self._cls)

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        """Append them all."""
        messages = as_sequence(values)
        check_count(messages, count)
        write = layout(self._cls).write
        for value in messages:
            check_type(value, self._cls)
            write(value, parts)

    def read(self, count: int, cursor: Cursor) -> list[Message]:
        """A list of them."""
        cursor.expect(count, self.smallest(), self._where)
        cursor.enter(self._where)
        read = layout(self._cls).read
        messages = [read(cursor) for _ in range(count)]
        cursor.depth -= 1
        return messages


def check_type(value: object, cls: type[Message]) -> None:
    """Raise TypeError where the value cannot stand for a ``cls``."""
    if type(value) is not cls and not has_wire_type(value, cls):
        raise TypeError(f"not a {cls.__name__}")


@dataclass(slots=True)
class _Source:
    """The two functions while they are being written.

    Attributes:
        type_name: The type they are for.
        write: Statements of one.
        read: Statements of the other.
        leaves: The fields that are not messages themselves: variable of the message, path, field.
        space: The names that the statements use.
    """

    type_name: str
    write: list[str] = field(default_factory=list)
    read: list[str] = field(default_factory=list)
    leaves: list[tuple[str, str, Field]] = field(default_factory=list)
    space: dict[str, object] = field(
        default_factory=lambda: {
            "booleans": BOOLEANS,
            "check": check_type,
            "length": length,
            "new": object.__new__,
        }
    )

    def add_message(self, target: str, cls: type[Message], path: str) -> None:
        """Add the variable of a message, its length fields, its messages and their fields.

        Args:
            target: The assignment's left side: "m0 =", "m1 = m0.linear =".
            cls: The message's class.
            path: Where it is, with a point at the end unless it is the outermost.
        """
        variable = target.partition(" ")[0]
        self.read.append(f"{target} new({self._name('c', cls)})")
        self.write.extend(_set_lengths(cls, variable))
        for part in fields(cls):
            where = f"{path}{part.name}"
            if part.message_class and not part.dimensions:
                self._add_nested(variable, part, part.message_class, where)
            else:
                self.leaves.append((variable, where, part))

    def _add_nested(self, owner: str, part: Field, cls: type[Message], where: str) -> None:
        variable = f"m{len(self.space)}"
        self.write.append(f"{variable} = {owner}.{part.name}")
        self.write.append(f"check({variable}, {self._name('c', cls)})")
        self.add_message(f"{variable} = {owner}.{part.name} =", cls, f"{where}.")

    def add_fields(self) -> None:
        """Add the statements for all leaves, numbers in runs."""
        for numbers, run in groupby(self.leaves, key=lambda leaf: _is_number(leaf[2])):
            if numbers:
                self._add_numbers(list(run))
                continue
            for variable, path, part in run:
                add = self._add_array if part.dimensions else self._add_string
                add(variable, path, part)

    def functions(self) -> tuple[object, object]:
        """The functions ``write`` and ``read``."""
        write = ["def write(m0, parts):", *self.write, "return"]
        read = ["def read(cursor):", *self.read, "return m0"]
        text = "\n ".join(write) + "\n" + "\n ".join(read)
        exec(text, self.space)  # noqa: S102 - made of the names that lcm-gen's own code has
        return self.space["write"], self.space["read"]

    def _add_numbers(self, run: list[tuple[str, str, Field]]) -> None:
        codes = "".join(FORMATS[part.type] for _, _, part in run)
        packer = struct.Struct(f">{codes}")
        name = self._name("s", packer)
        targets = [f"{variable}.{part.name}" for variable, _, part in run]
        values = [
            f"booleans[{target}]" if code == "?" else target
            for target, code in zip(targets, codes, strict=True)
        ]
        self.write.append(f"parts.append({name}.pack({', '.join(values)}))")
        where = f"{self.type_name}.{run[0][1]}"
        start = f"cursor.take({packer.size}, {where!r})"
        self.read.append(f"{', '.join(targets)}, = {name}.unpack_from(cursor.data, {start})")

    def _add_string(self, variable: str, path: str, part: Field) -> None:
        row = self._name("r", Strings(f"{self.type_name}.{path}"))
        self.write.append(f"{row}.write_one({variable}.{part.name}, parts)")
        self.read.append(f"{variable}.{part.name} = {row}.read_one(cursor)")

    def _add_array(self, variable: str, path: str, part: Field) -> None:
        where = f"{self.type_name}.{path}"
        sizes = [
            str(size) if isinstance(size, int) else f"{variable}.{size}" for size in part.dimensions
        ]
        if len(sizes) == 1:
            size, array = sizes[0], self._name("r", _row(part, where))
        else:
            size, array = f"({', '.join(sizes)})", self._name("a", Array(_row(part, where), where))
        self.write.append(f"{array}.write({variable}.{part.name}, {size}, parts)")
        self.read.append(f"{variable}.{part.name} = {array}.read({size}, cursor)")

    def _name(self, letter: str, thing: object) -> str:
        """A new name for a thing that the statements use."""
        name = f"{letter}{len(self.space)}"
        self.space[name] = thing
        return name


def _set_lengths(cls: type[Message], variable: str) -> Iterable[str]:
    """The statements that set the length fields of a message."""
    found: dict[str, list[str]] = {}
    for part in visible_fields(cls):
        for depth, size in enumerate(part.dimensions):
            if isinstance(size, str):
                found.setdefault(size, []).append(f"({variable}.{part.name}, {depth})")
    for name, arrays in found.items():
        target = f"{variable}.{name}"
        if len(arrays) == 1 and arrays[0].endswith(", 0)"):
            yield f"{target} = len({arrays[0][1:-4]})"
        else:
            yield f"{target} = length({target}, {', '.join(arrays)})"


def _smallest(part: Field) -> int:
    count = prod(size if isinstance(size, int) else 0 for size in part.dimensions)
    if not count:
        return 0
    if part.message_class:
        return count * smallest(part.message_class)
    size = _STRING_BYTES if part.type == "string" else struct.calcsize(f">{FORMATS[part.type]}")
    return count * size


def _is_number(part: Field) -> bool:
    return part.type in FORMATS and not part.dimensions


def _row(part: Field, where: str) -> Row:
    if part.message_class:
        return Messages(part.message_class, where)
    if part.type == "string":
        return Strings(where)
    return Bytes(where) if part.is_bytes else Numbers(part.type, where)
