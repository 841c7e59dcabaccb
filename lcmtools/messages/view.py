"""Selected values as text, lines of flow style and columns of a table.

Belongs here: how a part of a message looks, and what takes the place of arrays and strings that are
not to be shown. Must not know paths or files; whole messages are ``text``'s.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias, cast

from lcmtools.messages.fields import PRIMITIVES, visible_fields
from lcmtools.messages.path import Selection, Target
from lcmtools.messages.plain import Plain
from lcmtools.messages.registry import Message
from lcmtools.messages.text import quoted, word_or_quoted

Scalar: TypeAlias = "bool | int | float | str"

_TIMES = (["sec", "nsec"], ["sec", "nanosec"])
_NSEC_WIDTH = 9
_NUMBERS = frozenset(PRIMITIVES.values()) - {"string"}


@dataclass(frozen=True, slots=True)
class Hidden:
    """What is not shown, but named: ``<array type: float64, length: 5>``, ``<string length: 5>``.

    Attributes:
        arrays: All arrays.
        strings: All strings.
    """

    arrays: bool = False
    strings: bool = False

    def __bool__(self) -> bool:
        """Whether anything is hidden."""
        return self.arrays or self.strings


def plain_selection(selection: Selection, hidden: Hidden) -> Plain:
    """A selected value as a plain one, without what is hidden."""
    found = selection.target
    return _plain(selection.value, found, found.depth, hidden)


def format_plain(plain: Plain) -> str:
    """A plain value as ``rostopic echo`` shows the message or field it was."""
    if isinstance(plain, dict):
        return "\n".join(_lines(plain, ""))
    if isinstance(plain, list) and _is_block(plain):
        return "\n".join(_items(plain, ""))
    return quoted(plain) if isinstance(plain, str) else repr(plain)


def format_flow(plain: Plain) -> str:
    """A plain value in one line, in YAML's flow style."""
    if isinstance(plain, dict):
        return f"{{{', '.join(f'{name}: {format_flow(value)}' for name, value in plain.items())}}}"
    if isinstance(plain, list):
        return f"[{', '.join(map(format_flow, plain))}]"
    return quoted(plain) if isinstance(plain, str) else repr(plain)


def columns(plain: Plain, name: str = "field") -> dict[str, Scalar]:
    """The single values in a plain one, by rostopic's names of columns: ``field.points0.x``."""
    if isinstance(plain, dict):
        parts = [(f"{name}.{key}", value) for key, value in plain.items()]
    elif isinstance(plain, list):
        parts = [(f"{name}{index}", value) for index, value in enumerate(plain)]
    else:
        return {name: plain}
    return {column: cell for part, value in parts for column, cell in columns(value, part).items()}


def _plain(value: object, what: Target, depth: int, hidden: Hidden) -> Plain:
    if depth:
        return _plain_array(cast("list[object]", value), what, depth, hidden)
    if what.message_class is not None:
        return _plain_message(cast("Message", value), hidden)
    if what.type == "string" and hidden.strings:
        return f"<string length: {len(cast('str', value))}>"
    return cast("Plain", value)


def _plain_array(elements: list[object], what: Target, depth: int, hidden: Hidden) -> Plain:
    if hidden.arrays:
        return f"<array type: {what.type}, length: {len(elements)}>"
    if depth == 1 and what.type in _NUMBERS:
        return cast("list[Plain]", list(elements))
    return [_plain(element, what, depth - 1, hidden) for element in elements]


def _plain_message(message: Message, hidden: Hidden) -> dict[str, Plain]:
    return {
        field.name: _plain(
            getattr(message, field.name),
            Target(field.type, field.message_class, field.dimensions),
            len(field.dimensions),
            hidden,
        )
        for field in visible_fields(type(message))
    }


def _lines(fields: dict[str, Plain], indent: str) -> Iterator[str]:
    is_time = list(fields) in _TIMES
    for name, value in fields.items():
        head = f"{indent}{name}: "
        if isinstance(value, dict):
            yield head
            yield from _lines(value, f"{indent}  ")
        elif isinstance(value, list) and _is_block(value):
            yield head
            yield from _items(value, f"{indent}  ")
        else:
            width = _NSEC_WIDTH if is_time and name != "sec" else 0
            yield f"{head}{format_plain(value):>{width}}"


def _items(values: list[Plain], indent: str) -> Iterator[str]:
    """An array of strings, messages or arrays of them, an item each."""
    for value in values:
        if isinstance(value, dict):
            yield f"{indent}- "
            yield from _lines(value, f"{indent}  ")
        elif isinstance(value, list) and _is_block(value):
            yield f"{indent}- "
            yield from _items(value, f"{indent}  ")
        else:
            text = word_or_quoted(value) if isinstance(value, str) else format_plain(value)
            yield f"{indent}- {text}"


def _is_block(values: list[Plain]) -> bool:
    """Whether an array has something in it that does not go in a line of numbers."""
    return any(
        isinstance(value, (dict, str)) or (isinstance(value, list) and _is_block(value))
        for value in values
    )
