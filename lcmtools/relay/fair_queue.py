"""Bounded queues of messages for a slow line: channels with little waiting go first.

Commands and state wait for no image: the channel with the fewest waiting bytes goes first, and
messages of one channel stay in order. Where little waits, all leave in the order of coming. What
has waited for a second is dropped: a late command would move a robot when nobody expects it. A
channel with much data keeps only the newest, so that these are not always nearly a second old.
"""

import math
import threading
import time
from collections import Counter, deque
from dataclasses import dataclass
from heapq import heapify, heappop, heapreplace
from typing import Generic, NamedTuple, TypeVar

from lcmtools.bounded import count
from lcmtools.wire.stamp import Origin

MOST_WAITING_BYTES = 64 << 20
LATE = 1.0  # [s] after which a message is no longer sent
_LITTLE_BYTES = 4096  # waiting bytes of a channel that has no lower rank than those with fewer
_MUCH_BYTES = 64_000  # waiting bytes of a channel that keeps only the newest
_PATIENCE = 0.25  # [s] that messages of such a channel may wait, as in a burst
_COST = 200  # overhead of a message [byte]
_AT_ONCE = 4096  # bytes that are taken for a line at a time

ItemT = TypeVar("ItemT")


@dataclass(slots=True)  # Python 3.10 has no generic NamedTuple
class _Waiting(Generic[ItemT]):
    item: ItemT
    size: int
    due: float
    number: int


class _Channel(Generic[ItemT]):
    def __init__(self) -> None:
        self.messages: deque[_Waiting[ItemT]] = deque()
        self.bytes = 0

    @property
    def rank(self) -> tuple[int, int]:
        """The order in which channels are served."""
        return max(self.bytes, _LITTLE_BYTES), self.messages[0].number

    def is_outdated(self, now: float) -> bool:
        """Return whether its first message must not be sent any more."""
        due = self.messages[0].due
        if self.bytes > _MUCH_BYTES and len(self.messages) > 1:
            due -= LATE - _PATIENCE
        return due < now


class FairQueue(Generic[ItemT]):
    """The messages that wait for one connection; times are of any monotonic clock [s]."""

    def __init__(self, most_bytes: int = MOST_WAITING_BYTES) -> None:
        self.dropped = 0  # the number of messages that were dropped
        self.dropped_of, self.passed_of = Counter[str](), Counter[str]()  # of each channel
        self._most_bytes = most_bytes
        self._channels: dict[str, _Channel[ItemT]] = {}
        self._count = self._bytes = self._number = 0

    def __len__(self) -> int:
        """Return the number of waiting messages."""
        return self._count

    def add(self, channel: str, item: ItemT, size: int, due: float, now: float) -> None:
        """Queue a message that may be sent until ``due``; drop others if there is no room."""
        waiting = self._channels.setdefault(channel, _Channel())
        self._number += 1
        message = _Waiting(item, size + _COST, due, self._number)
        waiting.messages.append(message)
        waiting.bytes += message.size
        self._bytes += message.size
        self._count += 1
        while waiting.messages and waiting.is_outdated(now):
            self._drop(channel)
        while self._bytes > self._most_bytes and self._count > 1:
            self._drop(max(self._channels, key=lambda name: self._channels[name].bytes))

    def drop_first(self, channel: str) -> None:
        """Drop the oldest waiting message of a channel, if there is one."""
        if channel in self._channels:
            self._drop(channel)

    def drop_outdated(self, now: float) -> None:
        """Drop what must not be sent any more."""
        for name, channel in list(self._channels.items()):
            while channel.messages and channel.is_outdated(now):
                self._drop(name)

    def pop(self, now: float, most_bytes: int) -> list[ItemT]:
        """Remove and return the next messages, no more than needed for so many bytes."""
        self.drop_outdated(now)
        ranked = [(channel.rank, name) for name, channel in self._channels.items()]
        heapify(ranked)
        popped: list[ItemT] = []
        while ranked and most_bytes > 0:
            name = ranked[0][1]
            message = self._take(name)
            count(self.passed_of, name)
            popped.append(message.item)
            most_bytes -= message.size
            if name in self._channels:
                heapreplace(ranked, (self._channels[name].rank, name))
            else:
                heappop(ranked)
        return popped

    def clear(self) -> None:
        """Drop all messages."""
        self.dropped += self._count
        self._channels.clear()
        self._count = self._bytes = 0

    def count_dropped(self, channel: str) -> None:
        """Count a message that was removed, but not sent."""
        self.dropped += 1
        count(self.dropped_of, channel)

    def _drop(self, name: str) -> None:
        self._take(name)
        self.count_dropped(name)

    def _take(self, name: str) -> _Waiting[ItemT]:
        channel = self._channels[name]
        message = channel.messages.popleft()
        channel.bytes -= message.size
        self._bytes -= message.size
        self._count -= 1
        if not channel.messages:
            del self._channels[name]
        return message


class LineMessage(NamedTuple):
    """A message for a bus."""

    channel: str
    payload: bytes
    newest: bool = False  # it replaces a waiting one of its channel
    origin: Origin | None = None  # if the bus carries it with the message
    due: float = math.inf  # time.monotonic() until which it may be sent; ``inf`` for state


class LineQueue:
    """The messages that wait for one bus, between two threads: the protocol's own first."""

    def __init__(self, most_bytes: int = MOST_WAITING_BYTES) -> None:
        self.waiting: FairQueue[LineMessage] = FairQueue(most_bytes)  # all but the protocol's own
        self._first: deque[LineMessage] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._is_sending = False  # True if messages are being sent

    def __len__(self) -> int:
        """Return the number of waiting messages."""
        return len(self.waiting) + len(self._first)

    @property
    def is_idle(self) -> bool:
        """True while no messages wait or are being sent, except the protocol's own."""
        return not (self.waiting or self._is_sending)

    def add(self, messages: list[LineMessage]) -> None:
        """Queue messages."""
        now = time.monotonic()
        with self._changed:
            for message in messages:
                if message.newest:
                    self.waiting.drop_first(message.channel)
                size = len(message.payload)
                self.waiting.add(message.channel, message, size, message.due, now)
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
            self._changed.wait_for(lambda: len(self) or self._closed, timeout)
            popped, self._first = list(self._first), deque()
            popped += self.waiting.pop(time.monotonic(), _AT_ONCE)
            self._is_sending = bool(popped)
            return popped

    def is_late(self, message: LineMessage) -> bool:
        """Return whether a popped message must not be sent any more; if so, count it as dropped."""
        if message.due > time.monotonic():
            return False
        with self._changed:
            self.waiting.count_dropped(message.channel)
        return True

    def clear(self) -> None:
        """Drop all messages except the protocol's."""
        with self._changed:
            self.waiting.clear()

    def close(self) -> None:
        """Make ``pop`` stop waiting."""
        with self._changed:
            self._closed = True
            self._changed.notify()
