"""Messages as the text that ``rostopic echo`` prints, which ``message_from_values`` takes back.

Belongs here: how a message looks in a terminal. Must not know where it goes, nor other formats.

    header:
      frame_id: "base_link"
    ranges: [1.0, inf]
    name:
      - left_wheel
    points:
      -
        x: 0.0
    stamp:
      sec: 12
      nsec:         5

It is YAML 1.1. Unlike rostopic's, long strings stay on one line, for grep.
"""

import re
from collections.abc import Iterator
from typing import cast

from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.plain import plain_value
from lcmtools.messages.registry import Message
from lcmtools.messages.shape import as_sequence

_ESCAPES = {
    "\0": "\\0",
    "\a": "\\a",
    "\b": "\\b",
    "\t": "\\t",
    "\n": "\\n",
    "\v": "\\v",
    "\f": "\\f",
    "\r": "\\r",
    "\x1b": "\\e",
    '"': '\\"',
    "\\": "\\\\",
    "\x85": "\\N",
    "\xa0": "\\_",
    "\u2028": "\\L",
    "\u2029": "\\P",
}
_ESCAPED = re.compile(r"[^ !#-\[\]-~]")

# Text that needs no quotes for any YAML parser: words that are not YAML's own, no numbers.
_WORD = re.compile(r"[A-Za-z_/][\w./-]*", re.ASCII)
_RESERVED = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def format_message(message: Message) -> str:
    """A message as ``rostopic echo`` shows it, without an end of line; "" if it has no fields."""
    return "\n".join(_message_lines(message, ""))


def quoted(text: str) -> str:
    """A string as YAML in double quotes, '' if it is empty; all but ASCII is escaped."""
    return f'"{_ESCAPED.sub(_escape, text)}"' if text else "''"


def _message_lines(message: Message, indent: str) -> Iterator[str]:
    cls = type(message)
    width = 9 if is_time(cls) else 0
    for field in visible_fields(cls):
        value = getattr(message, field.name)
        if field.dimensions:
            yield from _array_lines(field, value, indent)
        elif field.message_class:
            yield f"{indent}{field.name}: "
            yield from _message_lines(value, f"{indent}  ")
        elif field.type == "string":
            yield f"{indent}{field.name}: {quoted(value)}"
        else:
            padding = width if field.name != "sec" else 0
            yield f"{indent}{field.name}: {plain_value(value, field)!r:>{padding}}"


def _array_lines(field: Field, value: object, indent: str) -> Iterator[str]:
    if not field.message_class and field.type != "string":
        yield f"{indent}{field.name}: {plain_value(value, field)!r}"
    else:
        yield from _block(field, value, f"{indent}{field.name}: ", f"{indent}  ")


def _block(field: Field, value: object, head: str, indent: str, depth: int = 1) -> Iterator[str]:
    """An array of strings or messages, an item each below the head."""
    elements = as_sequence(value)
    yield head if elements else f"{head}[]"
    for element in elements:
        if depth < len(field.dimensions):
            yield from _block(field, element, f"{indent}- ", f"{indent}  ", depth + 1)
        elif field.message_class:
            yield f"{indent}- "
            yield from _message_lines(cast("Message", element), f"{indent}  ")
        else:
            yield f"{indent}- {word_or_quoted(cast('str', element))}"


def word_or_quoted(text: str) -> str:
    """A string in a list: without quotes where no YAML parser needs them."""
    is_word = _WORD.fullmatch(text) and text.lower() not in _RESERVED
    return text if is_word else quoted(text)


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    code = ord(character)
    if character in _ESCAPES:
        return _ESCAPES[character]
    if code <= 0xFF:  # noqa: PLR2004 - the reach of two hexadecimal digits
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code <= 0xFFFF else f"\\U{code:08X}"  # noqa: PLR2004 - of four
