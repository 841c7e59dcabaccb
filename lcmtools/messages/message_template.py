"""Messages as users write them, in which a time may be the moment of sending.

Belongs here: the words ``now`` (for a time) and ``auto`` (for a header, whose stamp it sets), and
whole numbers of nanoseconds for a time, as rostopic and ros2 take them. Must not know YAML's syntax
nor read a clock: the moment comes in as an argument.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Generic, TypeAlias, TypeVar, cast

from lcmtools.clock import split_stamp
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.fill import Value, fill
from lcmtools.messages.registry import Message, type_name

M = TypeVar("M", bound=Message)
Place: TypeAlias = "tuple[str | int, ...]"
"""The place of a time in a message: field names and array indices from the outside in."""

_WORDS = ("now", "auto")
_NANOSECONDS = re.compile(r"[-+]?[0-9]{1,19}")


@dataclass(slots=True)
class MessageTemplate(Generic[M]):
    """A message that is ready to be sent, once or often.

    Attributes:
        message: The message.
        times: Its times that are set whenever it is sent.
    """

    message: M
    times: tuple[Message, ...] = ()
    _payload: bytes | None = None

    def at(self, now: int) -> M:
        """The message as it is sent at ``now`` (nanoseconds since 1970)."""
        for time in self.times:
            for name, value in zip(time.__slots__, split_stamp(now), strict=True):
                setattr(time, name, value)
        return self.message

    def payload(self, now: int) -> bytes:
        """The same, encoded; what does not change is encoded once.

        Raises:
            ValueMismatch: A value does not fit, as a time outside its range.
        """
        if self.times:
            return encode(self.at(now))
        if self._payload is None:
            self._payload = encode(self.message)
        return self._payload


def draft(cls: type[M], value: Value) -> MessageTemplate[M]:
    """The message that a value of YAML or JSON means; see ``fill``.

    Raises:
        ValueMismatch: Something does not fit; it names the field.
    """
    places: list[Place] = []
    message = cls()
    fill(message, _spelled_out(cls, value, (), places))
    return MessageTemplate(message, tuple(_part(message, place) for place in places))


def _spelled_out(cls: type[Message], value: Value, place: Place, places: list[Place]) -> Value:
    """The value with its words for times replaced and their places noted; ``fill`` checks it."""
    if not _holds_time(cls):
        return value
    if isinstance(value, Mapping):
        named = {field.name: field for field in visible_fields(cls)}
        return {
            name: _field(named[name], part, place, places) if name in named else part
            for name, part in value.items()
        }
    if isinstance(value, (str, int)):
        return _word(cls, value, place, places)
    if isinstance(value, (list, tuple)):
        return _in_order(cls, value, place, places)
    return value


def _word(cls: type[Message], value: str | int, place: Place, places: list[Place]) -> Value:
    if is_time(cls):
        if value in _WORDS and not type_name(cls).endswith("/Duration"):
            places.append(place)
            return None
        if _NANOSECONDS.fullmatch(str(value)):
            return list(split_stamp(int(value)))
    elif type_name(cls) == "std_msgs/Header":
        if value in _WORDS:
            places.append((*place, "stamp"))
            return None
    elif len(only := visible_fields(cls)) == 1:
        part = _field(only[0], value, place, places)
        return value if part is value else [part]
    return value


def _in_order(
    cls: type[Message], values: Sequence[Value], place: Place, places: list[Place]
) -> Value:
    """A list of all fields, or the array that is the only one."""
    fields = visible_fields(cls)
    if len(fields) == 1 and fields[0].dimensions:
        return _field(fields[0], values, place, places)
    if len(fields) != len(values):
        return values
    return [_field(*pair, place, places) for pair in zip(fields, values, strict=True)]


def _field(field: Field, value: Value, place: Place, places: list[Place]) -> Value:
    if field.message_class is None:
        return value
    here = (*place, field.name)
    return _elements(field.message_class, value, here, places, len(field.dimensions))


def _elements(
    cls: type[Message], value: Value, place: Place, places: list[Place], dimensions: int
) -> Value:
    if not dimensions:
        return _spelled_out(cls, value, place, places)
    if not isinstance(value, (list, tuple)) or not _holds_time(cls):
        return value
    return [
        _elements(cls, element, (*place, index), places, dimensions - 1)
        for index, element in enumerate(value)
    ]


@cache
def _holds_time(cls: type[Message]) -> bool:
    """True if messages of this type have a time in them."""
    return is_time(cls) or any(
        field.message_class is not None and _holds_time(field.message_class)
        for field in visible_fields(cls)
    )


def _part(message: Message, place: Place) -> Message:
    part: object = message
    for step in place:
        part = getattr(part, step) if isinstance(step, str) else cast("list[object]", part)[step]
    return cast("Message", part)
