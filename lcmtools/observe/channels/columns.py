"""The columns of the channel table (names, texts and sort keys), and the order of its rows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from lcmtools.names import is_of_lcm
from lcmtools.observe.channels.rows import ChannelRow, in_order, matching
from lcmtools.observe.reports.describe import size_text

Cut = Literal["", "start", "middle", "end"]


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the table."""

    name: str  # on the command line and in the heading
    letter: str  # the key to press to sort by it
    text: Callable[[ChannelRow], str]
    key: Callable[[ChannelRow], object]  # sort key; None for an empty cell
    leaves: int = 0  # columns are left out in this order; 0 for never
    cut: Cut = ""  # the place where a long text is cut; "" for a number
    least: int = 0  # the smallest width that it is cut to, in characters

    @property
    def is_number(self) -> bool:
        """True for numbers: right-aligned, and sorted from the largest."""
        return not self.cut


def bandwidth_text(value: float | None) -> str:
    """Bytes per second, as text."""
    return "-" if value is None else f"{size_text(value)}/s"


def rate_text(value: float | None) -> str:
    """Messages per second [Hz], as text."""
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 1000 or value == 0 else f"{value:.2f}"  # noqa: PLR2004


def jitter_text(seconds: float | None) -> str:
    """The spread of the intervals between messages, as text."""
    if seconds is None:
        return "-"
    return f"{seconds * 1e3:.1f} ms" if seconds < 1 else f"{seconds:.2f} s"


def loss_text(loss: float | None) -> str:
    """A share of lost messages, as text; "0" only if nothing was lost."""
    if loss is None:
        return "-"
    if loss == 0:
        return "0"
    return f"{max(loss * 100, 0.1):.1f}%" if loss < 0.1 else f"{loss * 100:.0f}%"  # noqa: PLR2004


def age_text(seconds: float | None) -> str:
    """An age, as text: "0.1 s", "12 s", "3 min"."""
    if seconds is None:
        return "-"
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.1f} s" if seconds < 10 else f"{seconds:.0f} s"  # noqa: PLR2004


def type_text(row: ChannelRow) -> str:
    """The announced type, or the likeliest and the number of others; "?" if unknown."""
    if not row.types:
        return "?" if row.messages and not is_of_lcm(row.channel) else "-"
    if row.is_announced:
        return ", ".join(row.types)
    others = len(row.types) - 1
    return f"{row.types[0]} +{others}" if others else row.types[0]


def _senders(row: ChannelRow) -> object:
    return row.senders or None


def _listeners(row: ChannelRow) -> object:
    return row.listeners or None


def names_text(names: Sequence[str]) -> str:
    """Several names, "-" for none."""
    return ", ".join(names) or "-"


COLUMNS: Mapping[str, Column] = {
    column.name: column
    for column in (
        Column("channel", "n", lambda r: r.channel, lambda r: r.channel, 0, "middle", 24),
        Column("type", "t", type_text, lambda r: r.types or None, 6, "start", 12),
        Column("messages", "m", lambda r: str(r.messages), lambda r: r.messages, 3),
        Column("rate", "r", lambda r: rate_text(r.rate), lambda r: r.rate),
        Column("jitter", "j", lambda r: jitter_text(r.jitter), lambda r: r.jitter, 5),
        Column("bandwidth", "b", lambda r: bandwidth_text(r.bandwidth), lambda r: r.bandwidth),
        Column("loss", "l", lambda r: loss_text(r.loss), lambda r: r.loss, 7),
        Column("age", "a", lambda r: age_text(r.age), lambda r: r.age, 2),
        Column("senders", "s", lambda r: names_text(r.senders), _senders, 4, "end", 12),
        Column("listeners", "e", lambda r: names_text(r.listeners), _listeners, 1, "end", 12),
    )
}


def heading(column: Column) -> str:
    """The text above a column."""
    return {"rate": "Hz"}.get(column.name, column.name).upper()


@dataclass(frozen=True, slots=True)
class TableView:
    """The order and the filter of the table."""

    column: str = "channel"
    inverted: bool = False  # numbers sorted from the smallest, and texts from Z
    text: str = ""  # that a row must contain in channel, type, sender or listener

    def rows(self, rows: Sequence[ChannelRow], *, steady: bool = False) -> list[ChannelRow]:
        """Return the rows that are shown, in their order.

        In a steady view, numbers that differ by only a percent or two count as equal and are sorted
        by channel; otherwise, rows would change places all the time.
        """
        column = COLUMNS[self.column]

        def key(row: ChannelRow) -> object:
            value = column.key(row)
            return float(f"{value:.2g}") if steady and isinstance(value, float) else value

        descending = column.is_number != self.inverted
        return in_order(matching(rows, self.text), key, descending=descending)

    def sorted_by(self, column: str) -> "TableView":
        """The same view sorted by a column, or inverted if it is sorted by this column already."""
        if column == self.column:
            return replace(self, inverted=not self.inverted)
        return replace(self, column=column, inverted=False)

    def moved(self, step: int) -> "TableView":
        """The same view sorted by the column that is ``step`` columns further."""
        names = list(COLUMNS)
        place = (names.index(self.column) + step) % len(names)
        return replace(self, column=names[place], inverted=False)
