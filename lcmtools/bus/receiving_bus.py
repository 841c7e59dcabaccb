"""The base of each ``Bus``: subscriptions, and threads that take turns to receive.

Handlers run on the thread that has the right to receive (see ``bus.receive_right``): one that waits
for messages, or else the bus's own. An implementation only sends, begins and ends to receive a
channel, and tells where messages wait; forks, requests and the end are the same for all.
"""

import contextlib
import queue
import threading
import time
from abc import abstractmethod
from collections.abc import Callable, Sequence

from lcmtools.bus.base import Bus, Faults, Handler, refusal, start_thread
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.receive_right import ReceiveRight
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent, wait_readable
from lcmtools.errors import BusError
from lcmtools.names import check_channel, check_length

BATCH = 100  # messages handled before a request is served
_FEW = 10  # messages handled before callbacks run: no more than a queue of the usual depth holds
_LONGEST_BURST = 10  # full batches in a row; if there are more, callbacks are too slow
_PAUSE = 0.1  # [s] after a fault of the system, which may last
_REQUEST_TIMEOUT = 15.0  # [s]; more than liblcm's own ten seconds


class ReceivingBus(Bus):
    """A bus with its own receiving thread, which lends the right to receive; see ``Bus``.

    An implementation opens its connection, and then calls ``_start``.
    """

    _send: Callable[[str, bytes], None]
    """Sends one message, on any thread; raises OSError if the system does not."""

    def __init__(self, url: BusUrl) -> None:
        super().__init__()
        self.url = url
        self._handlers: dict[bytes, tuple[Handler, ...]] = {}  # by encoded channel
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._changing = threading.Lock()  # held for changes that closing must not interrupt
        self._faults = Faults(lambda text: self.on_outage(text))  # noqa: PLW0108 - it may change
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

    def _has_read(self) -> bool:
        """Return whether messages wait that no descriptor tells of."""
        return False

    def _prepare(self) -> None:
        """Prepare for bursts, on its own thread, once another thread receives for the first time.

        In the first burst it would be too late: each system call may wait for a callback's thread.
        """

    @abstractmethod
    def _begin(self, channel: str) -> None:
        """Begin to receive a channel, on the receiving thread."""

    @abstractmethod
    def _end(self, channel: str) -> None:
        """Receive a channel no more, on the receiving thread."""

    def publish(
        self,
        channel: str,
        payload: bytes,
        type_name: str = "",  # noqa: ARG002 - for ``Bus``: LCM's channels name no type
        *,
        latched: bool = False,  # noqa: ARG002 - nor do they mark messages that may be late
    ) -> None:
        """Send one message; raises BusError, and InvalidName for what LCM cannot carry."""
        check_length(channel)
        if self._closed:
            raise self._refusal()
        try:
            self._send(channel, payload)
        except OSError as error:
            if self._closed:  # meanwhile
                raise self._refusal() from None
            raise BusError(f"cannot publish on {channel}: {error.strerror or error}") from error

    def subscribe(self, channel: str, handler: Handler, *, is_large: bool = False) -> None:
        """Call ``handler`` for each message (see ``Bus``)."""
        check_channel(channel)
        self._on_receiver(lambda: self._subscribe(channel, handler, is_large=is_large))

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        with contextlib.suppress(BusError):  # a closed bus delivers nothing anyway
            self._on_receiver(lambda: self._unsubscribe(channel, handler))

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Receive on this thread until handlers were called or time is up (see ``Bus``)."""
        right = self._right
        before = right.come() if right.is_lendable and not self._closed else 0
        if not before:
            wakeup.wait(timeout)
            return
        try:
            if self._wait_for_messages(wakeup, timeout) and not right.is_lendable:
                self.on_received()
        except OSError:
            if not self._closed:  # else a signal handler has closed it while this received
                raise
        finally:
            right.leave(before)

    def hand_over(self) -> None:
        """Receive on the bus's own thread until this one waits again."""
        self._right.hand_over()

    def close(self) -> None:
        """Stop the receiving thread, send waiting messages and leave the bus."""
        with self._changing:
            if self._closed:
                return
            self._closed = self._right.is_closed = True
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
        try:
            self._thread = start_thread(self._run, "bus receiver")
        except BusError:
            self._right.close()
            self._leave()
            raise

    def _refusal(self) -> BusError:
        """Return the error for a use of a closed bus."""
        return refusal(is_of_parent=self._is_of_parent)

    def _subscribe(self, channel: str, handler: Handler, *, is_large: bool = False) -> None:  # noqa: ARG002 - for ``UdpBus``
        name = channel.encode()
        known = self._handlers.get(name, ())
        self._handlers[name] = (*known, handler)
        if not known:
            try:
                self._begin(channel)
            except BusError:
                del self._handlers[name]
                raise

    def _unsubscribe(self, channel: str, handler: Handler) -> None:
        name = channel.encode()
        left = list(self._handlers.get(name, ()))
        with contextlib.suppress(ValueError):  # it is unknown
            left.remove(handler)
        if left:
            self._handlers[name] = tuple(left)
        elif self._handlers.pop(name, None):
            self._end(channel)

    def _dispatch(self, channel: str, payload: bytes, arrival: int | None = None) -> None:
        """Call a channel's handlers; the message arrived now unless its time is known [ns]."""
        self._handle(encoded(channel), payload, time.time_ns() if arrival is None else arrival)

    def _handle(self, name: bytes, payload: bytes, arrival: int) -> None:
        """Call an encoded channel's handlers; what one raises costs it this message only."""
        for handler in self._handlers.get(name, ()):
            try:
                handler(payload, arrival)
            except Exception as error:  # noqa: BLE001, PERF203 - others receive it all the same
                self._note_fault(name, error)

    def _note_fault(self, name: bytes, error: Exception) -> None:
        self._faults.note(f"receiving from {name.decode(errors='replace')}", error)

    def _on_receiver(self, work: Callable[[], None]) -> None:
        """Run ``work`` on the receiving thread and wait for it; its exception is raised here."""
        if self._is_done_here(work):
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

    def _is_done_here(self, work: Callable[[], None]) -> bool:
        """Run ``work`` if the calling thread receives; return False if it does not."""
        right, thread = self._right, threading.get_ident()
        if thread == right.own:
            work()
            return True
        may_come = right.leader == thread or (right.latest == thread and right.is_lendable)
        before = right.come() if may_come and not self._closed else 0
        if not before:
            return False
        try:
            work()
        finally:
            right.leave(before)
        return True

    def _serve_requests(self) -> None:
        while not self._requests.empty():
            self._requests.get()()

    def _run(self) -> None:
        """Receive while no other thread does; the bus's own thread."""
        right, is_prepared = self._right, False
        right.own = threading.get_ident()
        while not self._closed:
            if right.latest and not is_prepared:
                self._prepare()
                is_prepared = True
            right.follow(lambda: not self._requests.empty())
            with right:
                while right.is_own_turn and not self._closed:
                    self._receive_safely()
        self._serve_requests()  # requests made while it closed

    def _receive_safely(self) -> None:
        try:
            self._receive_on_own_thread()
        except Exception as error:  # noqa: BLE001 - a node must not be deaf from now on
            if not self._closed:  # else closing did not wait any longer for this turn
                self._faults.note("receiving", error)
                time.sleep(_PAUSE)

    def _receive_on_own_thread(self) -> None:
        """Wait once for messages or requests, and handle them."""
        if self._wait_for_messages(None, None):
            self.on_received()

    def _wait_for_messages(self, event: WakeupEvent | None, timeout: float | None) -> bool:
        """Wait for messages, requests or an event; return True if messages were handled."""
        own, network = self._right.wakeup, network_watch.descriptors
        try:
            wakes = [own.fileno(), *network]
            if event is not None:
                wakes.append(event.fileno())
            longest = 0.0 if self._has_read() else network_watch.longest_wait(timeout)
            readable = wait_readable([*wakes, *self._descriptors()], longest)
        except (OSError, ValueError):  # a signal handler has closed the bus
            return False
        has_messages = self._has_read() or not set(readable).issubset(wakes)
        if has_messages:
            self._handle_messages()
        if wakes[0] in readable:
            own.clear()
            self._serve_requests()
        if event is not None and wakes[-1] in readable:
            event.clear()
        if not network or network[0] in readable:
            network_watch.look()
        return has_messages

    def _handle_messages(self) -> None:
        """Handle few messages at a time: callbacks run in between, and the queues do not overflow.

        If a burst does not end, the callbacks are too slow for the messages: then all waiting
        messages are handled at once, and the queues keep the newest.
        """
        handled = self._receive(_FEW if self._burst < _LONGEST_BURST else BATCH)
        self._burst = self._burst + 1 if handled >= _FEW else 0


def encoded(channel: str) -> bytes:
    """Return a channel as it is on the wire."""
    return channel.encode("utf-8", "surrogateescape")
