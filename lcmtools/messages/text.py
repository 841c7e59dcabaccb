"""Messages as the text that ``rostopic echo`` prints, which ``draft_from_values`` reads back.

Belongs here: the layout of messages and plain values as text. Must not know its destination.

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

It is YAML 1.1. Unlike in rostopic, long strings stay on one line, for grep.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from operator import attrgetter
from typing import NamedTuple, cast

from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import TIME_FIELDS, Field, is_time, parts, visible_fields
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.plain import (
    PLAIN_TYPES,
    More,
    Plain,
    plain_scalar,
    plain_value,
    to_plain,
)
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.messages.shape import as_sequence, inner_lengths

_ESCAPES = dict(zip('\0\a\b\t\n\v\f\r\x1b"\\\x85\xa0\u2028\u2029', '0abtnvfre"\\N_LP', strict=True))
_ESCAPED = re.compile(r"[^ !#-\[\]-~]")

# Text that needs no quotes for any YAML parser: neither reserved words nor numbers.
_WORD = re.compile(r"[A-Za-z_/][\w./-]*", re.ASCII)
# The same within brackets, where a few more characters are safe.
_WORDS = re.compile(r"[A-Za-z/_]([\w ./+@%-]*[\w./+@%-])?", re.ASCII)
_STRAY = re.compile("[\udc80-\udcff]")
_NSEC_WIDTH = 9
_NUMBERS = frozenset((bool, int, float))
_RESERVED = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def format_message(message: Message) -> str:
    """Format a message as in ``rostopic echo``, without a line end; "" if it has no fields."""
    cls = type(message)
    if any(map(inner_lengths, parts(cls))):  # a field may be shown for some messages only
        return FREE.block(to_plain(message))
    return _form(cls, "").fill(message)


def quoted(text: str) -> str:
    """Return a string as YAML in double quotes, '' if it is empty; what cannot be shown is escaped.

    YAML has no escape for bytes that are not UTF-8: if there are any, it becomes ``!!binary``.
    """
    if not text.isascii() and _STRAY.search(text):
        return _binary(text)
    return f'"{_ESCAPED.sub(_escape, text)}"' if text else "''"


def _quoted_at_end(text: str) -> str:
    """Return the same for the end of a line: a comment then shows the content of ``!!binary``."""
    shown = quoted(text)
    is_binary = shown.startswith("!")
    return f"{shown} # {text.encode('utf-8', STRAY_BYTES)!r}" if is_binary else shown


class Writer(NamedTuple):
    """The format of plain values.

    ``format_message`` does the same ten times as fast, but only for whole messages of ``FREE``.
    """

    width: int | None = None  # characters of a number, as in ``rostopic echo -w``
    is_input: bool = False  # as people write values: true, .inf, words; arrays in one line

    def block(self, plain: Plain) -> str:
        """Format a plain value as ``rostopic echo`` shows its message or field."""
        return "\n".join(self._lines(plain, "")) if self._is_block(plain) else self.flow(plain)

    def flow(self, plain: "Plain | Sequence[Plain] | None") -> str:
        """Format a plain value as one line, in YAML's flow style."""
        if isinstance(plain, dict):
            parts = (f"{name}: {self.flow(value)}" for name, value in plain.items())
            return f"{{{', '.join(parts)}}}"
        if isinstance(plain, str):
            return str(plain) if isinstance(plain, More) else self._text(plain)
        if isinstance(plain, Sequence):
            if self == FREE and _are_numbers(plain):
                return repr(plain)  # the same, but faster for images and clouds
            return f"[{', '.join(map(self.flow, plain))}]"
        if self.is_input:
            return _input(plain)
        return repr(plain) if self.width is None else _fixed(cast("float", plain), self.width)

    def _text(self, text: str) -> str:
        is_bare = self.is_input and _is_word(_WORDS, text)
        return text if is_bare else quoted(text)

    def _is_block(self, value: Plain) -> bool:
        """Return True for a message, and for an array with an element that needs several lines."""
        if self.is_input or not isinstance(value, list):
            return isinstance(value, dict) and bool(value or not self.is_input)
        return not _are_numbers(value) and any(
            (isinstance(part, str) and not isinstance(part, More)) or self._is_block(part)
            for part in value
        )

    def value(self, plain: Plain, indent: str) -> str:
        """Format a field's value, behind its name, or below it with an indent."""
        return (
            "\n".join(("", *self._lines(plain, indent)))
            if self._is_block(plain)
            else self.flow(plain)
        )

    def _lines(self, whole: Plain, indent: str) -> Iterator[str]:
        """Yield the lines of a message's fields or an array's elements, one below the other."""
        is_list = isinstance(whole, list)
        fields: dict[int, Plain] | dict[str, Plain] = cast("dict[str, Plain]", whole)
        if isinstance(whole, list):
            fields = dict(enumerate(whole))
        is_time = tuple(fields) in TIME_FIELDS
        for name, value in fields.items():
            head = f"{indent}- " if is_list else f"{indent}{name}: "
            if self._is_block(value):
                yield head.rstrip() if self.is_input else head
                yield from self._lines(value, f"{indent}  ")
            elif self.is_input:
                yield head + self.flow(value)
            elif isinstance(value, str) and not isinstance(value, More):
                yield head + (_word_or_quoted(value) if is_list else _quoted_at_end(value))
            else:
                is_padded = is_time and name != "sec" and self.width is None
                yield f"{head}{self.flow(value):>{_NSEC_WIDTH if is_padded else 0}}"


FREE = Writer()
"""The format in which numbers have as many characters as needed."""
INPUT = Writer(is_input=True)
"""The format of values that people may edit: prototypes of types, and parameters."""


def _word_or_quoted(text: str) -> str:
    """Return a string in a list, without quotes if no YAML parser needs them."""
    return text if _is_word(_WORD, text) else _quoted_at_end(text)


def _is_word(words: re.Pattern[str], text: str) -> bool:
    return bool(words.fullmatch(text)) and text.lower() not in _RESERVED


class _Form(NamedTuple):
    """The format of one class's messages: a template with %r for numbers and %s for texts.

    ``values`` gets the values from a message; ``texts`` has the indices of texts among them, and
    the functions that write these.
    """

    template: str
    values: Callable[[Message], Iterable[object]]
    texts: tuple[tuple[int, Callable[[object], str]], ...]

    def fill(self, message: Message) -> str:
        values = list(self.values(message))
        for place, text in self.texts:
            values[place] = text(values[place])
        if not PLAIN_TYPES.issuperset(map(type, values)):  # numpy's numbers have their own types
            values = list(map(plain_scalar, values))
        return self.template % tuple(values)


# Formatting is most of echo's work. The part that all messages of a class share is done once, which
# makes it about three times as fast (bench/codec.py).
@cache
def _form(cls: type[Message], indent: str) -> _Form:
    lines: list[str] = []
    leaves: list[tuple[str, Callable[[object], str] | None]] = []
    _add_fields(cls, indent, "", lines, leaves)
    paths = [path for path, _ in leaves]
    texts = tuple((place, text) for place, (_, text) in enumerate(leaves) if text)
    return _Form("\n".join(lines), _getter(paths), texts)


def _getter(paths: Sequence[str]) -> Callable[[Message], Iterable[object]]:
    """Return a function that gets the values at these paths from a message."""
    if len(paths) > 1:
        return attrgetter(*paths)  # returns a tuple only for several paths
    return lambda message: [attrgetter(path)(message) for path in paths]


def _add_fields(
    cls: type[Message],
    indent: str,
    path: str,
    lines: list[str],
    leaves: list[tuple[str, Callable[[object], str] | None]],
) -> None:
    """Add the lines of a class's fields, and for each value its path and text function."""
    for field in visible_fields(cls):
        head, where = f"{indent}{field.name}: ", f"{path}{field.attribute}"
        if field.message_class and not field.dimensions:
            lines.append(head)
            _add_fields(field.message_class, f"{indent}  ", f"{where}.", lines, leaves)
            continue
        text = _text_of(field, f"{indent}  ")
        padding = _NSEC_WIDTH if is_time(cls) and field.name != "sec" else ""
        lines.append(f"{head}%{padding}{'s' if text else 'r'}")
        leaves.append((where, text))


def _text_of(field: Field, indent: str) -> Callable[[object], str] | None:
    """Return a function that formats a field's value; None for a number."""
    if isinstance(field.type, EnumType):
        return lambda value: FREE.value(plain_value(value, field), indent)
    if field.dimensions and not field.message_class and field.type != "string":
        return lambda value: repr(
            value if isinstance(value, NumberArray) else plain_value(value, field)
        )
    if field.dimensions:
        return lambda value: "\n".join(_block(field, value, "", indent))
    return cast("Callable[[object], str]", _quoted_at_end) if field.type == "string" else None


def _block(field: Field, value: object, head: str, indent: str, depth: int = 1) -> Iterator[str]:
    """Yield the lines of an array of strings or messages: an item each, below the head."""
    elements = as_sequence(value)
    yield head if elements else f"{head}[]"
    for element in elements:
        if depth < len(field.dimensions):
            yield from _block(field, element, f"{indent}- ", f"{indent}  ", depth + 1)
        elif field.message_class:
            yield f"{indent}- "
            if text := _form(field.message_class, f"{indent}  ").fill(cast("Message", element)):
                yield text
        else:
            yield f"{indent}- {_word_or_quoted(cast('str', element))}"


def _are_numbers(values: Sequence[Plain]) -> bool:
    return _NUMBERS.issuperset(map(type, values))


def _input(value: object) -> str:
    """Return a number, a boolean or nothing in YAML's words."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return repr(value).replace("inf", ".inf").replace("nan", ".nan")


def _fixed(number: "bool | int | float", width: int) -> str:
    """Cut or pad a number as rostopic does; its integer part is never cut."""
    if isinstance(number, bool):
        return repr(number)
    if isinstance(number, int):
        return f"{number:{width}d}"
    text = f"{number:.{width}f}"
    return text[: max(text.find("."), width)]


def _binary(text: str) -> str:
    from base64 import b64encode

    return f'!!binary "{b64encode(text.encode("utf-8", STRAY_BYTES)).decode()}"'


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    code = ord(character)
    if character in _ESCAPES:
        return f"\\{_ESCAPES[character]}"
    if character.isprintable():
        return character
    if code <= 0xFF:  # noqa: PLR2004 - the reach of two hexadecimal digits
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code <= 0xFFFF else f"\\U{code:08X}"  # noqa: PLR2004 - of four
