"""The lines above and below the table: what is looked at, and which keys do what."""

from collections.abc import Sequence

from rich.style import Style
from textual.events import Resize
from textual.strip import Strip
from textual.widget import Widget

from lcmtools.cli.spy.live.lines import Part, make_strip

KEY = Style(bold=True)
DOES = Style(color="cyan", reverse=True)


class Bar(Widget):
    """Some lines of text; it takes up no room where there are none."""

    DEFAULT_CSS = "Bar { height: 1; }"

    def __init__(self, name: str, *lines: Sequence[Part]) -> None:
        super().__init__(id=name)
        self._lines: Sequence[Sequence[Part]] = lines

    def show(self, *lines: Sequence[Part]) -> None:
        """Show these lines; empty ones are left out."""
        shown = [line for line in lines if line]
        if shown == self._lines:
            return
        self._lines = shown
        self.styles.height = len(shown)
        self.refresh()

    @property
    def text(self) -> str:
        """What is shown."""
        return "\n".join("".join(text for text, _ in line) for line in self._lines)

    def on_resize(self, _event: Resize) -> None:
        """Draw for another size."""
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """The line of the screen at a height."""
        line = self._lines[y] if y < len(self._lines) else ()
        return make_strip(line, self.size.width, Style())


def keys_line(keys: Sequence[tuple[str, str]]) -> list[Part]:
    """Keys and what each does, as htop has them below."""
    return [part for key, does in keys for part in ((key, KEY), (f"{does:<6}", DOES), (" ", KEY))]
