"""The line in which a search or a filter is typed."""

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.message import Message
from textual.widgets import Input


class Prompt(Input):
    """A line to type in, hidden until it is asked for.

    Args:
        name: The widget's name.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "leave", show=False, priority=True),
        Binding("f3", "again", show=False, priority=True),
    ]
    DEFAULT_CSS = "Prompt { display: none; height: 1; border: none; padding: 0; }"

    class Left(Message):
        """Somebody has typed enough, or wants none of it."""

        def __init__(self, purpose: str, *, cancelled: bool) -> None:
            super().__init__()
            self.purpose = purpose
            self.cancelled = cancelled

    class Again(Message):
        """Somebody wants the next of what is searched."""

    def __init__(self, name: str) -> None:
        super().__init__(id=name, compact=True)
        self.purpose = ""

    def ask(self, purpose: str, text: str) -> None:
        """Let somebody type.

        Args:
            purpose: What for.
            text: What stands there at first.
        """
        self.purpose = purpose
        self.placeholder = f"{purpose}: type, Enter to keep, Esc to leave"
        self.display = True
        self.value = text
        self.cursor_position = len(text)
        self.focus()

    def on_input_submitted(self) -> None:
        """Keep what was typed."""
        self._leave(cancelled=False)

    def action_leave(self) -> None:
        """Give up."""
        self._leave(cancelled=True)

    def action_again(self) -> None:
        """Look for the next one."""
        self.post_message(self.Again())

    def _leave(self, *, cancelled: bool) -> None:
        purpose, self.purpose = self.purpose, ""
        self.display = False
        self.post_message(self.Left(purpose, cancelled=cancelled))
