"""The definition of a type, as ``rosmsg show`` prints it.

Belongs here: how a type's fields and constants are written. Must not know values.
"""

from collections.abc import Iterator

from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import INTEGERS


def definition(cls: type[Message]) -> str:
    """The constants and fields of a type, nested types expanded below; "" if it has none.

        std_msgs/Header header
          int32 seq
          ...
        float64[36] covariance

    lcm-gen's classes keep a constant's value, not its type, so constants are shown with the
    smallest type that holds all of them, unsigned where it can be, as in ROS's own definitions.
    """
    return "\n".join(_lines(cls, "", ()))


def declaration(field: Field) -> str:
    """A field as a line of a definition: "float64[36] covariance", "string[] name"."""
    sizes = (str(size) if isinstance(size, int) else "" for size in field.dimensions)
    return f"{field.type}{''.join(f'[{size}]' for size in sizes)} {field.name}"


def _lines(cls: type[Message], indent: str, outer: tuple[type[Message], ...]) -> Iterator[str]:
    for line in _constants(cls):
        yield f"{indent}{line}"
    for field in visible_fields(cls):
        yield f"{indent}{declaration(field)}"
        nested = field.message_class
        if nested and nested not in (*outer, cls):  # a type may hold an array of itself
            yield from _lines(nested, f"{indent}  ", (*outer, cls))


def _constants(cls: type[Message]) -> Iterator[str]:
    values = {name: value for name, value in vars(cls).items() if isinstance(value, (int, float))}
    integers = [value for value in values.values() if isinstance(value, int)]
    for name, value in values.items():
        kind = _integer_type(integers) if isinstance(value, int) else "float64"
        yield f"{kind} {name}={value}"


def _integer_type(values: list[int]) -> str:
    fitting = (
        name for name, (low, high) in INTEGERS.items() if low <= min(values) and max(values) <= high
    )
    return next(fitting, "int64")
