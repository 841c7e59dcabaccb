"""The code that writes and reads a type, made once from lcm-gen's tables.

Belongs here: LCM's encoding of whole messages: which fields lie next to each other, and when length
fields are set. Must not know the errors that users see.

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
from typing import NamedTuple, TypeAlias, cast

from lcmtools.messages.fields import Field, fields, visible_fields
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.messages.rows import (
    BOOLEANS,
    FORMATS,
    Array,
    ArrayCodec,
    Cursor,
    check_count,
    length,
    primitive_array,
    read_string,
    write_string,
)
from lcmtools.messages.shape import as_sequence

Write: TypeAlias = Callable[[object, list[bytes]], None]
Read: TypeAlias = Callable[[Cursor], Message]


class Layout(NamedTuple):
    """The encoder, which sets length fields, and the decoder of one type."""

    fingerprint: bytes  # the first 8 bytes of a payload, which the functions leave out
    write: Write
    read: Read


@cache
def layout(cls: type[Message]) -> Layout:
    """The layout of a class."""
    source = _Source(type_name(cls))
    source.add_message("m0 =", cls, "")
    source.add_fields()
    return Layout(fingerprint(cls).to_bytes(8, "big"), *source.functions())


def is_generated(cls: type) -> bool:
    """Return True for a class made by lcm-gen."""
    return hasattr(cls, "__typenames__")


def has_wire_type(message: object, cls: type[Message]) -> bool:
    """Return True for an object with the fields of a ``cls``, in the same order.

    A geometry_msgs/Point may replace a Vector3, as with lcm-gen's own encoders.
    """
    kind = cast("type[Message]", type(message))
    return kind is cls or (is_generated(kind) and fingerprint(kind) == fingerprint(cls))


def _check_type(value: object, cls: type[Message]) -> None:
    if type(value) is not cls and not has_wire_type(value, cls):
        raise TypeError(f"not a {cls.__name__}")


class _Messages:
    """A row of messages."""

    def __init__(self, cls: type[Message], where: str) -> None:
        self._cls = cls
        self._where = where
        self.smallest = _smallest(cls)

    def write(self, values: object, count: int, parts: list[bytes]) -> None:
        messages = as_sequence(values)
        check_count(messages, count)
        write = layout(self._cls).write
        for value in messages:
            _check_type(value, self._cls)
            write(value, parts)

    def read(self, count: int, cursor: Cursor) -> list[Message]:
        cursor.expect(count, self.smallest, self._where)
        cursor.enter(self._where)
        read = layout(self._cls).read
        messages = [read(cursor) for _ in range(count)]
        cursor.depth -= 1
        return messages


@dataclass(slots=True)
class _Source:
    """The statements of the two functions, and the names that they use.

    ``leaves`` are the fields that are not messages: the message's variable, the path, the field.
    """

    type_name: str
    write: list[str] = field(default_factory=list)
    read: list[str] = field(default_factory=list)
    leaves: list[tuple[str, str, Field]] = field(default_factory=list)
    space: dict[str, object] = field(
        default_factory=lambda: {
            "booleans": BOOLEANS,
            "check": _check_type,
            "length": length,
            "new": object.__new__,
            "read_string": read_string,
            "write_string": write_string,
        }
    )

    def add_message(self, target: str, cls: type[Message], path: str) -> None:
        """Add a message's variable, its length fields, its messages and their fields.

        ``target`` is the assignment's left side: "m0 =", "m1 = m0.linear ="; ``path`` ends in a
        point unless the message is the outermost.
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
        for is_number, run in groupby(self.leaves, lambda leaf: _is_number(leaf[2])):
            if is_number:
                self._add_numbers(list(run))
                continue
            for variable, path, part in run:
                target, where = f"{variable}.{part.name}", f"{self.type_name}.{path}"
                if part.dimensions:
                    self._add_array(variable, target, part, where)
                else:
                    self.write.append(f"write_string({target}, parts)")
                    self.read.append(f"{target} = read_string(cursor, {where!r})")

    def functions(self) -> tuple[Write, Read]:
        write = ["def write(m0, parts):", *self.write, "return"]
        read = ["def read(cursor):", *self.read, "return m0"]
        text = "\n ".join(write) + "\n" + "\n ".join(read)
        exec(text, self.space)  # noqa: S102 - made of the names that lcm-gen's own code has
        return cast("Write", self.space["write"]), cast("Read", self.space["read"])

    def _add_numbers(self, run: list[tuple[str, str, Field]]) -> None:
        codes = "".join(FORMATS[part.type] for _, _, part in run)
        packer = struct.Struct(f">{codes}")
        name = self._name("s", packer)
        targets = [f"{variable}.{part.name}" for variable, _, part in run]
        pairs = zip(targets, codes, strict=True)
        values = [f"booleans[{target}]" if code == "?" else target for target, code in pairs]
        self.write.append(f"parts.append({name}.pack({', '.join(values)}))")
        where = f"{self.type_name}.{run[0][1]}"
        start = f"cursor.take({packer.size}, {where!r})"
        self.read.append(f"{', '.join(targets)}, = {name}.unpack_from(cursor.data, {start})")

    def _add_array(self, variable: str, target: str, part: Field, where: str) -> None:
        row = _row(part, where)
        sizes = [f"{variable}.{s}" if isinstance(s, str) else str(s) for s in part.dimensions]
        if len(sizes) == 1:
            size, array = sizes[0], self._name("r", row)
        else:
            size, array = f"({', '.join(sizes)})", self._name("a", Array(row, where))
        self.write.append(f"{array}.write({target}, {size}, parts)")
        self.read.append(f"{target} = {array}.read({size}, cursor)")

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


@cache
def _smallest(cls: type[Message]) -> int:
    """The smallest size of a message [byte], with all arrays of variable size empty."""
    return sum(map(_smallest_field, fields(cls)))


def _smallest_field(part: Field) -> int:
    count = prod(size if isinstance(size, int) else 0 for size in part.dimensions)
    if not count:  # before the element: a type may hold an array of itself
        return 0
    return count * _row(part, "").smallest


def _is_number(part: Field) -> bool:
    return part.type in FORMATS and not part.dimensions


def _row(part: Field, where: str) -> ArrayCodec:
    if part.message_class:
        return _Messages(part.message_class, where)
    return primitive_array(part.type, where, is_bytes=part.is_bytes)
