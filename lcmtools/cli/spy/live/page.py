"""What the live view's screens have in common: they come and go one at a time.

A key is dispatched before the one ahead of it has done its work, and a timer or a new size may come
while a screen is being made or taken down. So a screen opens another, and is left, only while it
stands in front; and it keeps its parts itself, instead of looking for them on the screen.
"""

from collections.abc import Callable

from textual.await_complete import AwaitComplete
from textual.screen import Screen, ScreenResultType


class Page(Screen[ScreenResultType]):
    """A screen of the live view."""

    @property
    def is_in_front(self) -> bool:
        """Whether keys are for this screen; not while it is taken down."""
        return self.app.screen_stack[-1:] == [self]

    def open(
        self, page: Screen[str | None], then: Callable[[str | None], None] | None = None
    ) -> None:
        """Put another screen in front, unless one is there already.

        Args:
            page: The screen.
            then: Is given what it gives when it is left.
        """
        if self.is_in_front:
            self.app.push_screen(page, then)

    def dismiss(self, result: ScreenResultType | None = None) -> AwaitComplete:
        """Leave this screen; once, however often it is asked for."""
        return super().dismiss(result) if self.is_in_front else AwaitComplete()

    def action_back(self) -> None:
        """Leave this screen."""
        self.dismiss()
