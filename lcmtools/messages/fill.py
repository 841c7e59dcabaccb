"""Filling messages from plain values: mappings by field name, lists in order, text and numbers.

Belongs here: the names of a message's fields, and errors for names that do not match; the words
``now`` (for a time, and for a number such as LCM's ``utime``) and ``auto`` (for a header, whose
stamp it sets), and a time as an integer number of nanoseconds, all accepted as by rostopic and
ros2. Must not know YAML's syntax (see ``message_template``), the wire format or a clock.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeAlias, cast

from lcmtools.clock import split_stamp
from lcmtools.messages.fields import (
    Field,
    field_name,
    fields,
    fields_hint,
    is_time,
    set_moment,
    visible_fields,
)
from lcmtools.messages.message_time import set_number, time_unit
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import STRAY_BYTES, Misfit, from_python, from_text, given
from lcmtools.messages.shape import Element, check_given_length, each, shaped
from lcmtools.names import closest

Value: TypeAlias = "bool | int | float | str | bytes | Sequence[Value] | Mapping[str, Value] | None"
"""Values to fill a message from. Text is interpreted by the field's type."""

SetTime: TypeAlias = Callable[[int], None]
"""Sets a time in a message to a moment [ns since 1970]."""

_WORDS = ("now", "auto")
_NANOSECONDS = re.compile(r"[-+]?[0-9]{1,19}")


def fill(message: Message, value: Value) -> tuple[SetTime, ...]:
    """Set the fields of a message from plain values; fields that are not named are kept.

    Returns a function for each time in it that must be set when it is sent.

    A mapping sets fields by name, a list sets all fields in order, None sets none; a single value
    sets the only field of a message that has one. Text is interpreted by the field's type ("0x1F"
    is a number in a number field); numbers and booleans may also be given as such.

    Raises:
        ValueMismatch: A value does not fit its field. The message is then half filled.
    """
    times: list[SetTime] = []
    try:
        _fill(message, value, times)
    except Misfit as misfit:
        raise misfit.mismatch(type_name(message)) from None
    return tuple(times)


def _fill(message: Message, value: Value, times: list[SetTime]) -> None:
    if tolist := getattr(value, "tolist", None):  # of numpy
        value = tolist()
    if value is None:
        return
    if isinstance(value, Mapping):
        _fill_by_name(message, value, times)
    elif isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        _fill_in_order(message, value, times)
    elif not _set_time(message, value, times):
        _fill_only_field(message, value, times)


def _set_time(message: Message, value: Value, times: list[SetTime]) -> bool:
    """Set a time or header from a word or nanoseconds; return False for other values."""
    name, is_moment = type_name(message), is_time(type(message))
    if value in _WORDS and is_moment and not name.endswith("/Duration"):
        times.append(partial(set_moment, message))
    elif value in _WORDS and name == "std_msgs/Header":
        times.append(partial(set_moment, message.stamp))  # type: ignore[attr-defined] # it has one
    elif is_moment and _NANOSECONDS.fullmatch(str(value)):
        _fill_in_order(message, split_stamp(int(cast("str", value))), times)
    else:
        return False
    return True


def _fill_by_name(message: Message, values: Mapping[str, Value], times: list[SetTime]) -> None:
    cls, seen = type(message), set()
    for key, value in values.items():
        field = _field_named(cls, str(key), value)  # a dict may have any keys
        if field in seen:
            raise Misfit(f"'{field.name}' is given twice, once as '{key}'")
        seen.add(field)
        _fill_field(message, field, value, times)
    for field in fields(cls):
        if field.is_length and field in seen:
            check_given_length(message, field)


def _fill_in_order(message: Message, values: Sequence[Value], times: list[SetTime]) -> None:
    targets = visible_fields(type(message))
    if len(targets) == 1 and _is_array_value(targets[0], values):
        _fill_field(message, targets[0], values, times)
        return
    if len(values) != len(targets):
        names = ", ".join(field.name for field in targets)
        plural = "s" if len(targets) > 1 else ""
        wanted = f"{len(targets)} value{plural} ({names})" if targets else "no fields"
        raise Misfit(f"expected {wanted}, got {len(values)}")
    for field, value in zip(targets, values, strict=True):
        _fill_field(message, field, value, times)


def _is_array_value(field: Field, values: Sequence[Value]) -> bool:
    """Return whether a list for a message with one field, an array, is the array itself.

    It is, unless it has only one element, a list, and the array's elements cannot be lists.
    """
    only_a_list = len(values) == 1 and isinstance(values[0], (list, tuple))
    elements_are_lists = len(field.dimensions) > 1 or field.message_class is not None
    return bool(field.dimensions) and (elements_are_lists or not only_a_list)


def _fill_only_field(message: Message, value: Value, times: list[SetTime]) -> None:
    cls = type(message)
    hint = _colon_hint(cls, value)
    targets = visible_fields(cls)
    if hint or len(targets) != 1:
        names = ", ".join(field.name for field in targets)
        wanted = f"fields ({names})" if targets else "no fields"
        raise Misfit(f"expected {wanted}, got {given(value)}", hint)
    _fill_field(message, targets[0], value, times)


def _fill_field(message: Message, field: Field, value: Value, times: list[SetTime]) -> None:
    try:
        if field.dimensions:
            ready = _bytes_of_text(value, len(field.dimensions)) if field.is_bytes else value
            setattr(message, field.attribute, shaped(ready, field, _element(field, times)))
        elif field.message_class:
            _fill(getattr(message, field.attribute), value, times)
        elif isinstance(value, str) and value == "now" and (unit := time_unit(field)):
            times.append(partial(set_number, message, field, unit))
        else:
            setattr(message, field.attribute, _scalar(value, field.type))
    except Misfit as misfit:
        misfit.inside(f".{field.name}")
        raise


def _element(field: Field, times: list[SetTime]) -> Element:
    if field.message_class:
        return partial(_new, field.message_class, times)
    return partial(_scalar, type_name=field.type)


def _new(cls: type[Message], times: list[SetTime], value: Value) -> Message:
    _fill(message := cls(), value, times)
    return message


def _scalar(value: object, type_name: str) -> object:
    if isinstance(value, bytes) and type_name == "string":  # !!binary
        return value.decode("utf-8", STRAY_BYTES)
    if isinstance(value, str):
        return from_text(value, type_name)
    return from_python("" if value is None and type_name == "string" else value, type_name)


def _bytes_of_text(value: Value, dimensions: int) -> object:
    """Convert text to UTF-8 if it is given for the innermost dimension of an array of bytes."""
    if isinstance(value, str):
        return from_text(value, "string").encode("utf-8", STRAY_BYTES)  # type: ignore[union-attr] # text
    if dimensions > 1 and isinstance(value, (list, tuple)):
        return each(value, lambda row: _bytes_of_text(row, dimensions - 1))  # type: ignore[arg-type] # rows are values
    return value


def _field_named(cls: type[Message], key: str, value: Value) -> Field:
    found = {field.name: field for field in fields(cls)}
    key = field_name(cls, key)
    if key not in found:
        raise _unknown_field(cls, key, value)
    return found[key]


def _unknown_field(cls: type[Message], key: str, value: Value) -> Misfit:
    what = f"{type_name(cls)} has no field '{key}' ({fields_hint(cls)})"
    hint = _colon_hint(cls, key, value)
    return Misfit(what, hint) if hint else Misfit(what, _field_hint(cls, key)).inside(f".{key}")


def _field_hint(cls: type[Message], key: str) -> str:
    """Return a hint at the intended field: a similar name, or one in a nested message."""
    known = {field.name: field.message_class for field in visible_fields(cls)}
    outer, point, inner = key.partition(".")
    if point and known.get(outer):
        return f"write {{{outer}: {{{inner}: ...}}}}"
    if key.isdigit() and known:
        return "numbers have a decimal point, no comma: 0.5"
    if near := closest(key, known):
        return f"did you mean '{near[0]}'?"
    for name, nested in known.items():
        if nested and any(field.name == key for field in visible_fields(nested)):
            return f"write {{{name}: {{{key}: ...}}}}"
    return ""


def _colon_hint(cls: type[Message], text: Value, value: Value = None) -> str:
    """Return a hint about "x:1", which is a single word in YAML; "" for other values."""
    names = "|".join(re.escape(field.name) for field in visible_fields(cls))
    match = re.match(rf"({names}):([^\s,}}\]]+)", text) if names and isinstance(text, str) else None
    if not match or not (value is None or isinstance(value, str)):
        return ""
    return f"put a space after the colon: '{match[1]}: {match[2]}'"
