"""The receiving half of a bus for nodes, on which each implementation of ``Bus`` is built.

Handlers run on the thread that has the right to receive (see ``bus.receive_right``): one that waits
for messages, or else the bus's own. A bus is asked only where its messages come from; how threads
take turns, forks, requests and the end are the same for all.
"""

import queue
import select
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from lcmtools.bus.base import Handler, refusal
from lcmtools.bus.receive_right import ReceiveRight
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError

BATCH = 100  # messages handled before a request is served
_FEW = 10  # messages handled before callbacks run: no more than a queue of the usual depth holds
_LONGEST_BURST = 10  # full batches in a row; if there are more, callbacks are too slow
_REQUEST_TIMEOUT = 15.0  # [s]; more than liblcm's own ten seconds


class ReceivingBus(ABC):
    """A bus with its own receiving thread, which lends the right to receive.

    An implementation opens its connection, and then calls ``_start``.
    """

    def __init__(self, url: BusUrl) -> None:
        self.url = url
        self.on_outage: Callable[[str], None] = lambda _: None
        self.on_received: Callable[[], None] = lambda: None
        self._handlers: dict[str, tuple[Handler, ...]] = {}
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._changing = threading.Lock()  # held for changes that closing must not interrupt
        self._burst = 0  # times in a row that many messages waited
        self._closed = self._is_of_parent = False

    @abstractmethod
    def _descriptors(self) -> Sequence[int]:
        """Return the descriptors of which one is readable while messages wait."""

    @abstractmethod
    def _receive(self, most: int) -> int:
        """Handle waiting messages, ``most`` at most, without waiting; return their number."""

    @abstractmethod
    def _leave(self) -> None:
        """Send waiting messages and leave the bus; the receiving thread has ended."""

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Receive on this thread until handlers were called or time is up (see ``Bus``)."""
        if self._closed or not self._right.is_lendable:
            wakeup.wait(timeout)
        elif self._right.lead():  # if not, work for this thread may just have come
            try:
                has_received = self._wait_for_messages(wakeup, timeout)
                if has_received and not self._right.is_lendable:
                    self.on_received()
            finally:
                self._right.leave()

    def hand_over(self) -> None:
        """Receive on the bus's own thread until this one waits again."""
        self._right.hand_over()

    def close(self) -> None:
        """Stop the receiving thread, send waiting messages and leave the bus."""
        with self._changing:
            if self._closed:
                return
            self._closed = True
        self._right.wake()
        self._thread.join(timeout=2.0)
        self._right.close()
        self._leave()

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``."""
        self._closed = self._is_of_parent = True

    def _start(self, *, is_lendable: bool = True) -> None:
        """Start the receiving thread; ``is_lendable`` means that other threads may receive."""
        self._right = ReceiveRight(is_lendable=is_lendable)
        self._thread = threading.Thread(target=self._run, name="bus receiver", daemon=True)
        self._thread.start()

    def _refusal(self) -> BusError:
        """Return the error for a use of a closed bus."""
        return refusal(is_of_parent=self._is_of_parent)

    def _add_handler(self, channel: str, handler: Handler) -> None:
        self._handlers[channel] = (*self._handlers.get(channel, ()), handler)

    def _remove_handler(self, channel: str, handler: Handler) -> None:
        """Remove a handler; a channel without handlers is not in ``_handlers``."""
        handlers = list(self._handlers.get(channel, ()))
        if handler in handlers:
            handlers.remove(handler)
        if handlers:
            self._handlers[channel] = tuple(handlers)
        else:
            self._handlers.pop(channel, None)

    def _dispatch(self, channel: str, payload: bytes, arrival: int | None = None) -> None:
        """Call a channel's handlers; the message arrived now unless its time is known [ns]."""
        arrival = time.time_ns() if arrival is None else arrival
        for handler in self._handlers.get(channel, ()):
            handler(payload, arrival)

    def _on_receiver(self, work: Callable[[], None]) -> None:
        """Run ``work`` on the receiving thread and wait for it; its exception is raised here."""
        if threading.get_ident() == self._right.thread:
            work()
            return
        done: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()

        def run() -> None:
            try:
                work()
                done.put(None)
            except Exception as error:  # noqa: BLE001 - raised by the requester
                done.put(error)

        with self._changing:
            if self._closed:
                raise self._refusal()
            self._requests.put(run)
            self._right.wake()
        try:
            error = done.get(timeout=_REQUEST_TIMEOUT)
        except queue.Empty:
            raise BusError("the receiving thread is stuck in a handler") from None
        if error is not None:
            raise error

    def _serve_requests(self) -> None:
        while not self._requests.empty():
            self._requests.get()()

    def _run(self) -> None:
        """Receive while no other thread does; the bus's own thread."""
        while not self._closed:
            if not self._right.follow(lambda: self._closed or not self._requests.empty()):
                with self._right:
                    if self._closed:  # the wake-up may have been meant for the previous thread
                        break
                    self._receive_on_own_thread()
        self._serve_requests()  # requests made while it closed

    def _receive_on_own_thread(self) -> None:
        """Wait once for messages or requests, and handle them."""
        if self._wait_for_messages(None, None):
            self.on_received()

    def _wait_for_messages(self, event: WakeupEvent | None, timeout: float | None) -> bool:
        """Wait for messages, requests or an event; return True if messages were handled."""
        own, event_number = self._right.wakeup, -1
        try:
            own_number = own.fileno()
            descriptors = [own_number, *self._descriptors()]
            if event is not None:
                event_number = event.fileno()
                descriptors.append(event_number)
            readable = select.select(descriptors, (), (), timeout)[0]
        except (OSError, ValueError):  # a signal handler has closed the bus
            return False
        is_own_set, is_event_set = own_number in readable, event_number in readable
        has_messages = len(readable) > is_own_set + is_event_set
        if has_messages:
            self._handle_messages()
        if is_own_set:
            own.clear()
            self._serve_requests()
        if event is not None and is_event_set:
            event.clear()
        return has_messages

    def _handle_messages(self) -> None:
        """Handle few messages at a time: callbacks run in between, and the queues do not overflow.

        If a burst does not end, the callbacks are too slow for the messages: then all waiting
        messages are handled at once, and the queues keep the newest.
        """
        handled = self._receive(_FEW if self._burst < _LONGEST_BURST else BATCH)
        self._burst = self._burst + 1 if handled >= _FEW else 0
