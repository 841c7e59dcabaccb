"""The fields of a message: the one reader of the tables in lcm-gen's classes.

Belongs here: names, types and array sizes of fields. Must not know values, bytes or text.
"""

import importlib
from functools import cache
from typing import NamedTuple, TypeAlias

from lcmtools.clock import join_stamp, split_stamp
from lcmtools.messages.enums import EnumValue, enum_type
from lcmtools.messages.registry import Message, type_name

PRIMITIVES = {
    "boolean": "bool",
    "byte": "uint8",
    "int8_t": "int8",
    "int16_t": "int16",
    "int32_t": "int32",
    "int64_t": "int64",
    "float": "float32",
    "double": "float64",
    "string": "string",
}
"""LCM's primitive types and their names in ROS, which lcmtools uses in all texts."""

TIME_FIELDS = (("sec", "nsec"), ("sec", "nanosec"))
"""The fields of times and durations, as in ROS 1 and ROS 2."""

_TIME_NAMES = {"sec": 0, "secs": 0, "nsec": 1, "nsecs": 1, "nanosec": 1}
"""The names of a time's two fields in ROS 1 and ROS 2, and their positions."""

MessageClass: TypeAlias = type[Message]  # within Field, ``type`` is a field


class Field(NamedTuple):
    """One field of a message.

    Array sizes (``dimensions``) are listed from the outermost inwards: a number, or the name of the
    length field that holds it.
    """

    name: str
    type: str  # a primitive by its ROS name ("float64"), or a message type
    message_class: MessageClass | None  # None for a primitive
    dimensions: tuple[int | str, ...]  # none for a single value
    is_length: bool  # True for the length of an array, which is set from the array
    attribute: str = ""  # its name in Python: "from_" for "from"

    @property
    def depth(self) -> int:
        """The number of lists around each element; 0 for a single value."""
        return len(self.dimensions)

    @property
    def is_bytes(self) -> bool:
        """True if it is an array of uint8, whose innermost dimension is a ``bytes``."""
        return self.type == "uint8" and bool(self.dimensions)


@cache
def fields(cls: type[Message]) -> tuple[Field, ...]:
    """Return all fields of a class, in wire order."""
    lengths = {size for sizes in cls.__dimensions__ for size in sizes or ()}
    table = zip(cls.__slots__, cls.__typenames__, cls.__dimensions__, strict=True)
    return tuple(
        _field(cls, name, lcm, sizes or [])._replace(is_length=name in lengths, attribute=name)
        for name, lcm, sizes in table
    )


@cache
def visible_fields(cls: type[Message]) -> tuple[Field, ...]:
    """Return the fields that users see and set: all except length fields."""
    return tuple(field for field in fields(cls) if not field.is_length)


@cache
def parts(cls: type[Message]) -> tuple[type[Message], ...]:
    """Return a class and those of its fields, at any depth, each once."""
    found = {cls: None}
    waiting = [cls]
    while waiting:
        nested = (field.message_class for field in fields(waiting.pop()))
        new = [one for one in nested if one and one not in found]
        found.update(dict.fromkeys(new))
        waiting += new
    return tuple(found)


@cache
def holds_itself(cls: type[Message]) -> bool:
    """Return True for a type with an array of itself at some depth, or a field of such a type."""
    return _recurs(cls, ())


@cache
def constants(cls: type[Message]) -> dict[str, int | float | str]:
    """Return the constants of a class by name; lcm-gen keeps their values, not their types."""
    own = _own_names(cls)
    members = ((own.get(name, name), name, value) for name, value in vars(cls).items())
    return {
        name: value
        for name, spelled, value in members
        if isinstance(value, (int, float, str)) and not spelled.startswith("__")
    }


def constant_types(cls: type[Message]) -> dict[str, str]:
    """The types of a class's constants by name, as far as known: lcm-gen keeps only the values."""
    known: dict[str, str] = getattr(cls, "__constant_types__", {})
    return {name: PRIMITIVES.get(kind, kind) for name, kind in known.items()}


def length_values(message: Message, field: Field) -> list[int]:
    """Return the array sizes of a field in a message, as its length fields say."""
    cls = type(message)
    return [
        size if isinstance(size, int) else int(getattr(message, attribute(cls, size)))
        for size in field.dimensions
    ]


def fields_hint(cls: type[Message]) -> str:
    """Return the fields of a class, for an error: "fields: x, y", or that it has none."""
    names = ", ".join(field.name for field in visible_fields(cls))
    return f"fields: {names}" if names else "it has no fields"


@cache
def is_time(cls: type[Message]) -> bool:
    """Return True for a time or a duration: seconds and nanoseconds, as ROS 1 or ROS 2."""
    return tuple(cls.__slots__) in TIME_FIELDS


@cache
def field_name(cls: type[Message], name: str) -> str:
    """Return a class's own name for a field.

    For a time, secs, nsecs and nanosec work too, for a field ``from`` Python's ``from_``.
    """
    if name in _TIME_NAMES and is_time(cls):
        return cls.__slots__[_TIME_NAMES[name]]
    return _own_names(cls).get(name, name)


@cache
def attribute(cls: type[Message], name: str) -> str:
    """Return the name of a field in Python: ``from_`` for ``from``."""
    return next((field.attribute for field in fields(cls) if field.name == name), name)


def stamp(message: Message) -> int | None:
    """Return the stamp in a message's ``header`` [ns since 1970]; None without std_msgs/Header."""
    header = getattr(message, "header", None)
    kind: type = type(header)
    if header is None or not _is_header(kind):
        return None
    return join_stamp(int(header.stamp.sec), int(header.stamp.nsec))


def set_moment(message: Message, moment: int) -> None:
    """Set a time to a moment [ns since 1970]."""
    for name, value in zip(message.__slots__, split_stamp(moment), strict=True):
        setattr(message, name, value)


def _recurs(cls: type[Message], outer: tuple[type[Message], ...]) -> bool:
    nested = {part.message_class for part in fields(cls) if part.message_class}
    return cls in outer or any(_recurs(one, (*outer, cls)) for one in nested)


@cache
def _is_header(cls: type) -> bool:
    return type_name(cls) == "std_msgs/Header"


def _own_names(cls: type[Message]) -> dict[str, str]:
    """The names of fields and constants by those in Python, where these differ."""
    renamed: dict[str, str] = getattr(cls, "__renamed__", {})
    return renamed


def _field(cls: type[Message], attribute: str, lcm_type: str, sizes: list[int | str]) -> Field:
    own = _own_names(cls)
    name = own.get(attribute, attribute)
    dimensions = tuple(own.get(n, n) if isinstance(n, str) else n for n in sizes)
    if lcm_type in PRIMITIVES:
        return Field(
            name, PRIMITIVES[lcm_type], None, dimensions, is_length=False, attribute=attribute
        )
    module, _, short = lcm_type.rpartition(".")  # ``Name`` alone is not in a package
    nested: type[Message] = getattr(importlib.import_module(module or short), short)
    if issubclass(nested, EnumValue):
        return Field(name, enum_type(nested), None, dimensions, is_length=False)
    return Field(name, type_name(nested), nested, dimensions, is_length=False)
