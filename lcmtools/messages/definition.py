"""A type as text: its definition, as in ``rosmsg show``, and its prototype, as in ``rosmsg-proto``.

Belongs here: the text of a type's fields, constants and defaults. Must not know messages.
"""

from collections.abc import Iterable, Iterator

from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import Field, constant_types, constants, visible_fields
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import INTEGERS
from lcmtools.messages.text import INPUT


def definition(cls: type[Message]) -> str:
    """Return a type's constants and fields, nested types expanded below; "" if it has none.

        std_msgs/Header header
          int32 seq
          ...
        float64[36] covariance

    Constants of shipped types are shown with the smallest type that holds all of them, unsigned if
    possible, as in ROS's own definitions; those of users' types as declared.
    """
    return "\n".join(_lines(cls, "", ()))


def prototype(cls: type[Message]) -> str:
    """Return the fields of a type with their defaults as YAML that ``pub`` accepts.

        linear:
          x: 0.0
        covariance: [0.0, 0.0]
        frame_id: ''

    It is "{}" for a type without fields.
    """
    return INPUT.block(to_plain(cls()))


def prototype_line(cls: type[Message]) -> str:
    """Return the same as one line: "{linear: {x: 0.0}, frame_id: ''}"."""
    return INPUT.flow(to_plain(cls()))


def declaration(field: Field) -> str:
    """Return a field as a line of a definition: "float64[36] covariance", "string[] name"."""
    element = type_name(field.type.cls) if isinstance(field.type, EnumType) else field.type
    return f"{array_type(element, field.dimensions)} {field.name}"


def array_type(element: str, dimensions: Iterable[int | str]) -> str:
    """Return a type with its array sizes: "float64[36]", "float32[]"."""
    return element + "".join(f"[{n}]" if isinstance(n, int) else "[]" for n in dimensions)


def _lines(cls: type[Message], indent: str, outer: tuple[type[Message], ...]) -> Iterator[str]:
    for line in _constants(cls):
        yield f"{indent}{line}"
    for field in visible_fields(cls):
        yield f"{indent}{declaration(field)}"
        nested = field.message_class
        if isinstance(field.type, EnumType):
            yield from (f"{indent}  int32 {n}={v}" for n, v in field.type.cls.__members__.items())
        if nested and nested not in (*outer, cls):  # a type may hold an array of itself
            yield from _lines(nested, f"{indent}  ", (*outer, cls))


def _constants(cls: type[Message]) -> Iterator[str]:
    values = constants(cls)
    whole = [value for value in values.values() if isinstance(value, int)] or [0]
    least, most = min(whole), max(whole)
    kind = next(name for name, (low, high) in INTEGERS.items() if low <= least and most <= high)
    usual = {int: kind, float: "float64", str: "string"}
    declared = constant_types(cls)
    for name, value in values.items():
        yield f"{declared.get(name) or usual[type(value)]} {name}={value}"
