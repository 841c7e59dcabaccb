"""Message types for pages: fields with comments, units and defaults, and filling them in."""

import re
from collections.abc import Mapping
from functools import cache

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json, MalformedRequest
from lcmtools.gui.source import Source
from lcmtools.messages.definition import array_type
from lcmtools.messages.documents import parse_values
from lcmtools.messages.fields import Field, fields, is_time, visible_fields
from lcmtools.messages.fill import Value
from lcmtools.messages.message_template import MessageTemplate, draft
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message, message_class, type_name, type_names
from lcmtools.packages.placed_type import Comment
from lcmtools.packages.user_types import type_comments


def names(source: Source) -> Json:
    """Return the names of all types; those on the bus first."""
    present = sorted({name for row in source.latest.rows for name in row.types})
    return [*present, *(name for name in type_names() if name not in present)]


def describe(_: Source, *, type: str) -> Json:  # noqa: A002 - the key of a request
    """Return a type with its fields, including nested ones."""
    kind = message_class(type)
    about = _comments(kind).get("", Comment())
    return {"type": type_name(kind), "comment": about.text, "fields": _fields(kind, ())}


def filled_in(type_text: str, values: Json) -> MessageTemplate[Message]:
    """Return the message for a page's form: its type, and its values by field.

    Values are texts, interpreted by the field's type; arrays are YAML. Empty texts keep
    the default, except in string fields.

    Raises:
        UnknownType: There is no such type.
        ValueMismatch: A value does not fit its field, which the error names.
    """
    kind = message_class(type_text)
    if not isinstance(values, Mapping):
        raise MalformedRequest("'values' is not an object")
    return draft(kind, _read(kind, values))


def _read(kind: type[Message], values: Mapping[str, Json]) -> Value:
    read: dict[str, Value] = {}
    known = {field.name: field for field in visible_fields(kind)}
    for name, value in values.items():
        field = known.get(name)
        is_nested = field and field.message_class and not field.dimensions
        if field and isinstance(value, Mapping) and is_nested and field.message_class:
            read[name] = _read(field.message_class, value)
        elif field and field.dimensions and isinstance(value, str):
            if value.strip():
                read[name] = parse_values([value])
        elif isinstance(value, (str, bool, int, float)):
            if value != "" or (field and field.type == "string"):
                read[name] = value
        else:
            raise MalformedRequest(f"the value of '{name[:40]}' is not a text")
    return read


@cache
def unit_of(kind: type[Message], path: str) -> str:
    """Return the unit of the number at a path: its field's, else that of the field around it.

    "" if it has none, or which of several is not known.
    """
    found, inner = "", kind
    for name in re.sub(r"\[\d*\]", "", path).split("."):
        found = _comments(inner).get(name, Comment()).unit or ("" if "," in found else found)
        nested = next((one.message_class for one in fields(inner) if one.name == name), None)
        if nested is None:
            break
        if is_time(nested):
            return "s"
        inner = nested
    return "" if found == "1" or "," in found else found


@cache
def _comments(kind: type[Message]) -> Mapping[str, Comment]:
    try:
        return type_comments(kind)
    except LcmtoolsError:  # a type from a log, or without its file
        return {}


def _fields(kind: type[Message], outer: tuple[type[Message], ...]) -> list[Json]:
    if kind in outer:  # it contains an array of itself
        return []
    about = _comments(kind)
    defaults = to_plain(kind())
    return [
        _field(field, about.get(field.name, Comment()), defaults.get(field.name), (*outer, kind))
        for field in visible_fields(kind)
    ]


def _field(
    field: Field, about: Comment, default: object, outer: tuple[type[Message], ...]
) -> Mapping[str, Json]:
    nested = field.message_class
    return {
        "name": field.name,
        "type": array_type(field.type, field.dimensions),
        "comment": about.text,
        "unit": about.unit,
        "isArray": bool(field.dimensions),
        "isTime": bool(nested and is_time(nested)),
        "fields": _fields(nested, outer) if nested and not is_time(nested) else [],
        "default": default if isinstance(default, (bool, int, float, str)) else None,
    }
