"""Functions that write and read a type, generated as source text from its layout and compiled.

Belongs here: which numbers are packed together, and which checks the fast functions make. Must not
know how arrays are coded, except arrays of numbers.

Plain assignments, and numbers packed together, make the fast functions faster than lcm-gen's own
code. That is why source text is generated and compiled, as in ``dataclasses``. For a
std_msgs/Header:

    def write(m0):
        m1 = m0.stamp
        if type(m1) is not c1: check(m1, c1)
        t0 = encode(m0.frame_id, "utf-8", stray)
        return (pack2(m0.seq, m1.sec, m1.nsec, len(t0) + 1), t0, nul)

    def scan(data, at):
        m0 = new(c0)
        m1 = m0.stamp = new(c1)
        m0.seq, m1.sec, m1.nsec, n, = unpack3(data, at)
        at = at + 16
        end = at + n
        m0.frame_id = data[at:end - 1].decode()
        if data[end - 1]: raise malformed
        return m0, end

``scan`` leaves checks to ``unpack_from`` and to a last comparison with the end: an exception of any
kind means that the careful decoder has to read the payload.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias, cast

from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import Field, attribute, visible_fields
from lcmtools.messages.layout import Layout, Leaf, check_type
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.registry import Message
from lcmtools.messages.rows import (
    BOOLEANS,
    FORMATS,
    IS_LITTLE,
    Array,
    ArrayCodec,
    Malformed,
    is_short,
    length,
    numbers_struct,
)
from lcmtools.messages.scalars import STRAY_BYTES

Write: TypeAlias = Callable[[object], tuple[bytes, ...]]
"""Sets the length fields of a message and returns its bytes, in parts."""

Scan: TypeAlias = Callable[[bytes, int], tuple[Message, int]]
"""Returns the message at an offset in a payload, and the offset of its end."""

Codecs: TypeAlias = "Sequence[ArrayCodec | Array | None]"
"""The codec of each leaf of a layout; None for those that are not arrays."""


def compiled(layout: Layout, codecs: Codecs) -> tuple[Write, Scan]:
    """Return the two functions of a type."""
    return _Source(layout, codecs).functions()


class _Source:
    """The statements of the two functions, and the names that they use."""

    def __init__(self, layout: Layout, codecs: Codecs) -> None:
        self.layout, self.codecs = layout, codecs
        self.space: dict[str, object] = {
            "booleans": BOOLEANS,
            "check": check_type,
            "encode": str.encode,
            "length": length,
            "malformed": Malformed,
            "new": object.__new__,
            "nul": b"\0",
            "numbers": NumberArray,
            "stray": STRAY_BYTES,
        }

    def functions(self) -> tuple[Write, Scan]:
        write = ["def write(m0):", *_Writing(self).statements()]
        scan = ["def scan(data, at):", *_Reading(self).statements()]
        text = "\n ".join(write) + "\n" + "\n ".join(scan)
        exec(text, self.space)  # noqa: S102 - made from the names in lcm-gen's own code
        return cast("Write", self.space["write"]), cast("Scan", self.space["scan"])

    def name(self, letter: str, thing: object) -> str:
        """Return a new name for an object that the statements use."""
        name = f"{letter}{len(self.space)}"
        self.space[name] = thing
        return name

    def part(self, place: int) -> str:
        """Return the assignment's left side for a part: "m0", "m1 = m0.linear"."""
        part = self.layout.parts[place]
        return f"m{place} = m{part.owner}.{part.name}" if part.name else f"m{place}"

    def leaves(self) -> Iterator[tuple[Leaf, ArrayCodec | Array | None, str, str]]:
        """Yield each leaf with its codec, its expression and the expression of its size."""
        for leaf, codec in zip(self.layout.leaves, self.codecs, strict=True):
            owner, sizes = f"m{leaf.part}", leaf.field.dimensions
            cls = self.layout.parts[leaf.part].cls
            counts = [
                f"{owner}.{attribute(cls, size)}" if isinstance(size, str) else str(size)
                for size in sizes
            ]
            size = counts[0] if len(counts) == 1 else f"({', '.join(counts)})"
            yield leaf, codec, f"{owner}.{leaf.field.attribute}", size


class _Writing:
    """The statements that write a message in parts: packed numbers, strings and arrays."""

    def __init__(self, source: _Source) -> None:
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
        for leaf, codec, target, size in source.leaves():
            if codec:
                self._pack()
                self._add_array(leaf.field, f"{source.name('r', codec)}.write", target, size)
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

    def _add_array(self, part: Field, write: str, target: str, size: str) -> None:
        """Add an array; an array of numbers as returned by ``scan`` needs no call."""
        if not _holds_numbers(part) or part.is_bytes or is_short(part.dimensions[0]):
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


class _Reading:
    """The statements that read a message."""

    def __init__(self, source: _Source) -> None:
        self._source = source
        self._lines: list[str] = []
        self._base, self._offset = "at", 0  # the sum of these is the offset of the next field
        self._codes = ""  # codes of the numbers that are read next
        self._targets: list[str] = []
        self._may_be_behind = False  # True if the last read may go beyond the payload's end

    def statements(self) -> list[str]:
        for place, part in enumerate(self._source.layout.parts):
            new = f"new({self._source.name('c', part.cls)})"
            self._lines.append(f"{self._source.part(place)} = {new}")
        for leaf, codec, target, size in self._source.leaves():
            if leaf.is_number:
                self._codes += FORMATS[leaf.field.type]
                self._targets.append(target)
                if isinstance(leaf.field.type, EnumType):
                    self._unpack()
                    enum = self._source.name("e", leaf.field.type.cls)
                    self._lines.append(f"{target} = {enum}({target})")
            elif codec is None:
                self._string(target)
            elif not self._array_of_numbers(leaf.field, target, size):
                self._unpack()
                scan = self._source.name("scan", codec.scan)
                self._lines.append(f"{target}, end = {scan}(data, {self._here()}, {size})")
                self._base, self._offset = "end", 0
        self._unpack()
        if self._may_be_behind:
            self._lines.append("if end > len(data): raise malformed")
        return [*self._lines, f"return m0, {self._here()}"]

    def _here(self) -> str:
        return f"{self._base} + {self._offset}" if self._offset else self._base

    def _unpack(self) -> None:
        """Add a statement that reads the collected numbers."""
        if self._codes:
            targets = ", ".join(self._targets)
            self._add_unpacking(f"{targets},", struct.Struct(f">{self._codes}"))
            self._codes, self._targets = "", []

    def _add_unpacking(self, targets: str, packer: struct.Struct) -> None:
        unpack = self._source.name("unpack", packer.unpack_from)
        self._lines.append(f"{targets} = {unpack}(data, {self._here()})")
        self._offset += packer.size
        self._may_be_behind = False

    def _string(self, target: str) -> None:
        self._codes += "I"
        self._targets.append("n")
        self._unpack()
        self._lines += [
            f"at = {self._here()}",
            "end = at + n",
            f"{target} = data[at:end - 1].decode()",
            "if data[end - 1]: raise malformed",
        ]
        self._base, self._offset = "end", 0

    def _array_of_numbers(self, part: Field, target: str, size: str) -> bool:
        """Add the statements for an array of numbers or bytes; return False for others."""
        if not _holds_numbers(part):
            return False
        self._unpack()
        if is_short(part.dimensions[0]) and not part.is_bytes:
            self._add_unpacking(target, numbers_struct(int(size), FORMATS[part.type]))
            return True
        packer = struct.Struct(f">{FORMATS[part.type]}")
        self._lines += [
            f"at = {self._here()}",
            f"end = at + {packer.size} * {size}",
        ]
        if part.is_bytes:
            self._lines += ["if end < at: raise malformed", f"{target} = data[at:end]"]
        else:
            made = f"{target} = v = numbers({FORMATS[part.type]!r}"
            self._lines += [
                f"if end > at: {made}, data[at:end]); {'v.byteswap()' if IS_LITTLE else 'pass'}",
                f"elif end == at: {made})",
                "else: raise malformed",
            ]
        self._base, self._offset = "end", 0
        self._may_be_behind = True
        return True


def _holds_numbers(part: Field) -> bool:
    """Return True for arrays of one dimension, of numbers or bytes."""
    is_other = part.type == "bool" or isinstance(part.type, EnumType)
    return len(part.dimensions) == 1 and not is_other and part.type in FORMATS


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
