"""A message as lines: its fields, indented. Must not know how a line is shown."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import cast

from lcmtools.clock import join_stamp
from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.registry import Message
from lcmtools.messages.text import quoted

MOST_LINES = 3000  # lines of a message; the rest is not shown
MOST_ELEMENTS = 100  # elements of an open array; the rest is not shown

_OPEN_NUMBERS, _OPEN_OTHERS = 6, 3  # arrays up to this length are open at first
_SHOWN = 8  # elements of a closed array
_SHOWN_BYTES = 16
_LONGEST_TEXT = 200
_DOTS = "…"


@dataclass(frozen=True, slots=True)
class FieldLine:
    """A line of a message."""

    path: str  # within the message: "pose.position.x", "ranges[3]"
    label: str  # the last part of the path
    depth: int  # levels of indentation
    text: str = ""  # the value, or a summary of an array
    number: float | None = None  # the value; None for other values
    opens: bool = False  # True if there are lines below it that can be shown or hidden
    is_open: bool = False  # True if they are shown


def field_lines(message: Message, toggled: Collection[str] = ()) -> list[FieldLine]:
    """Return the lines of a message; ``toggled`` paths are open instead of closed or vice versa."""
    return list(islice(_Lines(toggled).of_message(message, "", 0), MOST_LINES))


class _Lines:
    def __init__(self, toggled: Collection[str]) -> None:
        self._toggled = toggled

    def of_message(self, message: Message, path: str, depth: int) -> Iterator[FieldLine]:
        for field in visible_fields(type(message)):
            where = f"{path}.{field.name}" if path else field.name
            value = getattr(message, field.attribute)
            if field.dimensions:
                yield from self._of_array(value, field, (where, field.name), depth, 1)
            else:
                yield from self._of_one(value, field, (where, field.name), depth)

    def _of_one(
        self, value: object, field: Field, name: tuple[str, str], depth: int
    ) -> Iterator[FieldLine]:
        path, label = name
        if field.message_class is None:
            number = float(cast("float", value)) if field.type != "string" else None
            yield FieldLine(path, label, depth, _scalar_text(value), number)
        elif is_time(field.message_class):
            seconds, nanoseconds = (getattr(value, part) for part in field.message_class.__slots__)
            total = join_stamp(seconds, nanoseconds)
            yield FieldLine(path, label, depth, f"{seconds}.{nanoseconds:09d}", total / 1e9)
        else:
            is_open = path not in self._toggled
            yield FieldLine(path, label, depth, opens=True, is_open=is_open)
            if is_open:
                yield from self.of_message(cast("Message", value), path, depth + 1)

    def _of_array(
        self, value: object, field: Field, name: tuple[str, str], depth: int, level: int
    ) -> Iterator[FieldLine]:
        path, label = name
        elements = cast("Sequence[object]", value)
        is_inner = level < len(field.dimensions)
        is_number = not is_inner and field.message_class is None and field.type != "string"
        longest = _OPEN_NUMBERS if is_number else _OPEN_OTHERS
        is_short = len(elements) <= longest and not isinstance(elements, bytes)
        is_open = bool(elements) and (is_short is not (path in self._toggled))
        text = f"{field.type}[{len(elements)}]"
        if not is_open and not is_inner and elements:
            text += f" {_summary(elements, field)}"
        yield FieldLine(path, label, depth, text, opens=bool(elements), is_open=is_open)
        if not is_open:
            return
        for index, element in enumerate(elements[:MOST_ELEMENTS]):
            inner = (f"{path}[{index}]", f"[{index}]")
            if is_inner:
                yield from self._of_array(element, field, inner, depth + 1, level + 1)
            else:
                yield from self._of_one(element, field, inner, depth + 1)
        if len(elements) > MOST_ELEMENTS:
            more = f"{len(elements) - MOST_ELEMENTS} more"
            yield FieldLine(f"{path}[]", _DOTS, depth + 1, more)


def _summary(elements: Sequence[object], field: Field) -> str:
    if field.message_class is not None:
        return ""
    if isinstance(elements, bytes):
        shown = elements[:_SHOWN_BYTES].hex(" ")
        return f"{shown} {_DOTS}" if len(elements) > _SHOWN_BYTES else shown
    shown = ", ".join(
        f"{one:.4g}" if isinstance(one, float) else _scalar_text(one) for one in elements[:_SHOWN]
    )
    return f"{shown}, {_DOTS}" if len(elements) > _SHOWN else shown


def _scalar_text(value: object) -> str:
    if isinstance(value, str):
        long = len(value) > _LONGEST_TEXT
        return quoted(value[:_LONGEST_TEXT]) + (f" {_DOTS} {len(value)} characters" if long else "")
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)
