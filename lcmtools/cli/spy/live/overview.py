"""The screen with the table of channels, and its keys."""

from dataclasses import replace
from functools import partial
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import DataTable, Footer, Input

from lcmtools.cli.spy.live.detail import Detail
from lcmtools.cli.spy.live.rows import Cell, Cells, RowTable
from lcmtools.cli.spy.live.screens import LivePage, SortScreen
from lcmtools.graph.drawing.labels import printable
from lcmtools.observe.channels.columns import COLUMNS, Column, TableView, bandwidth_text, rate_text
from lcmtools.observe.channels.feed import Feed, Snapshot
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.channels.table import ColumnLayout, layout, natural_widths

_MUCH_LOSS = 0.01  # of what is sent
_SEARCH, _FILTER = "Search", "Filter"


class Overview(LivePage):
    """The table of channels, drawn at each snapshot."""

    period = None
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f1,h,question_mark", "app.explain", "Help"),
        Binding("f3,slash", "search", "Search"),
        Binding("f4,backslash", "filter", "Filter"),
        Binding("escape", "leave_prompt", "All rows", show=False),
        Binding("f6", "choose_column", "Sort"),
        Binding("greater_than_sign,full_stop", "next_column(1)", "Sort by next", show=False),
        Binding("less_than_sign,comma", "next_column(-1)", "Sort by previous", show=False),
        Binding("I", "invert", "Invert the order", show=False),
        *(
            Binding(c.letter, f"sort('{c.name}')", f"Sort by {c.name}", show=False)
            for c in COLUMNS.values()
        ),
        Binding("space", "pause", "Pause"),
        Binding("c", "app.clear", "Count from zero", show=False),
        Binding("q", "app.leave", "Quit", show=False),
    ]

    def __init__(self, bus: str, view: TableView, feed: Feed) -> None:
        super().__init__(self._draw)
        self.view = view
        self._bus = bus
        self._feed = feed
        self._snapshot = Snapshot()
        self._rows: list[ChannelRow] = []
        self._layout = ColumnLayout((), (), "")
        self._widest: dict[str, int] = {}
        self._purpose = ""
        self.table = RowTable("table")
        self.prompt = Input(id="prompt", compact=True)

    def compose(self) -> ComposeResult:
        yield self.top
        yield self.table
        yield self.prompt
        yield Footer()

    def on_mount(self) -> None:  # and its base's
        self.prompt.display = False
        self.table.focus()
        self._feed.on_snapshot = partial(self.call_later, self.update)

    def on_screen_resume(self) -> None:
        self.draw()

    def update(self) -> None:
        if self.is_active or self.app.screen.is_modal:
            self.draw()

    def action_sort(self, column: str) -> None:
        self._show(self.view.sorted_by(column))

    def action_next_column(self, step: int) -> None:
        self._show(self.view.moved(step))

    def action_invert(self) -> None:
        self._show(self.view.sorted_by(self.view.column))

    def action_choose_column(self) -> None:

        def chosen(column: str | None) -> None:
            if column not in (None, self.view.column):
                self.action_sort(str(column))

        if self.is_active:
            self.app.push_screen(SortScreen(self.view.column), chosen)

    def action_search(self) -> None:
        if self.prompt.display and self._purpose == _SEARCH:
            self._find(self.prompt.value, 1)
        else:
            self._ask(_SEARCH, "")

    def action_filter(self) -> None:
        self._ask(_FILTER, self.view.text)

    def action_leave_prompt(self) -> None:
        if not self.prompt.display or self._purpose == _FILTER:
            self._show(replace(self.view, text=""))
        self.on_input_submitted()

    def on_input_changed(self, event: Input.Changed) -> None:
        if not self.prompt.display:
            return
        if self._purpose == _FILTER:
            self._show(replace(self.view, text=event.value))
        else:
            self._find(event.value, 0)

    def on_input_submitted(self) -> None:
        self.prompt.display = False
        self.table.focus()

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        if self.is_active and event.row_key.value is not None:
            self.app.push_screen(Detail(event.row_key.value, self._feed))

    def on_data_table_header_selected(self, event: DataTable.HeaderSelected) -> None:
        self.action_sort(self._layout.columns[event.column_index].name)

    def _ask(self, purpose: str, text: str) -> None:
        self._purpose = purpose
        self.prompt.placeholder = f"{purpose}: type, Enter to keep, Esc to leave"
        self.prompt.display = True
        self.prompt.value = text
        self.prompt.focus()

    def _show(self, view: TableView) -> None:
        self.view = view
        self.draw()

    def _find(self, text: str, step: int) -> None:
        names = [row.channel for row in self._rows]
        key = self.table.cursor_key
        start = names.index(key) + step if key in names else 0
        for name in [*names[start:], *names[:start]]:
            if text and text.casefold() in name.casefold():
                self.table.go_to(name)
                return

    def _draw(self) -> None:
        width = self.table.size.width - 1  # beside the scroll bar
        if width < 1:
            return
        latest = self._feed.latest
        if not self.is_paused or latest.is_over:
            self._snapshot = latest
        self._rows = self.view.rows(self._snapshot.rows, steady=True)
        for name, widest in natural_widths(self._rows, COLUMNS.values()).items():
            self._widest[name] = max(widest, self._widest.get(name, 0))  # columns do not jump
        self._layout = layout(list(COLUMNS.values()), self._widest, width)
        self.show_title(Text("\n").join(filter(None, (self._heading(), self._remarks()))))
        rows = {row.channel: row for row in self._rows}

        def cells(key: str) -> Cells:
            row = rows[key]
            pairs = zip(self._layout.columns, self._layout.row(row), strict=True)
            return tuple(Cell(key, text, cell_style(row, column)) for column, text in pairs)

        self.table.show(self._headings(), list(rows), cells)

    def _headings(self) -> list[tuple[str, int]]:
        shown, found = self._layout, []
        for column, width, text in zip(shown.columns, shown.widths, shown.row(), strict=True):
            arrow = "▼" if column.is_number != self.view.inverted else "▲"
            is_sorted = column.name == self.view.column
            found.append((text.rstrip() + arrow if is_sorted else text, width + len(shown.gap)))
        return found

    def _heading(self) -> Text:
        shown, all_rows = len(self._rows), len(self._snapshot.rows)
        count = f"{shown} of {all_rows}" if self.view.text else str(all_rows)
        left_out = self._snapshot.left_out
        text = Text.assemble(
            ("lcmtools spy", "bold"),
            f"  {self._bus}  {count} channel{'s' if all_rows != 1 else ''}",
            (f" (and {left_out} more)" if left_out else "", "bold yellow"),
            (f"  {rate_text(self._snapshot.rate)} msg/s", "green"),
            (f"  {bandwidth_text(self._snapshot.bandwidth)}", "green"),
            no_wrap=True,
        )
        if self.view.text:
            text.append(f"  filter: {printable(self.view.text)}", "bold yellow")
        if self.is_paused:
            text.append("  PAUSED", "bold yellow")
        return text

    def _remarks(self) -> Text | None:
        if self._snapshot.trouble:
            return Text(printable(self._snapshot.trouble), "bold red")
        if errors := self._snapshot.callback_errors:
            more = f" (and {len(errors) - 1} more; see lcmtools wtf)" if len(errors) > 1 else ""
            return Text(f"{printable(errors[0])}{more}", "bold red")
        programs = self._snapshot.plain_listeners
        is_one = len(programs) == 1
        verb = "also listens; it is not a node" if is_one else "also listen; they are not nodes"
        return Text(printable(f"{', '.join(programs)} {verb}"), "dim") if programs else None


def cell_style(row: ChannelRow, column: Column) -> str:
    """Return the style of a cell, which highlights losses, silence and unknown types."""
    if column.name == "loss" and row.lost:
        return "bold red" if (row.loss or 0.0) >= _MUCH_LOSS else "bold yellow"
    if row.is_silent:
        return "dim"
    return "bold yellow" if column.name == "type" and not row.types else ""
