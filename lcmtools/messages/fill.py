"""Messages filled from plain values: mappings by field name, lists in order, text and numbers.

Belongs here: the names of a message's fields, and the errors for those that do not match.
Must not know YAML's syntax (see ``yaml_input``) nor the wire format.
"""

import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TypeAlias

from lcmtools.messages.fields import Field, field_name, fields, visible_fields
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import STRAY_BYTES, Misfit, from_python, from_text, given
from lcmtools.messages.shape import Element, each, shaped

Value: TypeAlias = "bool | int | float | str | bytes | Sequence[Value] | Mapping[str, Value] | None"
"""Values to fill a message from. Text is read by the field's type."""


def fill(message: Message, value: Value) -> None:
    """Set the fields of a message from plain values; those that are not named stay as they are.

    A mapping sets fields by name, a list sets all fields in order, None sets none; a single value
    sets the only field of a message that has one. Text is read by the field's type ("0x1F"
    is a number in a number field), numbers and booleans may also be themselves.

    Raises:
        ValueMismatch: Something does not fit; it names the field. The message is half filled then.
    """
    try:
        _fill(message, value)
    except Misfit as misfit:
        raise misfit.mismatch(type_name(message)) from None


def _fill(message: Message, value: Value) -> None:
    if value is None:
        return
    if isinstance(value, Mapping):
        _fill_by_name(message, value)
    elif isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        _fill_in_order(message, value)
    else:
        _fill_only_field(message, value)


def _fill_by_name(message: Message, values: Mapping[str, Value]) -> None:
    cls, seen = type(message), set()
    for key, value in values.items():
        field = _field_named(cls, key, value)
        if field in seen:
            raise Misfit(f"'{field.name}' is given twice, once as '{key}'")
        seen.add(field)
        _fill_field(message, field, value)


def _fill_in_order(message: Message, values: Sequence[Value]) -> None:
    targets = visible_fields(type(message))
    if len(targets) == 1 and _is_array_value(targets[0], values):
        _fill_field(message, targets[0], values)
        return
    if len(values) != len(targets):
        names = ", ".join(field.name for field in targets)
        plural = "s" if len(targets) > 1 else ""
        wanted = f"{len(targets)} value{plural} ({names})" if targets else "no fields"
        raise Misfit(f"expected {wanted}, got {len(values)}")
    for field, value in zip(targets, values, strict=True):
        _fill_field(message, field, value)


def _is_array_value(field: Field, values: Sequence[Value]) -> bool:
    """Return whether a list for a message with one field, an array, is the array itself.

    It is, unless it holds nothing but one list where the array's elements cannot be lists.
    """
    only_a_list = len(values) == 1 and isinstance(values[0], (list, tuple))
    elements_are_lists = len(field.dimensions) > 1 or field.message_class is not None
    return bool(field.dimensions) and (elements_are_lists or not only_a_list)


def _fill_only_field(message: Message, value: Value) -> None:
    cls = type(message)
    hint = _colon_hint(cls, value)
    targets = visible_fields(cls)
    if hint or len(targets) != 1:
        names = ", ".join(field.name for field in targets)
        wanted = f"fields ({names})" if targets else "no fields"
        raise Misfit(f"expected {wanted}, got {given(value)}", hint)
    _fill_field(message, targets[0], value)


def _fill_field(message: Message, field: Field, value: Value) -> None:
    try:
        if field.dimensions:
            ready = _bytes_of_text(value, len(field.dimensions)) if field.is_bytes else value
            setattr(message, field.name, shaped(ready, field, _element(field)))
        elif field.message_class:
            _fill(getattr(message, field.name), value)
        else:
            setattr(message, field.name, _scalar(value, field.type))
    except Misfit as misfit:
        misfit.inside(f".{field.name}")
        raise


def _element(field: Field) -> Element:
    if field.message_class:
        return partial(_new, field.message_class)
    return partial(_scalar, type_name=field.type)


def _new(cls: type[Message], value: Value) -> Message:
    _fill(message := cls(), value)
    return message


def _scalar(value: object, type_name: str) -> object:
    if isinstance(value, bytes) and type_name == "string":  # !!binary
        return value.decode("utf-8", STRAY_BYTES)
    if isinstance(value, str):
        return from_text(value, type_name)
    return from_python("" if value is None and type_name == "string" else value, type_name)


def _bytes_of_text(value: Value, dimensions: int) -> object:
    """UTF-8 where text is given for the innermost dimension of an array of bytes."""
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
    if found[key].is_length:
        arrays = [field.name for field in visible_fields(cls) if key in field.dimensions]
        what = f"is always the length of {' and '.join(arrays)}"
        raise Misfit(what, "leave it out").inside(f".{key}")
    return found[key]


def _unknown_field(cls: type[Message], key: str, value: Value) -> Misfit:
    import difflib

    names = [field.name for field in visible_fields(cls)]
    known = f"fields: {', '.join(names)}" if names else "it has no fields"
    what = f"{type_name(cls)} has no field '{key}' ({known})"
    hint = _colon_hint(cls, key, value)
    if hint:
        return Misfit(what, hint)
    close = difflib.get_close_matches(key, names, n=1)
    return Misfit(what, f"did you mean '{close[0]}'?" if close else "").inside(f".{key}")


def _colon_hint(cls: type[Message], text: Value, value: Value = None) -> str:
    """A hint at "x:1", which YAML takes for one word; "" for other values."""
    names = "|".join(re.escape(field.name) for field in visible_fields(cls))
    match = re.match(rf"({names}):([^\s,}}\]]+)", text) if names and isinstance(text, str) else None
    if not match or not (value is None or isinstance(value, str)):
        return ""
    return f"put a space after the colon: '{match[1]}: {match[2]}'"
