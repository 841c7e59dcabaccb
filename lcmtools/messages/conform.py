"""The careful way through a message: each value checked, or the path of the one that is wrong.

Belongs here: from the message that a user made to one that the codec can take as it is. Must not
know the wire format. It is slow; the codec comes here only when its fast way has failed.
"""

from functools import partial
from typing import cast

from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.misfit import Misfit, given
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.messages.scalars import from_python
from lcmtools.messages.shape import Element, lengths, shaped


def conformed(message: object, cls: type[Message]) -> Message:
    """A copy of a message in which everything is plain: lists, bytes, Python's own scalars.

    Its length fields are set.

    Raises:
        Misfit: A value does not fit; it knows its path.
    """
    if not _is_generated(cls):
        raise Misfit(f"expected a message, got {given(message)}")
    if not has_wire_type(message, cls):
        raise Misfit(f"expected {type_name(cls)}, got {_described(message)}")
    copy = cls()
    for field in visible_fields(cls):
        setattr(copy, field.name, _conformed_field(message, field))
    for name, count in lengths(copy).items():
        setattr(copy, name, count)
    return copy


def has_wire_type(message: object, cls: type[Message]) -> bool:
    """Return whether an object can go where a ``cls`` is wanted: the same fields in the same order.

    A geometry_msgs/Point may stand for a Vector3, as with lcm-gen's own encoders.
    """
    kind = cast("type[Message]", type(message))
    return kind is cls or (_is_generated(kind) and fingerprint(kind) == fingerprint(cls))


def _conformed_field(message: object, field: Field) -> object:
    value = getattr(message, field.name, None)
    try:
        return shaped(value, field, _element(field)) if field.dimensions else _element(field)(value)
    except Misfit as misfit:
        misfit.inside(f".{field.name}")
        raise


def _element(field: Field) -> Element:
    if field.message_class:
        return partial(conformed, cls=field.message_class)
    return partial(from_python, type_name=field.type)


def _described(value: object) -> str:
    cls = type(value)
    return type_name(cast("type[Message]", cls)) if _is_generated(cls) else given(value)


def _is_generated(cls: type) -> bool:
    return hasattr(cls, "__typenames__")
