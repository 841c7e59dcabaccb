"""Subscriptions: a queue that keeps the newest messages, and a callback."""

import threading
import time as clock
from collections import deque
from collections.abc import Callable
from threading import get_ident
from typing import NamedTuple

from lcmtools.graph.model import Endpoint, Role
from lcmtools.messages.codec import PayloadDecoder
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.node.stopwatch import Stopwatch

_LATE = (
    1_000_000  # [ns]: a message that has waited longer is one of many, of which the newest count
)
_WARNING_PERIOD = 5.0  # [s] between two warnings about messages that cannot be read


class Losses(NamedTuple):
    """The messages that a subscription has lost, as far as that can be known.

    Short messages that are lost on the network leave no trace here, because the kernel hides those
    of other channels, and with them the gaps in a sender's numbers: ``lcmtools hz`` shows them.
    """

    displaced: int  # messages that newer ones have displaced from its queue
    incomplete: int  # large messages of which parts did not arrive
    # Datagrams that full receive buffers of this process have lost, at most, on any of its topics:
    # the kernel counts them together with those that its filters drop meanwhile.
    overflows: int


class Turn:
    """A thread's wait for messages: while it lasts, callbacks may run where messages are received.

    Attributes:
        thread: The thread that waits; 0 while callbacks run.
        has_run: True if a callback has run since it was cleared.
    """

    __slots__ = ("has_run", "thread")

    def __init__(self) -> None:
        self.thread, self.has_run = 0, False


NO_TURN = Turn()
"""The wait of nobody."""


class Waiting:
    """The callbacks of a node that wait.

    Attributes:
        ready: Their calls, in order of arrival.
        turn: The wait of the thread that runs them.
    """

    def __init__(self) -> None:
        self.ready: deque[Callable[[], None]] = deque()
        self.turn = NO_TURN


class Subscription:
    """Receives messages from one topic. Made by ``Node.create_subscription``.

    If the callback is too slow for the messages, the newest ``depth`` of them are kept (LCM
    itself keeps the oldest), and the others are counted in ``drops``.

    Attributes:
        topic: The resolved topic, which is the LCM channel.
        message_types: The classes it accepts, the declared one first.
        depth: The largest number of waiting messages.
        group: Subscriptions of a node with the same group are alternatives to each other.
        drops: The number of messages that newer ones have displaced.
        decode: Returns the message in a payload.
        stopwatch: Measures the time of decoding and of the callback.
    """

    def __init__(
        self,
        message_types: tuple[type[Message], ...],
        topic: str,
        callback: Callable[[Message], object],
        depth: int,
        group: str = "",
    ) -> None:
        self.topic = topic
        self.message_types = message_types
        self.depth = max(1, depth)
        self.group = group
        self.drops = 0
        self.stopwatch = Stopwatch()
        self.callback = callback
        self.on_ready: Callable[[], None] = lambda: None
        self.run: Callable[[bytes], object] = lambda _: None
        """Runs the callback for a payload."""
        self.callbacks = Waiting()
        """The callbacks that wait with this one."""
        self.decode = PayloadDecoder(message_types).decode
        self._lock = threading.Lock()
        self._queue: deque[bytes] = deque(maxlen=self.depth)
        self._closed = False
        self._messages = 0
        self._bytes = 0
        self._last_time = 0
        self._next_warning = 0.0
        self.lost_by_bus: Callable[[], tuple[int, int]] = lambda: (0, 0)
        """Returns the two other numbers of ``losses``."""

    def losses(self) -> Losses:
        """Return the messages lost so far."""
        return Losses(self.drops, *self.lost_by_bus())

    def receive(self, payload: bytes, time: int) -> None:
        """Run the callback at once, if its thread waits for it; else queue the message.

        Called on the receiving thread. A message that others wait before, or that has waited in the
        kernel, is queued: the callback may be too slow for all of them.
        """
        if self._closed:
            return
        self._messages += 1
        self._bytes += len(payload)
        self._last_time = time
        waiting = self.callbacks
        is_awaited = waiting.turn.thread == get_ident() and not waiting.ready
        if is_awaited and clock.time_ns() - time < _LATE:
            self.run(payload)
            return
        with self._lock:
            if self._closed:
                return
            if len(self._queue) < self.depth:
                self.on_ready()
            else:  # ``on_ready`` was called for the message that the new one displaces
                self.drops += 1
            self._queue.append(payload)

    def pop(self) -> bytes | None:
        """Return the oldest waiting payload; None if there is none."""
        with self._lock:
            return self._queue.popleft() if self._queue else None

    def close(self) -> None:
        """Drop waiting messages, and accept no more."""
        with self._lock:
            self._closed = True
            self._queue.clear()

    def is_warning_due(self, now: float) -> bool:
        """Return whether to log a bad message at ``now`` [s]: at most once in 5 s."""
        if now < self._next_warning:
            return False
        self._next_warning = now + _WARNING_PERIOD
        return True

    def endpoint(self) -> Endpoint:
        """Return the announced description."""
        return Endpoint(
            topic=self.topic,
            role=Role.SUBSCRIBER,
            types=tuple(type_name(kind) for kind in self.message_types),
            fingerprints=tuple(fingerprint(kind) for kind in self.message_types),
            group=self.group,
            depth=self.depth,
            messages=self._messages,
            bytes=self._bytes,
            drops=self.drops,
            incomplete=self.lost_by_bus()[0],
            last_time=self._last_time,
            calls=self.stopwatch.calls,
            busy=self.stopwatch.busy(),
            longest=self.stopwatch.longest(),
        )
