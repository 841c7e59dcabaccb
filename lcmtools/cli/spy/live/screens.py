"""The base classes of the screens, and the dialogs for help and sorting."""

from collections.abc import Callable
from typing import ClassVar

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.await_complete import AwaitComplete
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.events import Resize
from textual.screen import ModalScreen, Screen, ScreenResultType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from lcmtools.observe.channels.columns import COLUMNS, heading

_HELP = f"""\
Enter         the channel's message, decoded; there: a number's
              curve, or an array's elements
F3 /          search a channel; F3 again: the next one
F4 \\          only rows with this text anywhere; Esc: all
F6 < >        sort by: choose; the previous column, the next
{" ".join(column.letter for column in COLUMNS.values())}
              sort by this column, as F6 lists them
I             sort the other way round
Space c       pause; count from zero
F1 h ?        this help
F10 q Ctrl-C  quit; Ctrl-Z: back to the shell, until fg

Hz bandwidth  of the last two seconds
jitter        the longest recent interval less the shortest
loss          of the channel's senders: LCM numbers a sender's
              messages, not a channel's; what this computer
              is too busy to take counts too
type +2       it may be two others with the same fingerprint
dim           silent for three seconds, or ever"""


class Page(Screen[ScreenResultType]):
    """A screen that closes once, however often the key is pressed."""

    def dismiss(self, result: ScreenResultType | None = None) -> AwaitComplete:
        in_front = self.app.screen_stack[-1:] == [self]
        return super().dismiss(result) if in_front else AwaitComplete()

    def action_back(self) -> None:
        self.dismiss()

    @on(Resize)
    def drop_old_size(self, event: Resize) -> None:
        # A screen of another size than before tells itself so by another event: of two sizes with
        # anything in between, each would bring back the other, without end.
        if event.size != self.app.size:
            event.prevent_default()


class LivePage(Page[None]):
    """A screen that is redrawn several times a second unless paused."""

    period: float | None = 0.2  # between two looks at what is new [s]; None for no looks

    def __init__(self, draw: Callable[[], None]) -> None:
        super().__init__()
        self.draw = draw
        self.is_paused = False
        self.top = Static(id="title")
        self._title = Text()

    def show_title(self, text: Text) -> None:
        """Show a text at the top. The layout changes only with the number of lines."""
        before, self._title = self._title, text
        if text != before:
            self.top.update(text, layout=text.plain.count("\n") != before.plain.count("\n"))

    def on_mount(self) -> None:
        self.draw()
        if self.period:
            self.set_interval(self.period, self.update)

    def on_resize(self) -> None:
        self.call_after_refresh(self.draw)

    def action_pause(self) -> None:
        self.is_paused = not self.is_paused
        self.draw()

    def update(self) -> None:
        if not self.is_paused:
            self.draw()


class HelpScreen(ModalScreen[None], Page[None]):
    """The dialog with the keys and the meaning of the columns."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q,enter,f1,h,question_mark", "back", "Back", show=False)
    ]

    def compose(self) -> ComposeResult:
        text = VerticalScroll(Static(Text(_HELP)))
        text.border_title = "keys and columns"
        yield text


class SortScreen(ModalScreen[str | None], Page[str | None]):
    """The dialog with the columns to sort by; its result is the chosen column."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,q,f6", "back", "Back", show=False)]

    def __init__(self, column: str) -> None:
        super().__init__()
        self._column = column

    def compose(self) -> ComposeResult:
        options = [Option(f"{c.letter}  {heading(c)}", id=c.name) for c in COLUMNS.values()]
        columns = OptionList(*options)
        columns.border_title = "sort by"
        columns.highlighted = list(COLUMNS).index(self._column)
        yield columns

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(event.option_id)
