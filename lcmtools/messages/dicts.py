"""Messages to dicts and back, for programs: the values are those of ``echo --json`` and ``pub``.

Belongs here: the public functions and their errors. Must not know text or files.
"""

from collections.abc import Callable, Mapping
from typing import TypeVar, cast

from lcmtools.errors import UsageError, ValueMismatch, explained
from lcmtools.messages.codec import NOT_PLAIN, encode
from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import Field
from lcmtools.messages.fill import Value, fill
from lcmtools.messages.layout import is_generated
from lcmtools.messages.plain import plain_value, shown_fields
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import given
from lcmtools.messages.shape import as_sequence

M = TypeVar("M", bound=Message)

MakeArray = Callable[[object], object]
"""A function that makes an array of numbers what a program needs: ``numpy.asarray``."""


@explained
def to_dict(message: Message, *, arrays: MakeArray | None = None) -> dict[str, object]:
    """Return a message as a dict of its fields, nested messages as dicts.

    Arrays are lists, also those of uint8, so that the module json takes them. An enum's value is
    its name, or its number if it has none. Length fields are left out, as they are set from the
    arrays.

    Args:
        message: A message of any class made by lcm-gen.
        arrays: Called with each array of numbers instead. With ``numpy.asarray``, those of received
            messages become numpy arrays that share their memory.

    Raises:
        UsageError: It is not a message.
        ValueMismatch: A field has a value that does not fit it.
    """
    if not _is_class(type(message)):
        raise UsageError(f"to_dict: expected a message, got {given(message)}")
    try:
        return _to_dict(message, arrays)
    except NOT_PLAIN:
        encode(message)  # names the field
        raise


@explained
def from_dict(cls: type[M], values: Mapping[str, object]) -> M:
    """Return a new message with the values of a dict; other fields keep their defaults.

    A nested message is a dict, or a list of its fields' values in order. Arrays may be lists,
    tuples, numpy arrays or bytes; text is read as by ``lcmtools pub``.

    Args:
        cls: The message's class.
        values: Values by field: what ``to_dict`` returns, or what ``json.loads`` does for a line of
            ``lcmtools echo --json``.

    Raises:
        UsageError: It is not a message class, or not a dict.
        ValueMismatch: There is no such field, or a value does not fit it; the error names it.
    """
    if not _is_class(cls):
        what = f"from_dict: expected a message class, got {given(cls)}"
        raise UsageError(what, "write lcmtools.from_dict(Twist, {...})")
    if not isinstance(values, Mapping):
        what = f"from_dict: expected a dict of {type_name(cls)}'s fields, got {given(values)}"
        raise UsageError(what)
    message = cls()
    if fill(message, cast("Value", values)):
        what = f"{type_name(cls)}: 'now' and 'auto' mean the time at which a message is sent"
        raise ValueMismatch(what, "give the time, or let lcmtools.publish.publish send the dict")
    encode(message)  # sets length fields; arrays that share one must be equally long
    return message


def _is_class(value: object) -> bool:
    return isinstance(value, type) and is_generated(value)


def _to_dict(message: Message, arrays: MakeArray | None) -> dict[str, object]:
    return {
        field.name: _value(getattr(message, field.attribute), field, field.depth, arrays)
        for field in shown_fields(message)
    }


def _value(value: object, field: Field, depth: int, arrays: MakeArray | None) -> object:
    if field.message_class and depth:
        return [_value(one, field, depth - 1, arrays) for one in as_sequence(value)]
    if field.message_class:
        return _to_dict(cast("Message", value), arrays)
    if arrays is None or not depth or field.type == "string" or isinstance(field.type, EnumType):
        return plain_value(value, field)
    if depth > 1:
        return arrays(plain_value(value, field))
    return arrays(memoryview(value) if isinstance(value, (bytes, bytearray)) else value)
