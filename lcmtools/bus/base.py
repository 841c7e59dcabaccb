"""The interface of a bus for nodes, and a bus for tests that needs no network."""

import time
from collections.abc import Callable
from typing import Protocol

from lcmtools.errors import BusError
from lcmtools.names import check_length

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


class FakeBus:
    """A bus within one process, delivering at once on the publisher's thread; for tests."""

    def __init__(self) -> None:
        self.published: list[tuple[str, bytes]] = []
        """All messages that were sent."""
        self.on_outage: Callable[[str], None] = lambda _: None
        self._handlers: dict[str, list[Handler]] = {}
        self._closed = False

    @property
    def ports(self) -> list[int]:
        """None: nothing goes over the network."""
        return []

    def publish(self, channel: str, payload: bytes) -> None:
        """Deliver a message to all subscribers of its channel."""
        if self._closed:
            raise BusError("the bus is closed")
        check_length(channel)
        self.published.append((channel, payload))
        for handler in tuple(self._handlers.get(channel, ())):
            handler(payload, time.time_ns())

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler`` for each message on the channel."""
        self._handlers.setdefault(check_length(channel), []).append(handler)

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        handlers = self._handlers.get(channel, [])
        if handler in handlers:
            handlers.remove(handler)

    def close(self) -> None:
        """Deliver nothing any more."""
        self._closed = True
        self._handlers.clear()
