"""Values outside of messages, such as parameters: their kinds, and their YAML as one line.

Belongs here: conversion between text and a value of a kind. Must not know nodes. Text is read as in
a message's field: ``1e-3`` is a number; ``on`` is true if a boolean is expected, and text if text
is.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TypeAlias

from lcmtools.errors import ValueMismatch
from lcmtools.formats.strict_yaml import QuotedText, read_documents
from lcmtools.messages.fill import Value
from lcmtools.messages.scalars import Misfit, Scalar, from_python, from_text, given
from lcmtools.messages.shape import each
from lcmtools.messages.text import INPUT

ParameterValue: TypeAlias = "Scalar | Sequence[Scalar] | None"
"""A single value, a list of them, or nothing."""

ANY = "any"
"""The kind that accepts every value."""
LIST = "list"  # a list with elements of several kinds

_FIELD_TYPES = {"bool": "bool", "int": "int64", "float": "float64", "string": "string"}
_KINDS: dict[type, str] = {bool: "bool", int: "int", float: "float", str: "string"}
_QUOTES = "'\""
_WHOLE = re.compile(r"[-+]?(?:[0-9]+|0x[0-9a-f]+|0o[0-7]+|0b[01]+)", re.IGNORECASE)


def kind_of(value: ParameterValue) -> str:
    """Return bool, int, float or string, these with [] for a list of one kind, list, or any (None).

    ValueMismatch is raised for all other values.
    """
    if value is None:
        return ANY
    if isinstance(value, (list, tuple)):
        kinds = {kind_of(element) for element in value}
        return f"{kinds.pop()}[]" if len(kinds) == 1 and not kinds & {ANY, LIST} else LIST
    for kind, name in _KINDS.items():
        if isinstance(value, kind):
            return name
    raise ValueMismatch(f"{given(value)} is not a value that a parameter can have")


def read_setting(text: str, kind: str, path: str) -> ParameterValue:
    """Return the value of a text as a kind (see ``kind_of``), else raise ValueMismatch.

    The text is YAML; for a string it is the string itself, unless it is quoted.
    ``path`` is the value's name in errors, for example "parameter kp".
    """
    own = _unquoted(text)
    if kind == "string" or (kind == ANY and own is not None):
        return check_setting(text if own is None else own, "string", path)
    try:
        value = _parsed(text)
    except ValueMismatch as mismatch:
        raise ValueMismatch(f"{path}: {mismatch.what}", mismatch.hint) from None
    return _converted(value, kind, path, _scalar_of_text)


def check_setting(value: object, kind: str, path: str) -> ParameterValue:
    """Return ``value`` as a plain value of a kind, else ValueMismatch; integers may be floats."""
    return _converted(value, kind, path, _scalar_of_python)


def text_of(value: Value, kind: str) -> str:
    """Return a value of a YAML document as text that ``read_setting`` accepts for a kind."""
    if value is None and kind == "string":
        return write_setting("")
    if isinstance(value, (list, tuple)):
        element = kind.removesuffix("[]") if kind.endswith("[]") else ANY
        return f"[{', '.join(text_of(part, element) for part in value)}]"
    if isinstance(value, Mapping):
        parts = (f"{write_setting(key)}: {text_of(part, ANY)}" for key, part in value.items())
        return f"{{{', '.join(parts)}}}"
    if isinstance(value, bytes):
        raise ValueMismatch("binary data is not a value that a parameter can have")
    if isinstance(value, str):
        is_open = kind in (ANY, LIST) and not isinstance(value, QuotedText)
        return write_setting(guessed(value) if is_open else value)
    return write_setting(None)


write_setting = INPUT.flow
"""The function that returns a value as one line of YAML, which ``read_setting`` reads back."""


def _converted(
    value: object, kind: str, path: str, scalar: Callable[[object, str], Scalar]
) -> ParameterValue:
    try:
        if kind == ANY and value is None:
            return None
        is_list = kind.endswith("[]") or kind == LIST
        if is_list or (kind == ANY and isinstance(value, (list, tuple))):
            return _elements(value, kind.removesuffix("[]"), scalar)
        return scalar(value, kind)
    except Misfit as misfit:
        raise misfit.inside(path).mismatch("") from None


def _elements(value: object, kind: str, scalar: Callable[[object, str], Scalar]) -> list[Scalar]:
    if not isinstance(value, (list, tuple)):
        raise Misfit(f"expected a list, got {given(value)}")
    element_kind = kind if kind in _FIELD_TYPES else ANY
    return each(value, lambda element: scalar(element, element_kind))  # type: ignore[return-value] # scalar's


def _scalar_of_text(value: object, kind: str) -> Scalar:
    if not isinstance(value, str):
        raise Misfit(f"expected {_EXPECTED[kind]}, got {given(value)}")
    if kind == ANY:
        return str(value) if isinstance(value, QuotedText) else guessed(value)
    return from_text(value, _FIELD_TYPES[kind])


def _scalar_of_python(value: object, kind: str) -> Scalar:
    if kind != ANY:
        return from_python(value, _FIELD_TYPES[kind])
    item = getattr(value, "item", None)  # numpy's scalars
    plain = item() if callable(item) else value
    if not isinstance(plain, (bool, int, float, str)):
        raise Misfit(f"expected {_EXPECTED[ANY]}, got {given(value)}")
    return plain


_EXPECTED = {
    "bool": "true or false",
    "int": "an integer",
    "float": "a number",
    "string": "text",
    ANY: "a number, true, false or text",
}


def guessed(text: str) -> Scalar:
    """Return the value of a text without a declared kind."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        return from_text(text, "int64" if _WHOLE.fullmatch(text) else "float64")
    except Misfit:
        return from_text(text, "string")


def _unquoted(text: str) -> str | None:
    """Return the content of a text that is a single quoted YAML scalar; else None."""
    if len(text) < 2 or text[0] not in _QUOTES or text[-1] != text[0]:  # noqa: PLR2004 - two quotes
        return None
    with suppress(ValueMismatch):
        value = _parsed(text)
        return value if isinstance(value, str) else None
    return None


def _parsed(text: str) -> Value:
    from lcmtools.messages.documents import parse_values  # not needed to start a node

    value = parse_values([text])
    if isinstance(value, list) and not {*_QUOTES}.isdisjoint(text):
        return next(node.plain() for node in read_documents(text) if node)
    return value
