"""The statements that read a type, fast or carefully, from the rows of its layout.

Belongs here: which numbers are read together, and the checks of each way. For a std_msgs/Header:

    def scan(data, at):
        m0 = new(c0)
        m1 = m0.stamp = new(c1)
        m0.seq, m1.sec, m1.nsec, n, = unpack3(data, at)
        at = at + 16
        end = at + n
        m0.frame_id = data[at:end - 1].decode()
        if data[end - 1]: raise malformed('no NUL at the end of std_msgs/Header.frame_id')
        return m0, end

``scan`` leaves checks to ``unpack_from`` and to a last comparison with the end: an exception of any
kind means that the careful reader has to read the payload. That one has the same statements, except
that a cursor checks each place, and names the field that does not fit:

        n, = unpack5(data, cursor.advance(4, 'std_msgs/Header.frame_id'))
        at = cursor.advance(n, 'std_msgs/Header.frame_id')
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol, TypeAlias, cast

from lcmtools.messages.array_codec import (
    BOOLEANS,
    FORMATS,
    IS_LITTLE,
    MOST_KEPT,
    STRING_BYTES,
    Cursor,
    Malformed,
    is_short,
    length,
    numbers_struct,
)
from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import attribute
from lcmtools.messages.layout import Leaf, check_type, is_bounded, layout, smallest
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import STRAY_BYTES

_LENGTH = "length"  # the type of a string's length
_CODES = {**FORMATS, _LENGTH: "I"}


Scan: TypeAlias = Callable[[bytes, int], tuple[Message, int]]
"""Returns the message at an offset in a payload, and the offset of its end."""

Read: TypeAlias = Callable[[Cursor], Message]
"""Returns the message at a cursor; Malformed describes a fault."""


class Readers(Protocol):
    """The functions that read a type."""

    @property
    def scan(self) -> Scan:
        """The fast one."""


class Source:
    """The layout of a type, and the names that the statements use."""

    def __init__(self, cls: type[Message], of: Callable[[type[Message]], Readers]) -> None:
        self.layout, self.of = layout(cls), of  # the functions of another type
        self._space: dict[str, object] = {
            "booleans": BOOLEANS,
            "check": check_type,
            "encode": str.encode,
            "length": length,
            "malformed": Malformed,
            "new": object.__new__,
            "nul": b"\0",
            "numbers": NumberArray,
            "stray": STRAY_BYTES,
            "struct": numbers_struct,
        }

    def function(self, head: str, lines: Sequence[str]) -> Callable[..., Any]:
        """Compile a function."""
        exec("\n ".join((f"def {head}:", *lines)), self._space)  # noqa: S102 - of names in our tables
        return cast("Callable[..., Any]", self._space[head.partition("(")[0]])

    def name(self, letter: str, thing: object) -> str:
        """Return a new name for an object that the statements use."""
        name = f"{letter}{len(self._space)}"
        self._space[name] = thing
        return name

    def part(self, place: int) -> str:
        """Return the assignment's left side for a part: "m0", "m1 = m0.linear"."""
        part = self.layout.parts[place]
        return f"m{place} = m{part.owner}.{part.name}" if part.name else f"m{place}"

    def leaves(self) -> Iterator[tuple[Leaf, str, list[str]]]:
        """Yield each leaf with its expression and the expressions of its sizes."""
        for leaf in self.layout.leaves:
            owner, cls = f"m{leaf.part}", self.layout.parts[leaf.part].cls
            sizes = [
                f"{owner}.{attribute(cls, size)}" if isinstance(size, str) else str(size)
                for size in leaf.field.dimensions
            ]
            yield leaf, f"{owner}.{leaf.field.attribute}", sizes


class Reading:
    """The statements of ``scan``, in ``lines``."""

    decoding = ""  # the arguments with which a string's bytes are decoded

    def __init__(self, source: Source) -> None:
        self._source = source
        self.lines: list[str] = []
        self._indent = ""
        self._base, self._offset = "at", 0  # the sum of these is the offset of the next field
        self._run: list[tuple[str, str, str]] = []  # the next numbers: type, target and place
        self._is_behind = False  # True if the last read may go beyond the payload's end
        self._begin()
        for leaf, target, sizes in source.leaves():
            self._begin_leaf()
            if leaf.is_number:
                self._run.append((leaf.field.type, target, leaf.where))
            elif sizes:
                self._unpack()
                self._add_array(leaf, sizes, target)
            else:
                self._add_string(leaf, target)
        self._unpack()
        self._end()

    def _begin(self) -> None:
        for place, part in enumerate(self._source.layout.parts):
            new = f"new({self._source.name('c', part.cls)})"
            self._add(f"{self._source.part(place)} = {new}")

    def _begin_leaf(self) -> None:
        """Prepare for the next leaf."""

    def _end(self) -> None:
        if self._is_behind:
            self._add("if end > len(data): raise malformed")
        self._add(f"return m0, {self._here()}")

    def _add(self, *lines: str) -> None:
        self.lines += [self._indent + line for line in lines]

    def _here(self) -> str:
        return f"{self._base} + {self._offset}" if self._offset else self._base

    def _place(self, size: int, where: str) -> str:  # noqa: ARG002 - for the careful reader
        """Return the expression of the offset of some bytes that are read next."""
        here = self._here()
        self._offset += size
        self._is_behind = False  # ``unpack_from`` raises
        return here

    def _span(self, size: str, where: str) -> None:  # noqa: ARG002 - for the careful reader
        """Let ``at`` and ``end`` be the offsets of the next bytes and of their end."""
        self._add(f"at = {self._here()}", f"end = at + {size}")
        self._base, self._offset, self._is_behind = "end", 0, True

    def _settle(self) -> None:
        """Let ``end`` be the offset of the next field, as at both ends of a loop's body."""
        if self._here() != "end":
            self._add(f"end = {self._here()}")
        self._base, self._offset, self._is_behind = "end", 0, True

    def _check(self, leaf: Leaf, counts: Sequence[str]) -> None:
        """Check, before the loop, that an array of strings, messages or rows can follow."""
        if counts[1:]:
            size = f"{' * '.join(counts)} * {_least(leaf)}"
            self._add(
                f"if min({', '.join(counts)}) < 1 or {size} > len(data) - end: raise malformed"
            )
        elif not counts[0].isdecimal():
            self._add(f"if {counts[0]} < 0: raise malformed")

    def _unpack(self) -> None:
        """Add a statement that reads the collected numbers."""
        if not self._run:
            return
        codes = "".join(_CODES[kind] for kind, *_ in self._run)
        targets = "".join(f"{target}, " for _, target, _ in self._run)
        self._add_unpacking(targets, struct.Struct(f">{codes}"), self._run[0][2])
        for kind, target, _ in self._run:
            if isinstance(kind, EnumType):
                self._add(f"{target} = {self._source.name('e', kind.cls)}({target})")
        self._run = []

    def _add_unpacking(self, targets: str, packer: struct.Struct, where: str) -> None:
        unpack = self._source.name("unpack", packer.unpack_from)
        self._add(f"{targets}= {unpack}(data, {self._place(packer.size, where)})")

    def _add_string(self, leaf: Leaf, target: str) -> None:
        self._run.append((_LENGTH, "n", leaf.where))
        self._unpack()
        self._span("n", leaf.where)
        fault = f"no NUL at the end of {leaf.where}"
        self._add(  # lcm-gen accepts a string without NUL: its length ends in one
            f"{target} = data[at:end - 1].decode({self.decoding})",
            f"if data[end - 1]: raise malformed({fault!r})",
        )
        self._is_behind = False

    def _add_array(self, leaf: Leaf, counts: Sequence[str], target: str) -> None:
        """Add the statements for an array, or for a row of one."""
        if leaf.field.type in FORMATS and not counts[1:]:
            self._add_numbers(leaf, counts[0], target)
        elif leaf.field.depth == 1 and leaf.field.type == "string":
            self._add_strings(leaf, counts, target)
        else:
            self._add_loop(leaf, counts, target)

    def _add_numbers(self, leaf: Leaf, count: str, target: str) -> None:
        kind, code = leaf.field.type, FORMATS[leaf.field.type]
        if leaf.field.is_bytes:
            self._span(count, leaf.where)
            self._add("if end < at: raise malformed", f"{target} = data[at:end]")
            return
        is_plain = kind != "bool" and not isinstance(kind, EnumType)
        if is_plain and is_short(leaf.field.dimensions[-1]):
            self._add_unpacking(f"{target} ", numbers_struct(int(count), code), leaf.where)
            return
        self._span(f"{struct.calcsize(f'>{code}')} * {count}", leaf.where)
        if is_plain:
            swap = "v.byteswap()" if IS_LITTLE else "pass"
            self._add(
                f"if end > at: {target} = v = numbers({code!r}, data[at:end]); {swap}",
                f"elif end == at: {target} = v = numbers({code!r})",
                "else: raise malformed",
            )
        else:
            values = f"struct({count}, {code!r}).unpack_from(data, at)"
            enum = self._source.name("e", kind.cls) if isinstance(kind, EnumType) else ""
            self._add(f"{target} = list({f'map({enum}, {values})' if enum else values})")

    def _add_strings(self, leaf: Leaf, counts: Sequence[str], target: str) -> None:
        """Add the statements for an array of strings, the last of which are kept."""
        kept = self._source.name("kept", [([], b"")])
        self._settle()
        self._add(
            f"k, block = {kept}[0]",
            f"if {counts[0]} == len(k) and data.startswith(block, end):",
            f" {target} = k.copy(); end += len(block)",
            "else:",
        )
        self._indent += " "
        self._add("start = end")
        self._add_loop(leaf, counts, target)
        keep = f"{kept}[0] = {target}.copy(), data[start:end]"
        self._add(f"if end - start <= {MOST_KEPT}: {keep}")
        self._indent = self._indent[1:]

    def _add_loop(self, leaf: Leaf, counts: Sequence[str], target: str) -> None:
        """Add the statements for an array of strings, messages or rows."""
        self._settle()
        self._check(leaf, counts)
        values, one = f"v{len(self.lines)}", f"x{len(self.lines)}"
        self._add(f"{values} = []", f"for _ in range({counts[0]}):")
        self._indent += " "
        if counts[1:]:
            self._add_array(leaf, counts[1:], one)
        elif leaf.field.message_class:
            self._add_message(leaf, leaf.field.message_class, one)
        else:
            self._add_string(leaf, one)
        self._settle()
        self._add(f"{values}.append({one})")
        self._indent = self._indent[1:]
        self._add(f"{target} = {values}")

    def _add_message(self, _: Leaf, cls: type[Message], target: str) -> None:
        if is_bounded(cls):
            inner = self._source.name("coder", self._source.of(cls))  # compiled when it is needed
            self._add(f"{target}, end = {inner}.scan(data, end)")
        else:
            self._add("raise malformed")


class CarefulReading(Reading):
    """The statements of ``read``, or those of ``read_available``."""

    decoding = '"utf-8", cursor.stray'

    def __init__(self, source: Source, *, may_end: bool = False) -> None:
        self._may_end = may_end
        super().__init__(source)

    def _begin(self) -> None:
        self._add("data = cursor.data")
        if not self._may_end:
            super()._begin()
            return
        self._add(f"m0 = {self._source.name('c', self._source.layout.parts[0].cls)}()")
        self._add(*map(self._source.part, range(1, len(self._source.layout.parts))))

    def _begin_leaf(self) -> None:
        if self._may_end:
            self._unpack()
            self._add("if cursor.offset == len(data): return m0")

    def _end(self) -> None:
        self._add("return m0")

    def _place(self, size: int, where: str) -> str:
        return f"cursor.advance({size}, {where!r})"

    def _span(self, size: str, where: str) -> None:
        self._add(f"at = cursor.advance({size}, {where!r})", "end = cursor.offset")

    def _settle(self) -> None:
        """Do nothing: the cursor is at the next field."""

    def _check(self, leaf: Leaf, counts: Sequence[str]) -> None:
        if counts[1:]:
            fault = f"negative length at {leaf.where}"
            self._add(f"if min({', '.join(counts)}) < 0: raise malformed({fault!r})")
        size = " * ".join([*counts[1:], str(_least(leaf))])
        self._add(f"cursor.expect({counts[0]}, {size}, {leaf.where!r})")

    def _add_string(self, leaf: Leaf, target: str) -> None:
        self._unpack()  # so that a fault is that of the string
        super()._add_string(leaf, target)

    def _add_strings(self, leaf: Leaf, counts: Sequence[str], target: str) -> None:
        self._add_loop(leaf, counts, target)

    def _add_message(self, leaf: Leaf, cls: type[Message], target: str) -> None:
        inner = self._source.name("coder", self._source.of(cls))
        self._add(
            f"cursor.enter({leaf.where!r})",
            f"{target} = {inner}.read(cursor)",
            "cursor.depth -= 1",
        )


def _least(leaf: Leaf) -> int:
    """Return the smallest size of an element of an array [byte]."""
    if leaf.field.message_class:
        return smallest(leaf.field.message_class)
    code = FORMATS.get(leaf.field.type)
    return struct.calcsize(f">{code}") if code else STRING_BYTES
