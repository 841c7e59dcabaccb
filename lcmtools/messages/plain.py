"""Messages as plain values: dicts, lists, numbers, booleans and text; also as JSON and table cells.

Belongs here: a message as plain values, and views that only name, cut or shift some of them. Must
not know files, nor the layout of plain values as text: see ``text``.
"""

from array import array
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias, cast

from lcmtools.clock import NANOSECONDS, join_stamp
from lcmtools.formats.strict_json import write_json
from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import TIME_FIELDS, Field, fields, is_time, visible_fields
from lcmtools.messages.layout import longest_array
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.path import Target
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.shape import as_bytes, as_sequence, inner_lengths, lone_lengths

Plain: TypeAlias = "bool | int | float | str | list[Plain] | dict[str, Plain]"
"""A message as plain values."""

Cell: TypeAlias = "int | float | str"
"""A value in a column of a table."""

PLAIN_TYPES = frozenset((bool, int, float, str))
_TIME_TYPES = {"std_msgs/Time", "builtin_interfaces/Time"}  # a Duration is already relative


class More(str):
    """The mark for omitted values; it is written unchanged, also among numbers."""

    __slots__ = ()


MORE = More("...")


class View(NamedTuple):
    """Options for showing values."""

    hides_arrays: bool = False  # arrays are only named: <array type: float64, length: 5>
    hides_strings: bool = False  # and strings, too: <string length: 5>
    longest: int | None = None  # elements and characters after which arrays and strings are cut
    most_elements: int | None = None  # of an array, if ``longest`` is None; ``ellipsis`` follows
    ellipsis: str = MORE  # "{}" in it stands for the number of omitted elements
    origin: int | None = None  # [ns since 1970] points in time are shown relative to this one
    is_table: bool = False  # hidden values are left out, and cut ones have no dots

    def __bool__(self) -> bool:
        """Return True if it changes how any value is shown."""
        return self is not NOTHING and self != NOTHING

    def changes(self, cls: type[Message]) -> bool:
        """Return True if it can change how a message of a type is shown."""
        if not self:
            return False
        most = self.most_elements
        is_short = most is None or longest_array(cls) <= most
        return not is_short or bool(self._replace(most_elements=None, ellipsis=MORE))

    def omits(self, field: Field) -> bool:
        """Return True for a field that is left out."""
        return self.is_table and (
            (self.hides_arrays and bool(field.dimensions))
            or (self.hides_strings and field.type == "string")
        )


NOTHING = View()
"""Everything is shown unchanged."""


def to_plain(message: Message, view: View = NOTHING) -> dict[str, Plain]:
    """Return a message, as accepted by ``encode``, as a dict; uint8 arrays as lists of numbers.

    Length fields are left out, except one that no array shows: ``cols`` without rows. Infinities
    and NaN stay floats, which JSON cannot hold: see ``to_json``.
    """
    cls = type(message)
    plain = {
        field.name: plain_value(getattr(message, field.attribute), field, view)
        for field in shown_fields(message, view)
        if not view.omits(field)
    }
    is_moved = view.origin is not None and is_time(cls) and type_name(cls) in _TIME_TYPES
    return _since(plain, cast("int", view.origin)) if is_moved else plain


def shown_fields(message: Message, view: View = NOTHING) -> tuple[Field, ...]:
    """Return the fields of a message that are shown; see ``to_plain``."""
    cls = type(message)
    if view.is_table or not inner_lengths(cls):
        return visible_fields(cls)
    lone = lone_lengths(message)
    return tuple(field for field in fields(cls) if not field.is_length or field in lone)


def plain_value(value: object, what: Field | Target, view: View = NOTHING) -> Plain:
    """Return the value of a field or a path's target as plain values; see ``to_plain``."""
    return _plain(value, what, what.depth, view)


def plain_scalar(value: object) -> Plain:
    """Return a value unchanged, or for a numpy number Python's own."""
    return value.item() if hasattr(value, "item") else cast("Plain", value)


def to_json(message: Message) -> str:
    """Return a message as one line of JSON, which is also YAML that ``fill`` reads back."""
    return write_json(to_plain(message))


def cells(plain: Plain, name: str = "field", joint: str = "") -> dict[str, Cell]:
    """Return the scalars in a plain value by column: ``field.header.stamp``, ``field.x0``.

    The columns are those of ``rostopic echo -p``; ``joint`` is put between a name and an index.
    Several dimensions, which ROS does not have, are joined by ``_``: [1][10] and [11][0] are 1_10
    and 11_0. A time or a duration is one cell, in nanoseconds; a boolean is 1 or 0.
    """
    if isinstance(plain, dict) and tuple(plain) in TIME_FIELDS:
        return {name: join_stamp(*cast("dict[str, int]", plain).values())}
    if isinstance(plain, dict):
        parts = [(f"{name}.{key}", value) for key, value in plain.items()]
    elif isinstance(plain, list):
        parts = [(f"{name}{joint}{index}", value) for index, value in enumerate(plain)]
    else:
        return {name: int(plain) if isinstance(plain, bool) else plain}
    inner = "_" if isinstance(plain, list) else ""
    rows = (cells(value, part, inner) for part, value in parts)
    return {column: cell for row in rows for column, cell in row.items()}


def _plain(value: object, what: Field | Target, depth: int, view: View) -> Plain:
    """Convert a value with ``depth`` lists around each element."""
    if depth:
        return _plain_array(value, what, depth, view)
    if what.message_class:
        return to_plain(cast("Message", value), view)
    if isinstance(what.type, EnumType):
        return what.type.plain(cast("int", value))
    if what.type == "string" and view:
        return _plain_string(cast("str", value), view)
    return plain_scalar(value)


def _plain_array(value: object, what: Field | Target, depth: int, view: View) -> Plain:
    if depth == 1 and what.type == "uint8":
        elements: Sequence[object] = as_bytes(value) or _zeros(what)
    else:
        elements = value if isinstance(value, NumberArray) else as_sequence(value)
    if view.hides_arrays:
        return f"<array type: {what.type}, length: {len(elements)}>"
    shown = elements[: view.most_elements if view.longest is None else view.longest]
    is_number = not (what.message_class or isinstance(what.type, EnumType))
    is_simple = depth == 1 and is_number and not (view and what.type == "string")
    if isinstance(shown, array) and is_number:
        plain: list[Plain] = shown.tolist()
    elif is_simple and PLAIN_TYPES.issuperset(map(type, shown)):  # numpy's numbers are rare
        plain = cast("list[Plain]", list(shown))
    else:
        plain = [_plain(element, what, depth - 1, view) for element in shown]
    if len(shown) == len(elements) or view.is_table:
        return plain
    more = view.ellipsis if view.longest is None else MORE
    return [*plain, More(more.format(len(elements) - len(shown)))]


def _zeros(what: Field | Target) -> bytes:
    """Return zeros for a byte array of fixed size, which lcm-gen's class initializes as empty."""
    size = what.dimensions[-1] if isinstance(what, Field) else 0
    return bytes(size) if isinstance(size, int) else b""


def _plain_string(text: str, view: View) -> str:
    if view.hides_strings:
        return f"<string length: {len(text)}>"
    if view.longest is None or len(text) <= view.longest:
        return text
    return text[: view.longest] + ("" if view.is_table else MORE)


def _since(time: dict[str, Plain], origin: int) -> dict[str, Plain]:
    """Return the time since another point in time; its nanoseconds are never negative."""
    since = join_stamp(*cast("dict[str, int]", time).values()) - origin
    return dict(zip(time, divmod(since, NANOSECONDS), strict=True))
