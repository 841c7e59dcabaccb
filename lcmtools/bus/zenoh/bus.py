"""The bus of nodes on Zenoh: calling handlers for the messages that a session receives.

Zenoh's own threads queue messages; a thread that waits for messages, or else the bus's own thread,
calls the handlers (see ``bus.receiving``).
"""

import contextlib
import select
import threading
from collections.abc import Callable, Collection, Sequence

from lcmtools.bus.base import Handler, refusal
from lcmtools.bus.receiving import Receiving
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.bus.zenoh.session import ZenohSession
from lcmtools.names import check_channel

_FEW, _BATCH = 10, 100  # messages handled before callbacks run; the same if these are too slow
_LONGEST_BURST = 10  # full batches in a row, after which callbacks count as too slow


class ZenohBus:
    """A Zenoh session with its own receiving thread; see ``Bus``.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
        MissingExtra: Zenoh is not installed.
    """

    ports: list[int] = []  # noqa: RUF012 - none: see ``Bus``

    def __init__(self, url: BusUrl) -> None:
        self.url = url
        self.on_outage: Callable[[str], None] = lambda _: None
        self.on_received: Callable[[], None] = lambda: None
        self._handlers: dict[str, list[Handler]] = {}
        self._changing = threading.Lock()
        self._burst = 0
        self._closed = self._is_of_parent = False
        self._session = ZenohSession(url, lambda text, _trouble: self.on_outage(text))
        self._receiving = Receiving(is_lendable=True)
        self._thread = threading.Thread(target=self._run, name="zenoh receiver", daemon=True)
        self._thread.start()

    def publish(
        self, channel: str, payload: bytes, type_name: str = "", *, latched: bool = False
    ) -> None:
        """Send one message; see ``Bus.publish``.

        Raises:
            BusError: The bus is closed.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        if self._closed:
            raise refusal(is_of_parent=self._is_of_parent)
        self._session.publish(channel, payload, type_name, latched=latched)

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send none together (see ``Bus``)."""
        return range(len(messages))

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler`` for each message on this channel.

        Raises:
            BusError: The bus is closed.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        with self._changing:
            if self._closed:
                raise refusal(is_of_parent=self._is_of_parent)
            handlers = self._handlers.setdefault(channel, [])
            handlers.append(handler)
            if len(handlers) == 1:
                self._session.subscribe(channel)

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        with self._changing:
            handlers = self._handlers.get(channel, [])
            if handler in handlers:
                handlers.remove(handler)
                if not handlers and not self._closed:
                    self._session.unsubscribe(channel)

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Receive on this thread until handlers were called or time is up (see ``Bus``)."""
        if self._closed or not self._receiving.is_lendable:
            wakeup.wait(timeout)
        elif self._receiving.lead():  # if not, work for this thread may just have come
            try:
                self._receive([wakeup, self._receiving.wakeup], timeout)
                if not self._receiving.is_lendable:
                    self.on_received()
            finally:
                self._receiving.leave()

    def hand_over(self) -> None:
        """Receive on the bus's own thread until this one waits again."""
        self._receiving.hand_over()

    def close(self) -> None:
        """Stop the receiving thread and leave the bus."""
        with self._changing:
            if self._closed:
                return
            self._closed = True
        self._receiving.wake()
        self._thread.join(timeout=2.0)
        self._receiving.close()
        self._session.close()

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``. The session handles forks itself."""
        self._closed = self._is_of_parent = True

    def _run(self) -> None:
        """Receive while no other thread does; the bus's own thread."""
        while not self._closed:
            if not self._receiving.follow(lambda: self._closed):
                with self._receiving:
                    if self._closed:  # the wake-up may have been meant for the previous thread
                        break
                    self._receive([self._receiving.wakeup], None)
                    self.on_received()

    def _receive(self, wakeups: Sequence[WakeupEvent], timeout: float | None) -> None:
        """Wait for messages or events."""
        messages, events = self._session.fileno(), {}
        readable: list[int] = []
        with contextlib.suppress(OSError, ValueError):  # a signal handler has closed the bus
            events = {one.fileno(): one for one in wakeups}
            readable = select.select([*events, messages], [], [], timeout)[0]
        if messages in readable:
            self._deliver()
        for descriptor in events.keys() & readable:
            events[descriptor].clear()

    def _deliver(self) -> None:
        """Deliver few messages at a time: callbacks run in between, and the queues do not overflow.

        If a burst does not end, the callbacks are too slow for the messages: then all waiting
        messages are delivered at once, and the queues keep the newest.
        """
        packets = self._session.take(_FEW if self._burst < _LONGEST_BURST else _BATCH)
        self._burst = self._burst + 1 if len(packets) >= _FEW else 0
        for packet in packets:
            for handler in tuple(self._handlers.get(packet.channel, ())):
                handler(packet.payload, packet.time)
