"""The layout of the table of channels, cut to the width of a terminal."""

import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from lcmtools.graph.drawing.labels import printable
from lcmtools.observe.channels.columns import Column, Cut, heading
from lcmtools.observe.channels.rows import ChannelRow

_DOTS = "…"
_WIDE_GAP, _NARROW_GAP = 2, 1  # characters between two columns, usually and if space is short


@dataclass(frozen=True, slots=True)
class ColumnLayout:
    """The columns that fit, their widths, and the gap between them."""

    columns: tuple[Column, ...]
    widths: tuple[int, ...]
    gap: str

    def row(self, row: ChannelRow | None = None) -> list[str]:
        """The cells of a row, or the headings for None, each as wide as its column."""
        return [
            _fit(heading(column) if row is None else printable(column.text(row)), width, column)
            for column, width in zip(self.columns, self.widths, strict=True)
        ]


def natural_widths(rows: Iterable[ChannelRow], columns: Iterable[Column]) -> dict[str, int]:
    """The widths at which no column is cut, by the columns' names."""
    shown = list(rows)
    texts = {c.name: [heading(c), *(printable(c.text(row)) for row in shown)] for c in columns}
    return {name: max(map(width_of, column)) for name, column in texts.items()}


def layout(columns: Sequence[Column], widths: Mapping[str, int], room: int | None) -> ColumnLayout:
    """Return the columns that fit into ``room`` characters (None: no limit), and their widths.

    Texts are cut first; then columns are left out. ``widths`` are those that cut nothing.
    """
    room = sum(widths.values()) + _WIDE_GAP * len(columns) if room is None else room
    kept = list(columns)
    gap = _WIDE_GAP
    if sum(widths[c.name] + gap for c in kept) - gap > room:
        gap = _NARROW_GAP
    least = {c.name: min(widths[c.name], c.least or widths[c.name]) for c in columns}
    leaving = sorted((c for c in columns if c.leaves), key=lambda c: c.leaves, reverse=True)
    while leaving and sum(least[c.name] + gap for c in kept) - gap > room:
        kept.remove(leaving.pop())
    fitted = [widths[column.name] for column in kept]
    _shrink(kept, fitted, room - gap * (len(kept) - 1))
    return ColumnLayout(tuple(kept), tuple(fitted), " " * gap)


def _shrink(columns: Sequence[Column], widths: list[int], room: int) -> None:
    """Cut texts until they fit: senders and listeners, the wider first; then types, then names."""
    for names in (("senders", "listeners"), ("type",), ("channel",)):
        places = [i for i, column in enumerate(columns) if column.name in names]
        while sum(widths) > room:
            can = [i for i in places if widths[i] > columns[i].least]
            if not can:
                break
            widths[max(can, key=widths.__getitem__)] -= 1


def _fit(text: str, width: int, column: Column) -> str:
    text = cut(text, width, column.cut or "end")
    padding = " " * (width - width_of(text))
    return padding + text if column.is_number else text + padding


def cut(text: str, width: int, where: Cut) -> str:
    """A text cut to ``width`` characters, with dots where something is missing."""
    if width_of(text) <= width:
        return text
    if width < 1:
        return ""
    if where == "start":
        last = f"{_DOTS}/{text.rpartition('/')[2]}"  # a type loses its package first
        return last if "/" in text and width_of(last) <= width else _DOTS + _end(text, width - 1)
    if where == "middle":
        end = _end(text, (width - 1) * 2 // 3)
        return _start(text, width - 1 - width_of(end)) + _DOTS + end
    return _start(text, width - 1) + _DOTS


def _start(text: str, width: int) -> str:
    while width_of(text) > width:
        text = text[: min(len(text) - 1, max(width, 0))]
    return text


def _end(text: str, width: int) -> str:
    return _start(text[::-1], width)[::-1]


def width_of(text: str) -> int:
    """The number of terminal columns that a text takes."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(one) else 1 + (unicodedata.east_asian_width(one) in "WF")
        for one in text
    )
