"""Messages that wait for a line, bounded. Pure but for a lock.

A line that is as fast as the messages has none waiting. On one that is not, only the newest message
of some topics waits, and where all take too much room, the topic that takes the most loses its
oldest ones: images make way before commands do. The protocol's own messages go first. What has
waited for a second is dropped: a late command moves a robot when nobody expects it any more.
"""

import math
import threading
import time
from collections import deque
from typing import NamedTuple

from lcmtools.wire.stamp import Origin

MOST_WAITING_BYTES = 64 << 20
_AT_ONCE = 1 << 16  # bytes that are taken together
LATE = 1.0  # [s] after which a message is not sent any more
_COST = 200  # bytes that a message takes besides its own


class LineMessage(NamedTuple):
    """A message for a bus."""

    channel: str
    payload: bytes
    newest: bool = False  # it takes the place of an earlier one of its channel that waits
    origin: Origin | None = None  # where the bus carries it beside the message
    due: float = math.inf  # time.monotonic() until which it may be sent; ``inf`` for what is state


class LineQueue:
    """The messages that wait for one bus."""

    def __init__(self, most_bytes: int = MOST_WAITING_BYTES) -> None:
        self.dropped = 0  # the number of messages that were dropped
        self._most_bytes = most_bytes
        self._waiting: deque[LineMessage] = deque()
        self._first: deque[LineMessage] = deque()
        self._bytes = 0
        self._of_channel: dict[str, int] = {}  # bytes, of channels that wait
        self._changed = threading.Condition()
        self._closed = False
        self._is_taken = False  # messages are being sent
        self._cleared = -math.inf  # the time by which messages were due that must not be sent

    @property
    def is_waiting(self) -> bool:
        """True while anything waits."""
        return bool(self._waiting or self._first)

    @property
    def is_idle(self) -> bool:
        """True while no message waits or is being sent but the protocol's own."""
        return not (self._waiting or self._is_taken)

    def add(self, messages: list[LineMessage]) -> None:
        """Let messages wait."""
        with self._changed:
            for message in messages:
                if message.newest:
                    self._replace(message.channel)
                self._waiting.append(message)
                self._count(message, 1)
            while self._bytes > self._most_bytes and len(self._waiting) > 1:
                self._replace(max(self._of_channel, key=self._of_channel.__getitem__))
            self._changed.notify()

    def add_first(self, message: LineMessage) -> None:
        """Let a message of the protocol wait, before all others."""
        with self._changed:
            self._first.append(message)
            self._changed.notify()

    def take(self, timeout: float) -> list[LineMessage]:
        """Return messages to send, in order, waiting up to ``timeout`` [s] for the first.

        One large message is taken at a time, so that newer ones can take the place of others.
        """
        with self._changed:
            self._is_taken = False
            self._changed.wait_for(lambda: self._first or self._waiting or self._closed, timeout)
            taken, self._first = list(self._first), deque()
            self._is_taken = bool(self._waiting)
            size = 0
            while self._waiting and size < _AT_ONCE:
                taken.append(self._waiting.popleft())
                self._count(taken[-1], -1)
                size += len(taken[-1].payload) + _COST
            return taken

    def is_late(self, message: LineMessage) -> bool:
        """Return whether a message that was taken must not be sent; if so, it counts as dropped."""
        if message.due > max(time.monotonic(), self._cleared):
            return False
        with self._changed:
            self.dropped += 1
        return True

    def close(self) -> None:
        """Let ``take`` wait no more."""
        with self._changed:
            self._closed = True
            self._changed.notify()

    def clear(self) -> None:
        """Drop all messages but the protocol's, also those that were taken and are not state."""
        with self._changed:
            self._cleared = time.monotonic() + LATE
            self.dropped += len(self._waiting)
            self._waiting.clear()
            self._of_channel.clear()
            self._bytes = 0

    def _replace(self, channel: str) -> None:
        """Drop the oldest message of a channel, if any waits."""
        if channel not in self._of_channel:
            return
        for place, message in enumerate(self._waiting):
            if message.channel == channel:
                del self._waiting[place]
                self._count(message, -1)
                self.dropped += 1
                return

    def _count(self, message: LineMessage, times: int) -> None:
        size = times * (len(message.payload) + _COST)
        self._bytes += size
        left = self._of_channel.get(message.channel, 0) + size
        if left:
            self._of_channel[message.channel] = left
        else:
            del self._of_channel[message.channel]
