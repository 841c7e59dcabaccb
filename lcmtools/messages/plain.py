"""Messages as plain values: dicts, lists, numbers, booleans and text, and filled from them.

Belongs here: how fields are named in a dict or numbered in a list, and what is said when they do
not match. Must not know YAML's syntax (see ``yaml_input``) nor the wire format.
"""

import math
import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TypeAlias, cast

from lcmtools.messages.fields import Field, field_name, fields, visible_fields
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import STRAY_BYTES, Misfit, from_python, from_text, given
from lcmtools.messages.shape import Element, as_bytes, as_sequence, each, shaped

Plain: TypeAlias = "bool | int | float | str | list[Plain] | dict[str, Plain]"
"""A message as plain values."""

Value: TypeAlias = "bool | int | float | str | bytes | Sequence[Value] | Mapping[str, Value] | None"
"""Values to fill a message from. Text is read by the field's type."""

_PLAIN = frozenset((bool, int, float, str))

# Legal in JSON, but in YAML forbidden or a line's end; and JSON should be YAML here. Half
# characters are bytes that are not UTF-8.
_NOT_IN_YAML = re.compile("[\x7f-\x9f\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff]")


def to_plain(message: Message) -> dict[str, Plain]:
    """A message that ``encode`` takes as a dict; arrays of uint8 are lists of numbers.

    Length fields are left out. Infinities and NaN stay floats, which JSON cannot hold: see
    ``to_json``.
    """
    return {
        field.name: plain_value(getattr(message, field.name), field)
        for field in visible_fields(type(message))
    }


def plain_value(value: object, field: Field) -> Plain:
    """The value of one field, as in ``to_plain``."""
    return _plain(value, field, 0)


def to_json(message: Message) -> str:
    """A message as one line of JSON, which is also YAML that ``fill`` takes back.

    Infinities and NaN are the strings "inf", "-inf" and "nan".
    """
    return plain_json(to_plain(message))


def plain_json(plain: Plain) -> str:
    """A plain value as one line of JSON, as in ``to_json``."""
    try:
        text = _json(plain)
    except ValueError:
        text = _json(_finite(plain))
    return _NOT_IN_YAML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def fill(message: Message, value: Value) -> None:
    """Set the fields of a message from plain values; those that are not named stay as they are.

    A mapping sets fields by name, a list sets all fields in order, None sets none; a single value
    sets the only field of a message that has one. Text is read as the field's type asks ("0x1F"
    is a number in a number field), numbers and booleans may also be themselves.

    Raises:
        ValueMismatch: Something does not fit; it names the field. The message is half filled then.
    """
    try:
        _fill(message, value)
    except Misfit as misfit:
        raise misfit.mismatch(type_name(message)) from None


def _plain(value: object, field: Field, depth: int) -> Plain:
    last = depth == len(field.dimensions) - 1
    if last and field.is_bytes:
        return list(as_bytes(value)) or _zeros(field.dimensions[-1])
    if last and not field.message_class:
        return _plain_row(as_sequence(value))
    if depth < len(field.dimensions):
        return [_plain(element, field, depth + 1) for element in as_sequence(value)]
    if field.message_class:
        return to_plain(cast("Message", value))
    return plain_scalar(value)


def _plain_row(elements: Sequence[object]) -> list[Plain]:
    """Numbers, booleans or strings; seldom there are numpy's among them."""
    if _PLAIN.issuperset(map(type, elements)):
        return cast("list[Plain]", list(elements))
    return [plain_scalar(element) for element in elements]


def plain_scalar(value: object) -> Plain:
    """A value as it is, or Python's own number for one of numpy's."""
    return value.item() if hasattr(value, "item") else cast("Plain", value)


def _zeros(size: int | str) -> list[Plain]:
    """An empty array of bytes on the wire: zeros, if its size is fixed."""
    return [0] * size if isinstance(size, int) else []


def _json(plain: Plain) -> str:
    import json

    return json.dumps(plain, allow_nan=False, ensure_ascii=False, separators=(",", ":"))


def _finite(plain: Plain) -> Plain:
    if isinstance(plain, dict):
        return {name: _finite(value) for name, value in plain.items()}
    if isinstance(plain, list):
        return [_finite(value) for value in plain]
    return plain if not isinstance(plain, float) or math.isfinite(plain) else str(plain)


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
    message = cls()
    _fill(message, value)
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
        misfit = Misfit(f"is always the length of {' and '.join(arrays)}", "leave it out")
        misfit.inside(f".{key}")
        raise misfit
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
    misfit = Misfit(what, f"did you mean '{close[0]}'?" if close else "")
    misfit.inside(f".{key}")
    return misfit


def _colon_hint(cls: type[Message], text: Value, value: Value = None) -> str:
    """A hint at "x:1", which YAML takes for one word; "" for other values."""
    names = "|".join(re.escape(field.name) for field in visible_fields(cls))
    match = re.match(rf"({names}):([^\s,}}\]]+)", text) if names and isinstance(text, str) else None
    if not match or not (value is None or isinstance(value, str)):
        return ""
    return f"put a space after the colon: '{match[1]}: {match[2]}'"
