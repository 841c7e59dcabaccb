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
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from operator import attrgetter
from typing import cast

from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.plain import plain_scalar, plain_value
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import STRAY_BYTES
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
_STRAY = re.compile("[\udc80-\udcff]")
_NSEC_WIDTH = 9
_PLAIN = frozenset((bool, int, float, str))
_RESERVED = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def format_message(message: Message) -> str:
    """A message as ``rostopic echo`` shows it, without an end of line; "" if it has no fields."""
    return _message_text(message, "")


def quoted(text: str) -> str:
    """A string as YAML in double quotes, '' if it is empty; all but ASCII is escaped.

    YAML has no escape for bytes that are not UTF-8: where there are any, it is ``!!binary``.
    """
    if not text.isascii() and _STRAY.search(text):
        return _binary(text)
    return f'"{_ESCAPED.sub(_escape, text)}"' if text else "''"


def quoted_at_end(text: str) -> str:
    """The same at the end of a line, where a comment can say what ``!!binary`` is."""
    shown = quoted(text)
    is_binary = shown.startswith("!")
    return f"{shown} # {text.encode('utf-8', STRAY_BYTES)!r}" if is_binary else shown


def _message_text(message: Message, indent: str) -> str:
    return _form(type(message), indent).fill(message)


@dataclass(frozen=True, slots=True)
class _Form:
    """The format of one class's messages: a text with gaps, and the values for them.

    Attributes:
        template: The text; %r where a number goes, %s where a text does.
        values: What goes there, out of a message.
        texts: The gaps of texts, by number, and what turns their values into them.
    """

    template: str
    values: Callable[[Message], Iterable[object]]
    texts: tuple[tuple[int, Callable[[object], str]], ...]

    def fill(self, message: Message) -> str:
        """The text of a message."""
        values = list(self.values(message))
        for place, text in self.texts:
            values[place] = text(values[place])
        if not _PLAIN.issuperset(map(type, values)):  # numpy's numbers have a repr of their own
            values = list(map(plain_scalar, values))
        return self.template % tuple(values)


# Writing is most of what echo does, and what is the same for all messages of a class need not be
# worked out again for each: that makes it about three times as fast (bench/codec.py).
@cache
def _form(cls: type[Message], indent: str) -> _Form:
    lines: list[str] = []
    leaves: list[tuple[str, Callable[[object], str] | None]] = []
    _add_fields(cls, indent, "", lines, leaves)
    paths = [path for path, _ in leaves]
    texts = tuple((place, text) for place, (_, text) in enumerate(leaves) if text)
    return _Form("\n".join(lines), _getter(paths), texts)


def _getter(paths: Sequence[str]) -> Callable[[Message], Iterable[object]]:
    """A function that takes the values at some paths out of a message."""
    if len(paths) > 1:
        return attrgetter(*paths)  # gives a tuple only where there are several
    return lambda message: [attrgetter(path)(message) for path in paths]


def _add_fields(
    cls: type[Message],
    indent: str,
    path: str,
    lines: list[str],
    leaves: list[tuple[str, Callable[[object], str] | None]],
) -> None:
    """Add the lines of a class's fields, and the path and the text of each value in them."""
    for field in visible_fields(cls):
        head, where = f"{indent}{field.name}: ", f"{path}{field.name}"
        if field.message_class and not field.dimensions:
            lines.append(head)
            _add_fields(field.message_class, f"{indent}  ", f"{where}.", lines, leaves)
            continue
        text = _text_of(field, f"{indent}  ")
        padding = _NSEC_WIDTH if is_time(cls) and field.name != "sec" else ""
        lines.append(f"{head}%{padding}{'s' if text else 'r'}")
        leaves.append((where, text))


def _text_of(field: Field, indent: str) -> Callable[[object], str] | None:
    """A function that writes a field's value; None for a number."""
    if field.dimensions and not field.message_class and field.type != "string":
        return lambda value: repr(plain_value(value, field))
    if field.dimensions:
        return lambda value: "\n".join(_block(field, value, "", indent))
    return cast("Callable[[object], str]", quoted_at_end) if field.type == "string" else None


def _block(field: Field, value: object, head: str, indent: str, depth: int = 1) -> Iterator[str]:
    """An array of strings or messages, an item each below the head."""
    elements = as_sequence(value)
    yield head if elements else f"{head}[]"
    for element in elements:
        if depth < len(field.dimensions):
            yield from _block(field, element, f"{indent}- ", f"{indent}  ", depth + 1)
        elif field.message_class:
            yield f"{indent}- "
            if text := _message_text(cast("Message", element), f"{indent}  "):
                yield text
        else:
            yield f"{indent}- {word_or_quoted(cast('str', element))}"


def word_or_quoted(text: str) -> str:
    """A string in a list: without quotes where no YAML parser needs them."""
    is_word = _WORD.fullmatch(text) and text.lower() not in _RESERVED
    return text if is_word else quoted_at_end(text)


def _binary(text: str) -> str:
    from base64 import b64encode

    return f'!!binary "{b64encode(text.encode("utf-8", STRAY_BYTES)).decode()}"'


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    code = ord(character)
    if character in _ESCAPES:
        return _ESCAPES[character]
    if code <= 0xFF:  # noqa: PLR2004 - the reach of two hexadecimal digits
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code <= 0xFFFF else f"\\U{code:08X}"  # noqa: PLR2004 - of four
