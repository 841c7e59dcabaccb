"""A table of rows that are refreshed several times a second."""

from collections.abc import Callable, Sequence
from typing import ClassVar, NamedTuple

from rich.padding import Padding
from rich.table import Table
from rich.text import Text
from textual.binding import Binding, BindingType
from textual.color import Color
from textual.geometry import Region
from textual.renderables.sparkline import Sparkline
from textual.widgets import DataTable

CURVE = Color.parse("ansi_cyan").rich_color


_MOST_LINES, _MOST_CELLS = 100, 1000  # that are seen at a time, about


class Cell(NamedTuple):
    """A styled text, and the key of its row."""

    key: str
    text: str
    style: str = ""

    def __rich__(self) -> Text:
        return Text(self.text, self.style, no_wrap=True, overflow="ellipsis")


class CurveCell(NamedTuple):
    """A number, the bars of its curve, the newest at the right, and its range."""

    value: str
    bars: Sequence[float]
    width: int
    span: str

    def __rich__(self) -> Table:
        grid = Table.grid(padding=(0, 2))
        grid.add_column(width=24, justify="right", no_wrap=True)
        bars = self.bars[-self.width :] if self.width > 0 else ()
        if not bars:
            grid.add_row(self.value)
            return grid
        grid.add_column(width=self.width)
        grid.add_column(no_wrap=True)
        curve = Sparkline([*bars], width=len(bars), min_color=CURVE, max_color=CURVE)
        shown = Padding(curve, (0, 0, 0, self.width - len(bars)))
        grid.add_row(self.value, shown, Text(self.span, "dim"))
        return grid


Cells = tuple[Cell | CurveCell, ...]


class RowTable(DataTable[Cell | CurveCell]):
    """A table whose cursor stays on its row; on the first row, it stays at the top."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "select_cursor", "Open"),
        Binding("k", "cursor_up", "Cursor up", show=False),
        Binding("home", "scroll_top", "First row", show=False),
        Binding("end", "scroll_bottom", "Last row", show=False),
        Binding("ctrl+b", "page_up", "Page up", show=False),
        Binding("ctrl+f", "page_down", "Page down", show=False),
    ]

    def __init__(self, name: str) -> None:
        self._is_updating = False
        super().__init__(id=name, cursor_type="row", cell_padding=0)
        # what is kept is not found again after an update, whose number is part of the keys
        self._cell_render_cache.maxsize = _MOST_CELLS
        for kept in (self._row_render_cache, self._row_renderable_cache, self._line_cache):
            kept.maxsize = _MOST_LINES
        self._headings: Sequence[tuple[str, int]] = ()
        self._keys: list[str] = []
        self._cells: Callable[[str], Cells] = lambda _: ()
        self._shown: dict[str, Cells] = {}

    @property
    def cursor_key(self) -> str | None:
        """The key of the row at the cursor, or None in an empty table."""
        return self._keys[self.cursor_row] if self.cursor_row < len(self._keys) else None

    def go_to(self, key: str) -> None:
        if key in self._shown:
            self.move_cursor(row=self._keys.index(key))

    def show(
        self, headings: Sequence[tuple[str, int]], keys: list[str], cells: Callable[[str], Cells]
    ) -> None:
        """Show rows in the order of their keys. ``headings`` include widths.

        ``cells`` gives the cells of a row, when it is seen.
        """
        cursor = self.cursor_key if self.cursor_row else None
        if headings != self._headings or self._shown.keys() - set(keys):
            self._headings, self._shown, self._keys = headings, {}, []
            self.clear(columns=True)  # scrolling would look up removed rows
            for number, (label, width) in enumerate(headings):
                self.add_column(Text(label), key=f"{number}", width=width)
        for key in keys:
            if key not in self._shown:
                self._shown[key] = cells(key)
                self.add_row(*self._shown[key], key=key)
        if keys != self._keys:
            places = {key: place for place, key in enumerate(keys)}
            self.sort("0", key=lambda cell: places[cell.key])
        self._keys, self._cells = keys, cells
        if cursor is not None and cursor != self.cursor_key:
            self.go_to(cursor)
        self._update_seen()

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        super().watch_scroll_y(old_value, new_value)
        self._update_seen()

    def refresh(self, *regions: Region, **parts: bool) -> "RowTable":
        # each changed cell would redraw all lines
        return self if self._is_updating and not regions else super().refresh(*regions, **parts)

    def _update_seen(self) -> None:
        top = int(self.scroll_y)
        for place, key in enumerate(self._keys[top : top + self.size.height], top):
            before, self._shown[key] = self._shown[key], self._cells(key)
            if before == self._shown[key]:
                continue
            self._is_updating = True
            for number, (old, new) in enumerate(zip(before, self._shown[key], strict=True)):
                if old != new:
                    self.update_cell(key, f"{number}", new)
            self._is_updating = False
            self.refresh_row(place)
