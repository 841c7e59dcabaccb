"""One channel on the screen: its latest message, decoded, with a curve beside each number."""

from collections.abc import Callable, Sequence
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType

from lcmtools.cli.spy.closeup import Closeup
from lcmtools.cli.spy.live.bars import Bar, keys_line
from lcmtools.cli.spy.live.curve import CurveScreen
from lcmtools.cli.spy.live.lines import BOLD, CURVE, DIM, NAME, PLAIN, WARN, Lines, Part
from lcmtools.cli.spy.live.page import Page
from lcmtools.observe.channels import Row
from lcmtools.observe.study import Study

_KEYS = (
    *(("Esc", "Back"), ("Enter", "Curve, or open"), ("Space", "Pause"), ("c", "Clear")),
    *(("F1", "Help"), ("F10", "Quit")),
)
_STYLES = {"": PLAIN, "name": NAME, "curve": CURVE, "dim": DIM, "bold": BOLD, "warn": WARN}


class Detail(Page[str | None]):
    """One channel.

    Args:
        study: What is known of its messages.
        row: What the table knows of it.
        unfollow: Ends that the study hears them.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,left", "back", show=False),
        Binding("space", "pause", show=False),
        Binding("c", "clear", show=False),
    ]

    def __init__(self, study: Study, row: Row, unfollow: Callable[[], None]) -> None:
        super().__init__()
        self.study = study
        self.is_paused = False
        self._row = row
        self._unfollow = unfollow
        self._closeup = Closeup(row, study.look())
        self._title, self._lines = Bar("title"), Lines("message")

    def compose(self) -> ComposeResult:
        """The parts of the screen, from above."""
        yield self._title
        yield self._lines
        yield Bar("keys", keys_line(_KEYS))

    def on_mount(self) -> None:
        """Show what is known already."""
        self._lines.focus()
        self._draw()

    def on_unmount(self) -> None:
        """Listen no more."""
        self._unfollow()

    def on_resize(self) -> None:
        """Make it fit."""
        self.call_after_refresh(self._draw)

    def take(self, row: Row) -> None:
        """Show what is known now."""
        if not self.is_paused:
            self._row = row
            self.study.types = row.types if row.is_announced else ()
            self._closeup = Closeup(row, self.study.look())
            self._draw()

    def action_pause(self) -> None:
        """Stop the display, or let it go on."""
        self.is_paused = not self.is_paused
        self._draw()

    def action_clear(self) -> None:
        """Forget what the numbers have been."""
        self.study.clear()

    def on_lines_chosen(self, event: Lines.Chosen) -> None:
        """Show the curve of a number; open or close anything else."""
        event.stop()
        line = self._closeup.line(event.key)
        if line is not None and line.number is not None:
            self.open(CurveScreen(self.study, line.path))
        elif line is not None and line.opens:
            self.study.toggle(line.path)
            self._closeup = Closeup(self._row, self.study.look())
            self._draw()

    def _draw(self) -> None:
        if not self.size.width:
            return
        title = [_parts(line) for line in self._closeup.head(self.size.width)]
        if self.is_paused:
            title[0] = [*title[0], ("  PAUSED", WARN)]
        self._title.show(*title)
        width = self.size.width

        def draw(number: int) -> Sequence[Part]:
            return _parts(self._closeup.body(number, width, self.study.samples))

        self._lines.show(self._closeup.keys, draw, ())


def _parts(pieces: Sequence[tuple[str, str]]) -> list[Part]:
    return [(text, _STYLES[style]) for text, style in pieces]
