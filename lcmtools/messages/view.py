"""Selected values as plain ones, with what a person has asked to see otherwise.

Belongs here: arrays and strings that are only named or cut, and times relative to another. Must
not know paths, files, nor how a plain value is written: ``plain_text`` and ``cells`` do that.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.fields import PRIMITIVES, Field, is_time, visible_fields
from lcmtools.messages.path import Selection, Target
from lcmtools.messages.plain import Plain
from lcmtools.messages.plain_text import MORE
from lcmtools.messages.registry import Message, type_name

_NANOSECONDS = 1_000_000_000
_NUMBERS = frozenset(PRIMITIVES.values()) - {"string"}
_TIME_TYPES = {"std_msgs/Time", "builtin_interfaces/Time"}  # a Duration is relative already


@dataclass(frozen=True, slots=True)
class View:
    """A view that changes what is shown of values.

    Attributes:
        hides_arrays: All arrays are only named: ``<array type: float64, length: 5>``.
        hides_strings: All strings: ``<string length: 5>``.
        longest: Longer arrays and strings are cut after so many elements; None for none.
        origin: Points in time are shown as the length of time since then, nanoseconds since 1970;
            None for as they are.
        is_table: For a table: what is hidden is left out, and no dots show where something is cut.
    """

    hides_arrays: bool = False
    hides_strings: bool = False
    longest: int | None = None
    origin: int | None = None
    is_table: bool = False

    def __bool__(self) -> bool:
        """Return whether anything is shown otherwise."""
        return self != NOTHING

    def omits(self, field: Field) -> bool:
        """Return whether a field is left out."""
        return self.is_table and (
            (self.hides_arrays and bool(field.dimensions))
            or (self.hides_strings and field.type == "string")
        )


NOTHING = View()
"""All is shown as it is."""


def plain_selection(selection: Selection, view: View) -> Plain:
    """A selected value as a plain one, as a view has it."""
    found = selection.target
    return _plain(selection.value, found, found.depth, view)


def _plain(value: object, what: Target, depth: int, view: View) -> Plain:
    if depth:
        return _plain_array(cast("Sequence[object]", value), what, depth, view)
    if what.message_class is not None:
        return _plain_message(cast("Message", value), view)
    if what.type == "string":
        return _plain_string(cast("str", value), view)
    return cast("Plain", value)


def _plain_string(text: str, view: View) -> str:
    if view.hides_strings:
        return f"<string length: {len(text)}>"
    if view.longest is None or len(text) <= view.longest:
        return text
    return text[: view.longest] + ("" if view.is_table else MORE)


def _plain_array(elements: Sequence[object], what: Target, depth: int, view: View) -> Plain:
    if view.hides_arrays:
        return f"<array type: {what.type}, length: {len(elements)}>"
    shown = elements[: view.longest]
    if depth == 1 and what.type in _NUMBERS:
        plain = cast("list[Plain]", list(shown))
    else:
        plain = [_plain(element, what, depth - 1, view) for element in shown]
    return plain if len(shown) == len(elements) or view.is_table else [*plain, MORE]


def _plain_message(message: Message, view: View) -> dict[str, Plain]:
    cls = type(message)
    plain = {
        field.name: _plain(
            getattr(message, field.name),
            Target(field.type, field.message_class, field.dimensions),
            len(field.dimensions),
            view,
        )
        for field in visible_fields(cls)
        if not view.omits(field)
    }
    is_moved = view.origin is not None and is_time(cls) and type_name(cls) in _TIME_TYPES
    return _since(plain, cast("int", view.origin)) if is_moved else plain


def _since(time: dict[str, Plain], origin: int) -> dict[str, Plain]:
    """A point in time as the length of time since another, whose nanoseconds are never negative."""
    seconds, nanoseconds = cast("dict[str, int]", time).values()
    passed = divmod(seconds * _NANOSECONDS + nanoseconds - origin, _NANOSECONDS)
    return dict(zip(time, passed, strict=True))
