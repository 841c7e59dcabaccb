"""A number over time, as large as the screen."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType

from lcmtools.cli.spy.live.bars import Bar, keys_line
from lcmtools.cli.spy.live.lines import BOLD, CURVE, PLAIN, WARN, Lines
from lcmtools.cli.spy.live.page import Page
from lcmtools.cli.spy.sparkline import number_text, plot
from lcmtools.observe.study import Study

_KEYS = (("Esc", "Back"), ("+", "Longer"), ("-", "Shorter"), ("Space", "Pause"), ("F10", "Quit"))
_SPANS = (2, 5, 10, 20, 40, 120, 600)  # [s]
_USUAL = 3


class CurveScreen(Page[str | None]):
    """A number over time.

    Args:
        study: What is known of the channel's messages.
        path: Where the number is in them.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,enter,left", "back", show=False),
        Binding("plus,equals_sign", "span(1)", show=False),
        Binding("minus", "span(-1)", show=False),
        Binding("space", "pause", show=False),
    ]

    def __init__(self, study: Study, path: str) -> None:
        super().__init__()
        self.study = study
        self.is_paused = False
        self._path = path
        self._span = _USUAL
        self._title, self._lines = Bar("title"), Lines("curve", has_cursor=False)

    def compose(self) -> ComposeResult:
        """The parts of the screen, from above."""
        yield self._title
        yield self._lines
        yield Bar("keys", keys_line(_KEYS))

    def on_mount(self) -> None:
        """Draw what is known already."""
        self.draw()

    def on_resize(self) -> None:
        """Make it fit."""
        self.call_after_refresh(self.draw)

    def action_span(self, step: int) -> None:
        """Show more time, or less."""
        self._span = max(0, min(len(_SPANS) - 1, self._span + step))
        self.draw()

    def action_pause(self) -> None:
        """Stop the display, or let it go on."""
        self.is_paused = not self.is_paused
        self.draw()

    def take(self) -> None:
        """Draw what is known now."""
        if not self.is_paused:
            self.draw()

    def draw(self) -> None:
        """Draw the curve."""
        width, height = self._lines.size
        samples = self.study.samples(self._path)
        if not samples or not height:
            return
        now, value = samples[-1]
        span = _SPANS[self._span] * 1_000_000_000
        known = [number for time, number in samples if time >= now - span]
        title = [(f"{self.study.channel}  {self._path}", BOLD), (f"  {number_text(value)}", CURVE)]
        title.append((f"  {len(known)} values, {number_text(min(known))} to", PLAIN))
        title.append((f" {number_text(max(known))}", PLAIN))
        if self.is_paused:
            title.append(("  PAUSED", WARN))
        self._title.show(title)
        rows = plot(samples, now, width, height, span)
        self._lines.show([str(i) for i in range(len(rows))], lambda i: ((rows[i], CURVE),), ())
