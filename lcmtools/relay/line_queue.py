"""A bounded queue of messages for a line. Pure except for a lock.

If the line is as fast as the messages, none wait. Otherwise, only the newest message of some topics
waits, and if all take too much room, the topic that takes the most loses its oldest ones: images
make room before commands do. The protocol's own messages go first. Messages that have waited for a
second are dropped: a late command would move a robot when nobody expects it.
"""

import math
import threading
import time
from collections import deque
from typing import NamedTuple

from lcmtools.wire.stamp import Origin

MOST_WAITING_BYTES = 64 << 20
_AT_ONCE = 1 << 16  # bytes that are popped at a time
LATE = 1.0  # [s] after which a message is no longer sent
_COST = 200  # overhead of a message [byte]


class LineMessage(NamedTuple):
    """A message for a bus."""

    channel: str
    payload: bytes
    newest: bool = False  # it replaces a waiting one of its channel
    origin: Origin | None = None  # if the bus carries it with the message
    due: float = math.inf  # time.monotonic() until which it may be sent; ``inf`` for state


class LineQueue:
    """The messages that wait for one bus."""

    def __init__(self, most_bytes: int = MOST_WAITING_BYTES) -> None:
        self.dropped = 0  # the number of messages that were dropped
        self._most_bytes = most_bytes
        self._waiting: deque[LineMessage] = deque()
        self._first: deque[LineMessage] = deque()
        self._bytes = 0
        self._of_channel: dict[str, int] = {}  # bytes of waiting messages by channel
        self._changed = threading.Condition()
        self._closed = False
        self._is_sending = False  # True if messages are being sent
        self._cleared = -math.inf  # messages that were due by this time must not be sent

    @property
    def is_waiting(self) -> bool:
        """True while anything waits."""
        return bool(self._waiting or self._first)

    @property
    def is_idle(self) -> bool:
        """True while no messages wait or are being sent, except the protocol's own."""
        return not (self._waiting or self._is_sending)

    def add(self, messages: list[LineMessage]) -> None:
        """Queue messages."""
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
        """Queue a message of the protocol, ahead of all others."""
        with self._changed:
            self._first.append(message)
            self._changed.notify()

    def pop(self, timeout: float) -> list[LineMessage]:
        """Return messages to send, in order, waiting up to ``timeout`` [s] for the first.

        One large message is popped at a time, so that newer ones can replace others.
        """
        with self._changed:
            self._is_sending = False
            self._changed.wait_for(lambda: self._first or self._waiting or self._closed, timeout)
            popped, self._first = list(self._first), deque()
            self._is_sending = bool(self._waiting)
            size = 0
            while self._waiting and size < _AT_ONCE:
                popped.append(self._waiting.popleft())
                self._count(popped[-1], -1)
                size += len(popped[-1].payload) + _COST
            return popped

    def is_late(self, message: LineMessage) -> bool:
        """Return whether a popped message must not be sent any more; if so, count it as dropped."""
        if message.due > max(time.monotonic(), self._cleared):
            return False
        with self._changed:
            self.dropped += 1
        return True

    def close(self) -> None:
        """Make ``pop`` stop waiting."""
        with self._changed:
            self._closed = True
            self._changed.notify()

    def clear(self) -> None:
        """Drop all messages except the protocol's, including popped ones that are not state."""
        with self._changed:
            self._cleared = time.monotonic() + LATE
            self.dropped += len(self._waiting)
            self._waiting.clear()
            self._of_channel.clear()
            self._bytes = 0

    def _replace(self, channel: str) -> None:
        """Drop the oldest waiting message of a channel, if there is one."""
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
