"""The time of a message: its header's stamp, or a number in a field such as ``utime``.

Belongs here: the names of such fields, and the unit of their numbers. Must not know a clock.
"""

import re
from collections.abc import Iterator
from functools import cache
from typing import NamedTuple, cast

from lcmtools.messages.fields import Field, fields, stamp
from lcmtools.messages.registry import Message

UNITS = {"nanoseconds": 1, "microseconds": 10**3, "milliseconds": 10**6, "seconds": 10**9}
"""Units and their lengths [ns]."""

_NAME = re.compile(
    r"(?:t|time|stamp|(?:\w+_)?utime|\w*time_?stamp)(?:_?(?:([umn])s(?:ecs?)?|(micro|milli|nano)s))?"
)
_LETTERS = {"u": "micro", "m": "milli", "n": "nano"}
_HEADERS = ("header", "hdr")
_NUMBERS = ("int64", "float64")
FIRST_TIME = 10**18
"""The first time since 1970 that counts as one (2001) [ns]; an earlier one is of another base."""
_LAST = 4 * 10**18  # [ns since 1970] 2096


class MessageTime(NamedTuple):
    """The time of a message."""

    field: str  # "header.stamp", "utime", "timestamp"
    value: float  # the number in the field
    time: int = 0  # [ns since 1970]; 0 if the number is not a time
    unit: str = ""  # of the number; "" for a header's stamp

    def __str__(self) -> str:
        """Return the field, with the unit where it was found: "timestamp (milliseconds)"."""
        is_usual = not self.unit or self.field == "utime"
        return self.field if is_usual else f"{self.field} ({self.unit})"


def message_time(message: Message) -> MessageTime | None:
    """Return the time of a message; None if its type has none.

    It is the header's stamp, else ``utime``, in microseconds as in LCM's event logs and examples,
    else a field with a similar name (``timestamp``, ``t``, ``time_ms``), also in a header of
    another type. Its unit is the one by which the number is a time in this century.
    """
    stamped = stamp(message)
    if stamped is not None:
        return MessageTime("header.stamp", stamped, stamped)
    found = [(path, _value(message, path)) for path in _time_fields(type(message))]
    times = (_in_unit(".".join(path), value) for path, value in found)
    known = next((one for one in times if one), None)
    return known or next((MessageTime(".".join(path), value) for path, value in found), None)


def _in_unit(field: str, value: float) -> MessageTime | None:
    if field == "utime" and isinstance(value, int):
        return MessageTime(field, value, value * 1000, "microseconds")
    for unit, length in UNITS.items():
        is_usual = (unit == "seconds") == isinstance(value, float)  # whole seconds are too coarse
        if is_usual and FIRST_TIME <= value * length < _LAST:
            return MessageTime(field, value, int(value * length), unit)
    return None


def time_unit(field: Field) -> str | None:
    """Return the unit of a field whose name says that it has a time; None for other fields.

    A name without a unit, such as ``utime`` or ``timestamp``, means microseconds, as in LCM's event
    logs and examples, or seconds for a float64.
    """
    named = _NAME.fullmatch(field.name.lower())
    if field.dimensions or field.type not in _NUMBERS or not named:
        return None
    if prefix := named[2] or _LETTERS.get(named[1]):
        return f"{prefix}seconds"
    return "seconds" if field.type == "float64" else "microseconds"


def set_number(message: Message, field: Field, unit: str, moment: int) -> None:
    """Set a field with a time in this unit to a moment [ns since 1970]."""
    is_whole = field.type == "int64"
    value = moment // UNITS[unit] if is_whole else moment / UNITS[unit]
    setattr(message, field.attribute, value)


@cache
def _time_fields(cls: type[Message]) -> tuple[tuple[str, ...], ...]:
    """Return the attributes that lead to the fields of times, ``utime`` first."""
    return tuple(sorted(_named_fields(cls), key=lambda path: (len(path), path != ("utime",))))


def _named_fields(cls: type[Message]) -> Iterator[tuple[str, ...]]:
    for field in fields(cls):
        if field.dimensions:
            continue
        if time_unit(field):
            yield (field.attribute,)
        elif field.message_class and field.name.lower() in _HEADERS:
            yield from ((field.attribute, *path) for path in _named_fields(field.message_class))


def _value(message: Message, path: tuple[str, ...]) -> float:
    value: object = message
    for name in path:
        value = getattr(value, name)
    return cast("float", value)
