"""Messages that command a velocity: their types, and creating one."""

from collections.abc import Iterator

from lcmtools.messages.codec import encode
from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.message_template import draft
from lcmtools.messages.registry import Message

USUAL = "geometry_msgs/Twist"  # the type for a topic without one
_HEADER = "std_msgs/Header"
_OTHERS = ("Accel", "Wrench", "Inertia")  # names of messages with the fields of a velocity


class VelocityCommand:
    """A message of a type that commands a velocity: Twist, TwistStamped, or one like them.

    The message itself, or its only nested one besides a header, has ``linear.x`` and ``angular.z``;
    ValueError for other classes.
    """

    def __init__(self, cls: type[Message]) -> None:
        path = _velocity_path(cls)
        if path is None:
            raise ValueError(f"{cls.__name__} commands no velocity")
        headers = {one.name: "auto" for one in visible_fields(cls) if one.type == _HEADER}
        self._template = draft(cls, headers)
        velocity = self._template.message
        for name in path:
            velocity = getattr(velocity, name)
        self._velocity = velocity

    def payload(self, forward: float, turn: float, now: int) -> bytes:
        """Return a payload with this speed [m/s], turn rate to the left [rad/s] and time [ns]."""
        self._velocity.linear.x = forward  # type: ignore[attr-defined] # has been looked up
        self._velocity.angular.z = turn  # type: ignore[attr-defined]
        return encode(self._template.at(now))


def commands_velocity(cls: type[Message]) -> bool:
    """Return whether messages of a type command a velocity."""
    return _velocity_path(cls) is not None


def _velocity_path(cls: type[Message]) -> tuple[str, ...] | None:
    if _is_velocity(cls):
        return ()
    inner = [one for one in _messages(cls) if one.type != _HEADER]
    if len(inner) == 1 and inner[0].message_class and _is_velocity(inner[0].message_class):
        return (inner[0].name,)
    return None


def _is_velocity(cls: type[Message]) -> bool:
    is_other = cls.__name__.startswith(_OTHERS)
    return not is_other and _has(cls, "linear", "x") and _has(cls, "angular", "z")


def _has(cls: type[Message], name: str, component: str) -> bool:
    """Return whether a message has a vector of this name, with this component as a number."""
    vectors = [one.message_class for one in _messages(cls) if one.name == name]
    return any(
        part.name == component and part.type.startswith("float") and not part.dimensions
        for vector in vectors
        if vector
        for part in visible_fields(vector)
    )


def _messages(cls: type[Message]) -> Iterator[Field]:
    """Yield the fields of a message that are single messages."""
    return (one for one in visible_fields(cls) if one.message_class and not one.dimensions)
