"""Functions that write and read a type, generated as source text from its layout and compiled.

Plain assignments, and numbers packed together, make the fast functions faster than lcm-gen's own
code. That is why source text is generated and compiled, as in ``dataclasses``. For a
std_msgs/Header:

    def write(m0):
        m1 = m0.stamp
        if type(m1) is not c1: check(m1, c1)
        t0 = encode(m0.frame_id, "utf-8", stray)
        return (pack2(m0.seq, m1.sec, m1.nsec, len(t0) + 1), t0, nul)

See ``reading`` for the other way.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import TypeAlias

from lcmtools.forks import cached_property
from lcmtools.messages.array_codec import (
    FORMATS,
    IS_LITTLE,
    WriteArray,
    check_count,
    is_short,
    primitive_writer,
    row_writer,
)
from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import Field, attribute, visible_fields
from lcmtools.messages.layout import check_type
from lcmtools.messages.reading import CarefulReading, Read, Reading, Scan, Source
from lcmtools.messages.registry import Message, fingerprint
from lcmtools.messages.shape import as_sequence

Write: TypeAlias = Callable[[object], tuple[bytes, ...]]
"""Sets the length fields of a message and returns its bytes, in parts."""


class Coder:
    """The functions of one type; they leave out the fingerprint."""

    def __init__(self, cls: type[Message]) -> None:
        self._cls = cls
        self.fingerprint = fingerprint(cls).to_bytes(8, "big")
        """The first 8 bytes of a payload."""

    @cached_property
    def write(self) -> Write:
        """The encoder."""
        source = self._source()
        return source.function("write(m0)", _Writing(source).statements())

    @cached_property
    def scan(self) -> Scan:
        """The fast reader."""
        source = self._source()
        return source.function("scan(data, at)", Reading(source).lines)

    @cached_property
    def read(self) -> Read:
        """The careful reader."""
        source = self._source()
        return source.function("read(cursor)", CarefulReading(source).lines)

    @cached_property
    def read_available(self) -> Read:
        """The same for a part of the fields: those without bytes have their defaults."""
        source = self._source()
        return source.function("read(cursor)", CarefulReading(source, may_end=True).lines)

    def _source(self) -> Source:
        return Source(self._cls, coder)  # of each function, as threads may compile several at once


@cache
def coder(cls: type[Message]) -> Coder:
    """Return the functions of a class."""
    return Coder(cls)


class _Writing:
    """The statements that write a message in parts: packed numbers, strings and arrays."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._lines: list[str] = []
        self._parts: list[str] = []
        self._codes = ""  # codes of the numbers, and NUL ("x"), of the next part
        self._values: list[str] = []

    def statements(self) -> list[str]:
        source = self._source
        for place, part in enumerate(source.layout.parts):
            if part.name:
                cls = source.name("c", part.cls)
                self._lines += [
                    source.part(place),
                    f"if type(m{place}) is not {cls}: check(m{place}, {cls})",
                ]
            self._lines.extend(_set_lengths(part.cls, f"m{place}"))
        for leaf, target, sizes in source.leaves():
            if sizes:
                self._pack()
                self._add_array(leaf.field, target, sizes)
            elif leaf.is_number:
                code = FORMATS[leaf.field.type]
                self._add(code, f"booleans[{target}]" if code == "?" else target)
            else:
                self._add_string(target)
        self._pack()
        return [*self._lines, f"return ({''.join(f'{part}, ' for part in self._parts)})"]

    def _add(self, code: str, value: str) -> None:
        self._codes += code
        self._values.append(value)

    def _add_string(self, target: str) -> None:
        text = f"t{len(self._lines)}"
        self._lines.append(f'{text} = encode({target}, "utf-8", stray)')
        self._add("I", f"len({text}) + 1")
        self._pack()
        self._parts.append(text)
        self._codes = "x"

    def _add_array(self, part: Field, target: str, sizes: Sequence[str]) -> None:
        """Add an array; an array of numbers as returned by ``scan`` needs no call."""
        write = self._source.name("write", _array_writer(part))
        size = sizes[0] if len(sizes) == 1 else f"({', '.join(sizes)})"
        if len(sizes) > 1 or not _is_number_array(part):
            self._parts.append(f"{write}({target}, {size})")
            return
        values, code = f"v{len(self._lines)}", FORMATS[part.type]
        fits = f"{values}.typecode == {code!r} and len({values}) == {size}"
        swap = f"{values}.byteswap()" if IS_LITTLE else "pass"
        self._lines += [
            f"{values} = {target}",
            f"if type({values}) is numbers and {fits}:",
            f" {values} = {values}[:]; {swap}; {values} = {values}.tobytes()",
            f"else: {values} = {write}({values}, {size})",
        ]
        self._parts.append(values)

    def _pack(self) -> None:
        if self._values:
            pack = self._source.name("pack", struct.Struct(f">{self._codes}").pack)
            self._parts.append(f"{pack}({', '.join(self._values)})")
        elif self._codes:
            self._parts.append("nul")
        self._codes, self._values = "", []


def _array_writer(part: Field) -> WriteArray:
    cls = part.message_class
    write = _message_writer(cls) if cls else primitive_writer(part.type)
    return row_writer(write) if part.depth > 1 else write


def _message_writer(cls: type[Message]) -> WriteArray:
    def write(values: object, count: int) -> bytes:
        messages = as_sequence(values)
        check_count(messages, count)
        write_one = coder(cls).write
        parts: list[bytes] = []
        for value in messages:
            check_type(value, cls)
            parts += write_one(value)
        return b"".join(parts)

    return write


def _is_number_array(part: Field) -> bool:
    """Return True for arrays that ``scan`` makes a NumberArray."""
    is_other = part.type in ("bool", "uint8") or isinstance(part.type, EnumType)
    return part.type in FORMATS and not is_other and not is_short(part.dimensions[-1])


def _set_lengths(cls: type[Message], variable: str) -> Iterator[str]:
    """Yield the statements that set the length fields of a message."""
    found: dict[str, list[str]] = {}
    for part in visible_fields(cls):
        for depth, size in enumerate(part.dimensions):
            if isinstance(size, str):
                found.setdefault(size, []).append(f"({variable}.{part.attribute}, {depth})")
    for name, arrays in found.items():
        target = f"{variable}.{attribute(cls, name)}"
        if len(arrays) == 1 and arrays[0].endswith(", 0)"):
            yield f"{target} = len({arrays[0][1:-4]})"
        else:
            yield f"{target} = length({target}, {', '.join(arrays)})"
