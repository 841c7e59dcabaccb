"""Plain values as the text that ``rostopic echo`` shows, and in one line.

Belongs here: how parts of messages look, with numbers of a fixed width where that is asked for.
Whole messages as they are have a faster way, ``text``.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.messages.fields import TIME_FIELDS
from lcmtools.messages.plain import Plain
from lcmtools.messages.text import quoted, quoted_at_end, word_or_quoted

_NSEC_WIDTH = 9
_NUMBERS = frozenset((bool, int, float))


class More(str):
    """The mark that something has been left out; it stands as it is, also among numbers."""

    __slots__ = ()


MORE = More("...")


@dataclass(frozen=True, slots=True)
class Writer:
    """The format of plain values.

    Attributes:
        width: Characters of a number, as ``rostopic echo -w`` has them; None for as many as it
            needs.
    """

    width: int | None = None

    def block(self, plain: Plain) -> str:
        """A plain value as ``rostopic echo`` shows the message or field it was."""
        if isinstance(plain, dict):
            return "\n".join(self._lines(plain, ""))
        if isinstance(plain, list) and _is_block(plain):
            return "\n".join(self._items(plain, ""))
        return self.flow(plain)

    def flow(self, plain: Plain) -> str:
        """A plain value in one line, in YAML's flow style."""
        if isinstance(plain, dict):
            parts = (f"{name}: {self.flow(value)}" for name, value in plain.items())
            return f"{{{', '.join(parts)}}}"
        if isinstance(plain, list):
            if self.width is None and _are_numbers(plain):
                return repr(plain)  # the same at once, for images and clouds
            return f"[{', '.join(map(self.flow, plain))}]"
        if isinstance(plain, str):
            return str(plain) if isinstance(plain, More) else quoted(plain)
        return repr(plain) if self.width is None else _fixed(plain, self.width)

    def _lines(self, fields: dict[str, Plain], indent: str) -> Iterator[str]:
        is_time = tuple(fields) in TIME_FIELDS
        for name, value in fields.items():
            head = f"{indent}{name}: "
            if isinstance(value, dict):
                yield head
                yield from self._lines(value, f"{indent}  ")
            elif isinstance(value, list) and _is_block(value):
                yield head
                yield from self._items(value, f"{indent}  ")
            elif isinstance(value, str) and not isinstance(value, More):
                yield f"{head}{quoted_at_end(value)}"
            else:
                is_padded = is_time and name != "sec" and self.width is None
                yield f"{head}{self.flow(value):>{_NSEC_WIDTH if is_padded else 0}}"

    def _items(self, values: list[Plain], indent: str) -> Iterator[str]:
        """An array of strings, messages or arrays of them, an item each."""
        for value in values:
            if isinstance(value, dict):
                yield f"{indent}- "
                yield from self._lines(value, f"{indent}  ")
            elif isinstance(value, list) and _is_block(value):
                yield f"{indent}- "
                yield from self._items(value, f"{indent}  ")
            elif isinstance(value, str) and not isinstance(value, More):
                yield f"{indent}- {word_or_quoted(value)}"
            else:
                yield f"{indent}- {self.flow(value)}"


FREE = Writer()
"""Numbers take as much room as they need."""


def _is_block(values: list[Plain]) -> bool:
    """Return whether an array has something in it that does not go in a line of numbers."""
    return not _are_numbers(values) and any(
        isinstance(value, dict)
        or (isinstance(value, str) and not isinstance(value, More))
        or (isinstance(value, list) and _is_block(value))
        for value in values
    )


def _are_numbers(values: list[Plain]) -> bool:
    return _NUMBERS.issuperset(map(type, values))


def _fixed(number: "bool | int | float", width: int) -> str:
    """A number as rostopic cuts or pads it; its whole part is never cut."""
    if isinstance(number, bool):
        return repr(number)
    if isinstance(number, int):
        return f"{number:{width}d}"
    text = f"{number:.{width}f}"
    return text[: max(text.find("."), width)]
