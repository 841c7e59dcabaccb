"""A sender for a network that may be slower than its publishers: the newest messages wait.

Up to 64 kB of each topic wait, or one message: hundreds of commands, the newest large image. More
waits only for a moment, in which the network may stall. The oldest make room, so that no
publisher waits and no old messages are sent. A message that would arrive too late is dropped.
"""

import time
from collections import Counter, deque
from collections.abc import Callable
from typing import NamedTuple

from lcmtools.bounded import count
from lcmtools.bus.base import SendingThread
from lcmtools.wire.stamp import Origin

MOST_WAITING_BYTES = 64_000  # bytes of a topic's waiting messages; a single one may always wait
_MOST_WAITING = 700_000_000  # [ns]: a receiver drops what is a second old
_STALL = 250_000_000  # [ns] in which messages that have a time make no room for others
_MOST_STALLED_BYTES = 4 << 20
CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)  # a clock that cannot be set


class Outgoing(NamedTuple):
    """A message on its way: its key and payload, and what its stamp tells."""

    key: str
    payload: bytes
    number: int = 0  # its sequence number; 0 to be numbered when it is sent
    time: int = 0  # of publishing, by ``CLOCK`` [ns]; 0 if it may be late
    origin: Origin | None = None
    is_bulk: bool = False  # True if small messages of other topics go first


class KeepLastSender(SendingThread[Outgoing]):
    """Waiting messages, which are sent one after another, each topic in its turn.

    ``put`` sends a message; it may take long, and must not raise.
    """

    def __init__(self, put: Callable[[Outgoing], None]) -> None:
        super().__init__("keep-last sender")
        self._put = put
        self.dropped = 0  # messages dropped to make room for newer ones of their topic, or as late
        self.dropped_of = Counter[str]()  # the same for each key
        self._waiting: dict[str, deque[Outgoing]] = {}
        self._sending = ""  # the key of the message that is being sent
        self._makes_room = False

    def add(self, message: Outgoing) -> None:
        """Queue a message; drop the oldest of its topic if there is no room."""
        with self._changed:
            self._start()
            queue = self._waiting.setdefault(message.key, deque())
            queue.append(message)
            if not self._makes_room:  # else this is a signal handler amid it
                self._make_room(message.key, queue)
            self._changed.notify_all()

    def has_waiting(self, key: str) -> bool:
        """Return whether a message of this topic waits or is being sent: none may overtake it."""
        return key in self._waiting or key == self._sending

    def await_sent(self, key: str) -> None:
        """Wait until no message of this topic waits or is being sent, or this is closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or not self.has_waiting(key))

    def _next(self) -> Outgoing | None:
        """Pop the first message of the topic that has waited longest for its turn."""
        oldest = time.clock_gettime_ns(CLOCK) - _MOST_WAITING
        while self._waiting:
            key = next(iter(self._waiting))
            queue = self._waiting.pop(key)
            message = queue.popleft()
            if queue:
                self._waiting[key] = queue
            if not message.time or message.time > oldest:
                self._sending = key
                return message
            self._drop(key)
        return None

    def _make_room(self, key: str, queue: deque[Outgoing]) -> None:
        self._makes_room = True
        try:
            while len(queue) > 1 and _has_no_room(queue):
                queue.popleft()
                self._drop(key)
        finally:
            self._makes_room = False

    def _drop(self, key: str) -> None:
        self.dropped += 1
        count(self.dropped_of, key)

    def _send_now(self, message: Outgoing) -> None:
        self._put(message)

    def _note_sent(self, message: Outgoing) -> None:  # noqa: ARG002 - only one is being sent
        self._sending = ""


def _has_no_room(queue: deque[Outgoing]) -> bool:
    """Return whether the oldest message must make room for the latest."""
    waiting = tuple(queue)  # a signal handler may publish meanwhile
    size, first, last = sum(len(one.payload) for one in waiting), waiting[0], waiting[-1]
    is_stall = first.time and last.time - first.time < _STALL
    return size > (_MOST_STALLED_BYTES if is_stall else MOST_WAITING_BYTES)
