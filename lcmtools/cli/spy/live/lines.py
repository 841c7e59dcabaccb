"""A list of lines with a cursor, of which only those that are seen are made.

Refreshed several times a second, so it draws itself and sends the terminal only lines that differ.
"""

from collections.abc import Callable, Sequence
from typing import ClassVar

from rich.segment import Segment
from rich.style import Style
from textual.binding import Binding, BindingType
from textual.events import Click, MouseScrollDown, MouseScrollUp, Resize
from textual.geometry import Region
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from lcmtools.cli.spy.columns import cut, width_of

PLAIN = Style()
BOLD = Style(bold=True)
DIM = Style(dim=True)
HEADER = Style(color="green", reverse=True)
SORTED = Style(color="green", reverse=True, bold=True)
CURSOR = Style(color="cyan", reverse=True)
GOOD = Style(color="green")
CURVE = Style(color="cyan")
NAME = Style(color="cyan")
WARN = Style(color="yellow", bold=True)
BAD = Style(color="red", bold=True)

Part = tuple[str, Style]
"""A piece of a line."""

_WHEEL = 3  # lines


class Lines(Widget, can_focus=True):
    """Lines below a heading, one of which the cursor is on; it stays on what it is on.

    Args:
        name: The widget's name.
        has_cursor: Whether there is a cursor; else nobody can choose a line.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up,k", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("pageup,ctrl+b", "page(-1)", show=False),
        Binding("pagedown,ctrl+f", "page(1)", show=False),
        Binding("home", "move(-1000000)", show=False),
        Binding("end", "move(1000000)", show=False),
        Binding("enter", "choose", show=False),
    ]

    class Chosen(Message):
        """Somebody wants to see more of a line."""

        def __init__(self, key: str) -> None:
            super().__init__()
            self.key = key

    class HeadingClicked(Message):
        """Somebody has clicked on the heading."""

        def __init__(self, x: int) -> None:
            super().__init__()
            self.x = x

    def __init__(self, name: str, *, has_cursor: bool = True) -> None:
        super().__init__(id=name)
        self.can_focus = has_cursor
        self._keys: Sequence[str] = ()
        self._heading: Sequence[Part] = ()
        self._draw: Callable[[int], Sequence[Part]] = lambda _: ()
        self._cursor = self._offset = 0
        self._has_moved = False
        self._strips: list[Strip] = []

    @property
    def cursor_key(self) -> str | None:
        """What the cursor is on; None where there are no lines."""
        return self._keys[self._cursor] if self._keys else None

    @property
    def room(self) -> int:
        """How many lines are seen at once, below the heading."""
        return max(1, self.size.height - bool(self._heading))

    @property
    def seen(self) -> range:
        """The numbers of the lines that are seen."""
        return range(self._offset, min(len(self._keys), self._offset + self.room))

    def show(
        self, keys: Sequence[str], draw: Callable[[int], Sequence[Part]], heading: Sequence[Part]
    ) -> None:
        """Show these lines.

        Args:
            keys: What each is about, by which the cursor finds its line again.
            draw: The pieces of a line, by its number.
            heading: The pieces of the line above; none for no such line.
        """
        before = self.cursor_key
        self._keys, self._draw, self._heading = keys, draw, heading
        if self._has_moved and before in keys:
            self._cursor = keys.index(before)
        self._scroll()
        self.redraw()

    def go_to(self, key: str) -> None:
        """Put the cursor on a line."""
        if key in self._keys:
            self._place(self._keys.index(key))

    def redraw(self) -> None:
        """Draw what is seen anew, and let the terminal have the lines that differ."""
        width, height = self.size
        strips = [self._strip(y, width) for y in range(height)]
        before, self._strips = self._strips, strips
        if len(before) != len(strips):
            self.refresh()
            return
        changed = [y for y, strip in enumerate(strips) if strip != before[y]]
        if changed:
            self.refresh(*(Region(0, y, width, 1) for y in changed))

    def render_line(self, y: int) -> Strip:
        """The line of the screen at a height."""
        return self._strips[y] if y < len(self._strips) else Strip.blank(self.size.width)

    def action_move(self, lines: int) -> None:
        """Move the cursor."""
        self._place(self._cursor + lines)

    def action_page(self, pages: int) -> None:
        """Move the cursor by as much as is seen."""
        self._place(self._cursor + pages * max(1, self.room - 1))

    def action_choose(self) -> None:
        """Choose the line that the cursor is on."""
        if self.cursor_key is not None:
            self.post_message(self.Chosen(self.cursor_key))

    def on_resize(self, _event: Resize) -> None:
        """Draw for another size."""
        self._scroll()
        self._strips = []
        self.redraw()

    def on_click(self, event: Click) -> None:
        """Choose a line by two clicks; put the cursor there by one."""
        line = event.y - bool(self._heading)
        if line < 0:
            self.post_message(self.HeadingClicked(event.x))
        elif self._offset + line < len(self._keys):
            self._place(self._offset + line)
            if event.chain > 1:
                self.action_choose()

    def on_mouse_scroll_down(self, _event: MouseScrollDown) -> None:
        """Move on with the wheel."""
        self.action_move(_WHEEL)

    def on_mouse_scroll_up(self, _event: MouseScrollUp) -> None:
        """Move back with the wheel."""
        self.action_move(-_WHEEL)

    def _place(self, line: int) -> None:
        self._has_moved = True
        self._cursor = max(0, min(line, len(self._keys) - 1))
        self._scroll()
        self.redraw()

    def _scroll(self) -> None:
        """Bring the cursor, and no emptiness, into what is seen."""
        count, room = len(self._keys), self.room
        self._cursor = max(0, min(self._cursor, count - 1))
        self._offset = max(self._cursor - room + 1, min(self._offset, self._cursor, count - room))
        self._offset = max(0, self._offset)

    def _strip(self, y: int, width: int) -> Strip:
        line = y - bool(self._heading)
        if line < 0:
            return make_strip(self._heading, width, HEADER)
        number = self._offset + line
        if number >= len(self._keys):
            return Strip.blank(width)
        parts = self._draw(number)
        if number == self._cursor and self.can_focus:
            parts = [(text, CURSOR) for text, _ in parts]
            return make_strip(parts, width, CURSOR)
        return make_strip(parts, width, PLAIN)


def make_strip(parts: Sequence[Part], width: int, rest: Style) -> Strip:
    """A line of the screen: cut to its width, or filled up."""
    segments, used = [], 0
    for text, style in parts:
        shown = cut(text, width - used, "end")
        segments.append(Segment(shown, style))
        used += width_of(shown)
    segments.append(Segment(" " * max(0, width - used), rest))
    return Strip(segments, width)
