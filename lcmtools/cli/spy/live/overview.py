"""The table of channels on the screen, and its keys."""

from collections.abc import Callable, Iterator, Sequence
from typing import ClassVar

from rich.style import Style
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Input

from lcmtools.cli.spy.columns import (
    COLUMNS,
    Column,
    Layout,
    bandwidth_text,
    layout,
    natural_widths,
    printable,
    rate_text,
)
from lcmtools.cli.spy.live.bars import Bar, keys_line
from lcmtools.cli.spy.live.lines import (
    BAD,
    BOLD,
    DIM,
    GOOD,
    HEADER,
    PLAIN,
    SORTED,
    WARN,
    Lines,
    Part,
)
from lcmtools.cli.spy.live.page import Page
from lcmtools.cli.spy.live.prompt import Prompt
from lcmtools.cli.spy.live.sorting import SortScreen
from lcmtools.cli.spy.view import View
from lcmtools.observe.channels import Row
from lcmtools.observe.feed import Snapshot

_KEYS = (
    *(("F1", "Help"), ("F3", "Search"), ("F4", "Filter"), ("F6", "Sort"), ("Enter", "Details")),
    *(("Space", "Pause"), ("F10", "Quit")),
)
_MUCH_LOSS = 0.01  # of what is sent
_SEARCH, _FILTER = "Search", "Filter"


class Overview(Page[None]):
    """The table.

    Args:
        bus: The bus's URL.
        view: How the table is looked at.
        look_closely: Shows a channel closely, given its name.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f3,slash", "search", show=False),
        Binding("f4,backslash", "filter", show=False),
        Binding("escape", "unfilter", show=False),
        Binding("f6", "choose_column", show=False),
        Binding("greater_than_sign,full_stop", "next_column(1)", show=False),
        Binding("less_than_sign,comma", "next_column(-1)", show=False),
        Binding("I", "invert", show=False),
        Binding("space", "pause", show=False),
        Binding("c", "app.clear", show=False),
        Binding("q", "app.leave", show=False),
        *(Binding(c.letter, f"sort('{c.name}')", show=False) for c in COLUMNS.values()),
    ]

    def __init__(self, bus: str, view: View, look_closely: Callable[[str], None]) -> None:
        super().__init__()
        self.view = view
        self.is_paused = False
        self._bus = bus
        self._look_closely = look_closely
        self._snapshot = Snapshot()
        self._rows: Sequence[Row] = ()
        self._layout = Layout((), (), "")
        self._widest: dict[str, int] = {}
        self._before = ""
        self._top, self.lines, self._prompt = Bar("title"), Lines("table"), Prompt("prompt")

    def compose(self) -> ComposeResult:
        """The parts of the screen, from above."""
        yield self._top
        yield self.lines
        yield self._prompt
        yield Bar("keys", keys_line(_KEYS))

    def on_mount(self) -> None:
        """Begin with an empty table."""
        self.lines.focus()
        self._draw()

    def take(self, snapshot: Snapshot) -> None:
        """Show what is known now, unless somebody wants to read in peace."""
        if not self.is_paused or snapshot.is_over:
            self._snapshot = snapshot
            self._draw()

    def on_resize(self) -> None:
        """Make the columns fit."""
        self.call_after_refresh(self._draw)

    def on_screen_resume(self) -> None:
        """Show what has changed meanwhile."""
        self._draw()

    def action_sort(self, column: str) -> None:
        """Sort by a column; by the same again, the other way round."""
        self._look(self.view.sorted_by(column))

    def action_next_column(self, step: int) -> None:
        """Sort by the next column."""
        self._look(self.view.moved(step))

    def action_invert(self) -> None:
        """Sort the other way round."""
        self._look(self.view.sorted_by(self.view.column))

    def action_choose_column(self) -> None:
        """Let somebody choose the column to sort by."""

        def chosen(column: str | None) -> None:
            if column is not None and column != self.view.column:
                self.action_sort(column)

        self.open(SortScreen(self.view.column), chosen)

    def action_pause(self) -> None:
        """Stop the display, or let it go on."""
        self.is_paused = not self.is_paused
        self._draw()

    def action_search(self) -> None:
        """Let somebody type what to look for."""
        self._prompt.ask(_SEARCH, "")

    def action_filter(self) -> None:
        """Let somebody type what rows must have."""
        self._before = self.view.text
        self._prompt.ask(_FILTER, self.view.text)

    def action_unfilter(self) -> None:
        """Show all rows again."""
        self._look(self.view.filtered(""))

    def on_input_changed(self, event: Input.Changed) -> None:
        """Search or filter while somebody types."""
        purpose = self._prompt.purpose
        if purpose == _FILTER:
            self._look(self.view.filtered(event.value))
        elif purpose == _SEARCH:
            self._find(event.value, 0)

    def on_prompt_again(self) -> None:
        """Go to the next row that is searched."""
        self._find(self._prompt.value, 1)

    def on_prompt_left(self, event: Prompt.Left) -> None:
        """Go back to the table; a filter that was given up is none."""
        self.lines.focus()
        if event.purpose == _FILTER and event.cancelled:
            self._look(self.view.filtered(""))
        self._draw()

    def on_lines_chosen(self, event: Lines.Chosen) -> None:
        """Look closely at a channel."""
        event.stop()
        if self.is_in_front:
            self._look_closely(event.key)

    def on_lines_heading_clicked(self, event: Lines.HeadingClicked) -> None:
        """Sort by the column that was clicked on."""
        end = 0
        for column, width in zip(self._layout.columns, self._layout.widths, strict=True):
            end += width + len(self._layout.gap)
            if event.x < end:
                self.action_sort(column.name)
                return

    def _look(self, view: View) -> None:
        self.view = view
        self._draw()

    def _find(self, text: str, step: int) -> None:
        """Put the cursor on the next row whose channel has a text in it."""
        names = [row.channel for row in self._rows]
        key = self.lines.cursor_key
        start = names.index(key) + step if key in names else 0
        for name in [*names[start:], *names[:start]]:
            if text and text.casefold() in name.casefold():
                self.lines.go_to(name)
                return

    def _draw(self) -> None:
        if not self.size.width:
            return
        self._rows = self.view.rows(self._snapshot.rows, steady=True)
        columns = list(COLUMNS.values())
        for name, width in natural_widths(self._rows, columns).items():
            self._widest[name] = max(width, self._widest.get(name, 0))  # it does not jump about
        self._layout = layout(columns, self._widest, self.size.width)
        self._top.show(self._title(), self._remarks())
        heading = list(self._heading())
        text, style = heading[-1]
        heading[-1] = text.rstrip(), style
        self.lines.show([row.channel for row in self._rows], self._line, heading)

    def _line(self, number: int) -> Sequence[Part]:
        row = self._rows[number]
        cells = self._layout.row(row)
        parts: list[Part] = []
        for column, cell in zip(self._layout.columns, cells, strict=True):
            parts += [(cell, cell_style(row, column)), (self._layout.gap, PLAIN)]
        return parts[:-1]

    def _heading(self) -> Iterator[Part]:
        cells = self._layout.header()
        for column, cell in zip(self._layout.columns, cells, strict=True):
            if column.name != self.view.column:
                yield cell + self._layout.gap, HEADER
                continue
            arrow = "▼" if column.is_number != self.view.inverted else "▲"
            text = cell.rstrip() + arrow
            yield f"{text:<{len(cell) + len(self._layout.gap)}}", SORTED

    def _title(self) -> list[Part]:
        shown, all_rows = len(self._rows), len(self._snapshot.rows)
        count = f"{shown} of {all_rows}" if self.view.text else str(all_rows)
        parts = [
            ("lcmtools spy", BOLD),
            (f"  {self._bus}  {count} channel{'s' if all_rows != 1 else ''}", PLAIN),
            (f"  {rate_text(self._snapshot.rate)} msg/s", GOOD),
            (f"  {bandwidth_text(self._snapshot.bandwidth)}", GOOD),
        ]
        if self.view.text:
            parts.append((f"  filter: {printable(self.view.text)}", WARN))
        if self.is_paused:
            parts.append(("  PAUSED", WARN))
        return parts

    def _remarks(self) -> list[Part]:
        """What is wrong, or who listens to nobody knows what."""
        if self._snapshot.trouble:
            return [(self._snapshot.trouble, BAD)]
        programs = self._snapshot.plain_listeners
        verb = "listens" if len(programs) == 1 else "listen"
        return [(f"{', '.join(programs)} {verb} as no node", DIM)] if programs else []


def cell_style(row: Row, column: Column) -> Style:
    """How a cell is coloured: loss, unknown types and silence."""
    if column.name == "loss" and row.lost:
        return BAD if (row.loss or 0.0) >= _MUCH_LOSS else WARN
    if row.is_silent:
        return DIM
    return WARN if column.name == "type" and not row.types else PLAIN
