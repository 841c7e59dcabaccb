"""The columns of the table: how each is called, written, sorted, and cut where there is no room."""

import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from lcmtools.observe.channels import Row, in_order

DOTS = "…"
_GAPS = (2, 1)  # characters between two columns: usually, and where there is little room

Cut = Literal["", "start", "middle", "end"]


@dataclass(frozen=True, slots=True)
class Column:
    """A column.

    Attributes:
        name: What it is called on the command line and above it.
        letter: The key that sorts by it.
        text: What is in it for a row.
        key: What it is sorted by; None where a row has nothing in it.
        is_number: Numbers stand to the right and are sorted from the largest.
        cut: Where a text that is too long is cut; "" for never.
        least: To so many characters.
        leaves: The order in which columns are left out where there is no room; 0 for never.
    """

    name: str
    letter: str
    text: Callable[[Row], str]
    key: Callable[[Row], object]
    is_number: bool = True
    cut: Cut = ""
    least: int = 0
    leaves: int = 0


def size_text(value: float | None) -> str:
    """Bytes, a KB being 1000: "812 B", "36.2 KB"."""
    if value is None:
        return "-"
    units = ["B", "KB", "MB", "GB"]
    while value >= 999.5 and len(units) > 1:  # noqa: PLR2004 - what rounds to four digits
        value, units = value / 1000, units[1:]
    digits = 0 if units[0] == "B" or value >= 99.95 else 1 if value >= 9.995 else 2  # noqa: PLR2004
    return f"{value:.{digits}f} {units[0]}"


def bandwidth_text(value: float | None) -> str:
    """Bytes a second."""
    return "-" if value is None else f"{size_text(value)}/s"


def rate_text(value: float | None) -> str:
    """Messages a second [Hz]."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 1000 or value == 0 else f"{value:.2f}"  # noqa: PLR2004


def jitter_text(seconds: float | None) -> str:
    """A spread of intervals."""
    if seconds is None:
        return "-"
    return f"{seconds * 1e3:.1f} ms" if seconds < 1 else f"{seconds:.2f} s"


def loss_text(loss: float | None) -> str:
    """A share that was lost; never 0 where anything was."""
    if loss is None:
        return "-"
    if loss == 0:
        return "0"
    return f"{max(loss * 100, 0.1):.1f}%" if loss < 0.1 else f"{loss * 100:.0f}%"  # noqa: PLR2004


def age_text(seconds: float | None) -> str:
    """How long ago: "0.1 s", "12 s", "3 min"."""
    if seconds is None:
        return "-"
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"  # noqa: PLR2004


def type_text(row: Row) -> str:
    """A type: what is announced, or the likeliest and how many others it may be; "?" for none."""
    if not row.types:
        return "?" if row.messages else "-"
    if row.is_announced:
        return ", ".join(row.types)
    others = len(row.types) - 1
    return f"{row.types[0]} +{others}" if others else row.types[0]


def names_text(names: Sequence[str]) -> str:
    """Several names, or that there are none."""
    return ", ".join(names) or "-"


COLUMNS: Mapping[str, Column] = {
    column.name: column
    for column in (
        Column("channel", "n", lambda r: r.channel, lambda r: r.channel, False, "middle", 24),  # noqa: FBT003
        Column("type", "t", type_text, lambda r: r.types or None, False, "start", 12, 6),  # noqa: FBT003
        Column("messages", "m", lambda r: str(r.messages), lambda r: r.messages, leaves=3),
        Column("rate", "r", lambda r: rate_text(r.rate), lambda r: r.rate),
        Column("jitter", "j", lambda r: jitter_text(r.jitter), lambda r: r.jitter, leaves=5),
        Column("bandwidth", "b", lambda r: bandwidth_text(r.bandwidth), lambda r: r.bandwidth),
        Column("loss", "l", lambda r: loss_text(r.loss), lambda r: r.loss, leaves=7),
        Column("age", "a", lambda r: age_text(r.age), lambda r: r.age, leaves=2),
        Column(
            "senders", "s", lambda r: names_text(r.senders), lambda r: r.senders or None,
            False, "end", 12, 4,  # noqa: FBT003
        ),
        Column(
            "listeners", "e", lambda r: names_text(r.listeners), lambda r: r.listeners or None,
            False, "end", 12, 1,  # noqa: FBT003
        ),
    )
}  # fmt: skip
HEADINGS: Mapping[str, str] = {"rate": "Hz"}
"""What stands above a column, where that is not its name."""


def heading(column: Column) -> str:
    """What stands above a column."""
    return HEADINGS.get(column.name, column.name).upper()


def sorted_rows(
    rows: Sequence[Row], name: str, *, inverted: bool, steady: bool = False
) -> list[Row]:
    """The rows sorted by a column: numbers from the largest, texts from A, or inverted.

    Args:
        rows: They.
        name: The column's name.
        inverted: The other way round.
        steady: What differs by a percent or two counts as equal, and is sorted by channel: else
            rows would change places all the time.
    """
    column = COLUMNS[name]

    def key(row: Row) -> object:
        value = column.key(row)
        return float(f"{value:.2g}") if steady and isinstance(value, float) else value

    return in_order(rows, key, descending=column.is_number != inverted)


@dataclass(frozen=True, slots=True)
class Layout:
    """The columns that there is room for, how wide each is, and what stands between them."""

    columns: tuple[Column, ...]
    widths: tuple[int, ...]
    gap: str

    def header(self) -> list[str]:
        """The cells above the rows, each as wide as its column."""
        return self._fitted(map(heading, self.columns))

    def row(self, row: Row) -> list[str]:
        """The cells of a row, each as wide as its column."""
        return self._fitted(printable(column.text(row)) for column in self.columns)

    def _fitted(self, cells: Iterable[str]) -> list[str]:
        pairs = zip(self.columns, self.widths, cells, strict=True)
        return [fit(cell, width, column) for column, width, cell in pairs]


def natural_widths(rows: Iterable[Row], columns: Iterable[Column]) -> dict[str, int]:
    """How wide the columns would have to be that nothing is cut, by their names."""
    shown = list(rows)
    return {
        column.name: max(
            width_of(heading(column)), *(width_of(printable(column.text(row))) for row in shown), 0
        )
        for column in columns
    }


def layout(columns: Sequence[Column], widths: Mapping[str, int], room: int | None) -> Layout:
    """Which columns there is room for, and how wide they are.

    Texts are cut first, the longest most, and then columns left out.

    Args:
        columns: All of them.
        widths: How wide they would have to be that nothing is cut, by their names.
        room: Characters of a line; None for as many as it takes.
    """
    gap = _gap([widths[column.name] for column in columns], room)
    kept = list(columns)
    while room is not None and _least(kept, widths, gap) > room:
        leaving = [column for column in kept if column.leaves]
        if not leaving:
            break
        kept.remove(min(leaving, key=lambda column: column.leaves))
    fitted = [widths[column.name] for column in kept]
    if room is not None:
        _shrink(kept, fitted, room - gap * (len(kept) - 1))
    return Layout(tuple(kept), tuple(fitted), " " * gap)


def _gap(widths: Sequence[int], room: int | None) -> int:
    wide, narrow = _GAPS
    return wide if room is None or sum(widths) + wide * (len(widths) - 1) <= room else narrow


def _least(columns: Sequence[Column], widths: Mapping[str, int], gap: int) -> int:
    """How much room columns need when everything is cut."""
    least = (min(widths[c.name], c.least or widths[c.name]) for c in columns)
    return sum(least) + gap * (len(columns) - 1)


def _shrink(columns: Sequence[Column], widths: list[int], room: int) -> None:
    """Cut texts until they fit: senders and listeners, the wider first; then types, then names."""
    for names in (("senders", "listeners"), ("type",), ("channel",)):
        places = [i for i, column in enumerate(columns) if column.name in names]
        while sum(widths) > room:
            can = [i for i in places if widths[i] > columns[i].least]
            if not can:
                break
            widths[max(can, key=widths.__getitem__)] -= 1


def fit(text: str, width: int, column: Column) -> str:
    """A text in exactly so many characters."""
    text = cut(text, width, column.cut or "end")
    padding = " " * (width - width_of(text))
    return padding + text if column.is_number else text + padding


def cut(text: str, width: int, where: Cut) -> str:
    """A text cut to so many characters, with dots where something is missing."""
    if width_of(text) <= width:
        return text
    if width < 1:
        return ""
    if where == "start":
        last = f"{DOTS}/{text.rpartition('/')[2]}"  # of a type, the package goes first
        return last if "/" in text and width_of(last) <= width else DOTS + _end(text, width - 1)
    if where == "middle":
        end = _end(text, (width - 1) * 2 // 3)
        return _start(text, width - 1 - width_of(end)) + DOTS + end
    return _start(text, width - 1) + DOTS


def _start(text: str, width: int) -> str:
    while width_of(text) > width:
        text = text[: min(len(text) - 1, max(width, 0))]
    return text


def _end(text: str, width: int) -> str:
    return _start(text[::-1], width)[::-1]


def width_of(text: str) -> int:
    """How many places of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(_width(character) for character in text)


def _width(character: str) -> int:
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def printable(text: str) -> str:
    """A text whose control characters are escaped: anybody can put such a name on the bus."""
    if text.isprintable():
        return text
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in text
    )
