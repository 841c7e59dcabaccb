"""The interface of a bus for nodes."""

from collections.abc import Callable
from typing import Protocol

Handler = Callable[[bytes, int], None]
"""Called with a payload and the time it arrived (nanoseconds since 1970); must be quick."""


class Bus(Protocol):
    """A connection to a bus."""

    on_outage: Callable[[str], None]
    """Called, on the receiving thread, when the connection is lost, and when it is back."""

    @property
    def ports(self) -> list[int]:
        """UDP ports that messages come from besides the one of announcements."""
        ...

    def publish(self, channel: str, payload: bytes) -> None:
        """Send one message. Safe from any thread."""
        ...

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler``, on the receiving thread, for each message on the channel."""
        ...

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        ...

    def close(self) -> None:
        """Send waiting messages and leave the bus."""
        ...
