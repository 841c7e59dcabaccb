"""The small lists that stand in front of the table: columns to sort by, and the keys."""

from collections.abc import Sequence
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.screen import ModalScreen

from lcmtools.cli.spy.columns import COLUMNS
from lcmtools.cli.spy.live.lines import BOLD, PLAIN, Lines, Part
from lcmtools.cli.spy.live.page import Page

_HELP = (
    ("Enter", "the channel's messages, decoded; there:"),
    ("", "a number's curve, or an array's elements"),
    ("F3 /", "search a channel; F3 again: the next one"),
    ("F4 \\", "only rows with this text anywhere; Esc: all"),
    ("F6  < >", "sort by: choose; the column before, the next"),
    (
        " ".join(column.letter for column in COLUMNS.values()),
        "sort by this column, as F6 lists them",
    ),
    ("I", "sort the other way round"),
    ("Space", "stop the display, and let it go on"),
    ("c", "count anew"),
    ("F1 h ?", "this help"),
    ("F10 q Ctrl-C", "end"),
    ("Ctrl-Z", "back to the shell, until fg"),
    ("", ""),
    ("Hz, bandwidth", "of the last two seconds"),
    ("jitter", "the longest interval of late less the shortest"),
    ("loss", "of the channel's senders: LCM numbers a sender's"),
    ("", "messages, not a channel's; what this computer is"),
    ("", "too busy to take counts too"),
    ("type +2", "it may be two others, by the same fingerprint"),
    ("dim", "silent for three seconds, or ever"),
)


class ListScreen(ModalScreen[str | None], Page[str | None]):
    """Lines in front of the table."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,f6,f1", "back", show=False),
    ]
    DEFAULT_CSS = """
    ListScreen { align: center middle; background: transparent; }
    ListScreen Lines { border: round ansi_cyan; max-width: 100%; max-height: 100%; }
    """

    def __init__(self) -> None:
        super().__init__()
        self.lines = Lines("list")

    def compose(self) -> ComposeResult:
        """The list."""
        yield self.lines

    def show(self, rows: Sequence[tuple[str, Sequence[Part]]], title: str) -> None:
        """Show these lines, each with its key."""
        lines = self.lines
        lines.border_title = title
        lines.styles.width = 2 + max(sum(len(text) for text, _ in parts) for _, parts in rows)
        lines.styles.height = 2 + len(rows)
        lines.focus()
        lines.show([key for key, _ in rows], lambda number: rows[number][1], ())


class SortScreen(ListScreen):
    """The columns; gives the name of the one chosen.

    Args:
        column: The name of the column that the table is sorted by now.
    """

    def __init__(self, column: str) -> None:
        super().__init__()
        self._column = column

    def on_mount(self) -> None:
        """Show the columns, with the cursor on the present one."""
        rows = [
            (c.name, ((f" {c.letter} ", BOLD), (f"{c.name:<12}", PLAIN))) for c in COLUMNS.values()
        ]
        self.show(rows, "sort by")
        self.lines.go_to(self._column)

    def on_lines_chosen(self, event: Lines.Chosen) -> None:
        """Give back what was chosen."""
        event.stop()
        self.dismiss(event.key)


class HelpScreen(ListScreen):
    """The keys, and what the columns mean."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("h,question_mark", "back", show=False)]

    def on_mount(self) -> None:
        """Show the help."""
        width = max(len(keys) for keys, _ in _HELP)
        rows = [
            (f"{number}", ((f" {keys:<{width}}  ", BOLD), (f"{does} ", PLAIN)))
            for number, (keys, does) in enumerate(_HELP)
        ]
        self.show(rows, "keys and columns")

    def on_lines_chosen(self, event: Lines.Chosen) -> None:
        """Close it."""
        event.stop()
        self.dismiss(None)
