"""The messages that wait for a line: the protocol's own first, the others as in ``fair_queue``.

Of some topics, only the newest message waits.
"""

import math
import threading
import time
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

from lcmtools.bounded import count
from lcmtools.relay.fair_queue import LATE, MOST_WAITING_BYTES, FairQueue
from lcmtools.wire.stamp import Origin

_AT_ONCE = 4096  # bytes that are popped at a time


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
        self._waiting: FairQueue[LineMessage] = FairQueue(most_bytes)
        self._first: deque[LineMessage] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._is_sending = False  # True if messages are being sent
        self._cleared = -math.inf  # messages that were due by this time must not be sent

    @property
    def dropped(self) -> int:
        """The number of messages that were dropped."""
        return self._waiting.dropped

    @property
    def dropped_of(self) -> Mapping[str, int]:
        """The number of dropped messages of each channel."""
        return self._waiting.dropped_of

    @property
    def passed_of(self) -> Mapping[str, int]:
        """The number of popped messages of each channel."""
        return self._waiting.passed_of

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
        now = time.monotonic()
        with self._changed:
            for message in messages:
                if message.newest:
                    self._waiting.drop_first(message.channel)
                size = len(message.payload)
                self._waiting.add(message.channel, message, size, message.due, now)
            self._changed.notify()

    def add_first(self, message: LineMessage) -> None:
        """Queue a message of the protocol, ahead of all others."""
        with self._changed:
            self._first.append(message)
            self._changed.notify()

    def pop(self, timeout: float) -> list[LineMessage]:
        """Return messages to send, waiting up to ``timeout`` [s] for the first.

        One large message is popped at a time, so that newer ones can replace others.
        """
        with self._changed:
            self._is_sending = False
            self._changed.wait_for(lambda: self._first or self._waiting or self._closed, timeout)
            popped, self._first = list(self._first), deque()
            popped += self._waiting.pop(time.monotonic(), _AT_ONCE)
            self._is_sending = bool(popped)
            return popped

    def is_late(self, message: LineMessage) -> bool:
        """Return whether a popped message must not be sent any more; if so, count it as dropped."""
        if message.due > max(time.monotonic(), self._cleared):
            return False
        with self._changed:
            self._waiting.dropped += 1
            count(self._waiting.dropped_of, message.channel)
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
            self._waiting.clear()
