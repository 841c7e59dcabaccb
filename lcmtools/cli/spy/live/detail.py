"""Screens of one channel: its latest message, and the curve of a field."""

from collections.abc import Callable
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.widgets import DataTable, Footer, Label, Sparkline

from lcmtools.cli.spy.live.rows import Cell, Cells, CurveCell, RowTable
from lcmtools.cli.spy.live.screens import LivePage
from lcmtools.graph.drawing.labels import printable
from lcmtools.observe.channels.details import (
    BARS,
    DetailLine,
    detail_lines,
    flow_text,
    number_text,
    properties,
)
from lcmtools.observe.channels.feed import Feed
from lcmtools.observe.channels.study import Study, curve

_BESIDE = 54  # characters of a number and its range, beside its curve
_SPANS = (2, 5, 10, 20, 40, 120, 600)  # [s]
_USUAL = 3


class Detail(LivePage):
    """One channel."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,left", "back", "Back"),
        Binding("space", "pause", "Pause"),
        Binding("c", "clear", "Clear"),
        Binding("f1,h,question_mark", "app.explain", "Help"),
    ]

    def __init__(self, channel: str, feed: Feed) -> None:
        super().__init__(self._draw)
        self._feed = feed
        self._row = feed.latest.row(channel)
        self.study = Study(channel, self._announced_types())
        self._unfollow: Callable[[], None] = lambda: None
        self._state = self.study.state()
        self._lines: dict[str, DetailLine] = {}
        self.table = RowTable("message")

    def compose(self) -> ComposeResult:
        self.table.show_header = False
        yield self.top
        yield self.table
        yield Footer()

    def on_mount(self) -> None:  # and its base's
        self._unfollow = self._feed.follow(self.study.channel, self.study.add_packet)
        self.table.focus()

    def on_unmount(self) -> None:
        self._unfollow()

    def update(self) -> None:
        if not self.is_paused:
            self._row = self._feed.latest.row(self.study.channel)
            self.study.announced(self._announced_types())
            self._state = self.study.state()
            self.draw()

    def action_clear(self) -> None:
        self.study.clear()

    def _announced_types(self) -> tuple[str, ...]:
        return self._row.types if self._row.is_announced else ()

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        line = self._lines.get(event.row_key.value or "")
        if line is None or not self.is_active:
            return
        if line.is_number:
            self.app.push_screen(CurveScreen(self.study, line.key))
        else:
            self.study.toggle(line.key)
            self._state = self.study.state()
            self.draw()

    def _draw(self) -> None:
        width = self.table.size.width - 1  # beside the scroll bar
        if width < 1:
            return
        row, state = self._row, self._state
        text = Text.assemble((printable(row.channel), "bold"), f"  {flow_text(row)}", no_wrap=True)
        text.append("  PAUSED" if self.is_paused else "", "bold yellow")
        for label, value in properties(row, state):
            text.append(f"\n{label:<12}", "dim").append(value)
        if state.problem:
            text.append(f"\n{printable(state.problem)}", "bold yellow")
        self.show_title(text)
        lines = detail_lines(state, self.study.samples)
        self._lines = {line.key: line for line in lines}
        name = min(2 + max((len(line.name) for line in lines), default=0), width // 2)
        bars = min(BARS, width - name - _BESIDE)

        def cells(key: str) -> Cells:
            line = self._lines[key]
            label = Cell(key, line.name, "cyan")
            if not line.is_number:
                return label, Cell(key, line.value)
            return label, CurveCell(line.value, line.bars, bars, line.span)

        self.table.show([("", name), ("", width - name)], list(self._lines), cells)


class CurveScreen(LivePage):
    """The curve of a field on the whole screen."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,enter,left", "back", "Back"),
        Binding("plus,equals_sign", "span(1)", "Longer"),
        Binding("minus", "span(-1)", "Shorter"),
        Binding("space", "pause", "Pause"),
    ]

    def __init__(self, study: Study, path: str) -> None:
        super().__init__(self._draw)
        self._study = study
        self._path = path
        self._span = _USUAL
        self._bars = Sparkline(id="curve")
        self._high, self._low = Label(id="high"), Label(id="low")

    def compose(self) -> ComposeResult:
        yield self.top
        yield self._high
        yield Horizontal(self._bars)
        yield self._low
        yield Footer()

    def action_span(self, step: int) -> None:
        self._span = max(0, min(len(_SPANS) - 1, self._span + step))
        self.draw()

    def _draw(self) -> None:
        samples = self._study.samples(self._path)
        width = self.size.width
        if not samples or not width:
            return
        (now, value), span = samples[-1], _SPANS[self._span]
        recent = [sample for sample in samples if sample[0] >= now - span * 1_000_000_000]
        found = curve(recent, now, width, span * 1_000_000_000 // width)
        low, high = number_text(found.low), number_text(found.high)
        self.show_title(
            Text.assemble(
                (f"{self._study.channel}  {self._path}", "bold"),
                (f"  {number_text(value)}", "cyan"),
                f"  {len(recent)} values, {low} to {high}",
                ("  PAUSED" if self.is_paused else "", "bold yellow"),
                no_wrap=True,
            )
        )
        self._high.update(high)
        self._bars.styles.width = max(1, len(found.bars))
        self._bars.data = found.bars
        self._low.update(f"{low}{f'-{span} s .. now':>{max(0, width - len(low))}}")
