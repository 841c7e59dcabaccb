"""The bus of nodes: an LCM instance, and the thread that receives.

Subscribing, unsubscribing and receiving happen on the thread that has the right to receive. It
drains the library at once into the subscribers' queues, which keep the newest messages. Publishing
and subscribing threads are serialized where liblcm does not do so.
"""

import contextlib
import queue
import re
import select
import threading
import time
from collections.abc import Callable, Collection, Sequence

from lcmtools.bus.base import Handler, refusal
from lcmtools.bus.liblcm import QUEUE_CAPACITY, Connection, Instance, Subscription
from lcmtools.bus.paced import PACED_ABOVE_BYTES, PacedSender
from lcmtools.bus.receiving import Receiving
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError
from lcmtools.names import check_channel

_LENDABLE = ("udpm", "mpudpm", "memq")
"""Providers whose messages any thread may wait for; others end or lose their connection."""
_BATCH = 100  # messages handled before a request to subscribe is served
_FEW = 10  # messages handled before callbacks run: no more than a queue of the usual depth holds
_AT_ONCE = 0.00005  # [s] at most that a wait takes if messages have arrived before
_GAP = 5  # [ms] at most between the messages of a stream
_LONGEST_BURST = 10  # full batches in a row; if there are more, callbacks are too slow
_CHECK_PERIOD = 0.5  # [s] between checks for a connection that broke while sending
_REQUEST_TIMEOUT = 15.0  # [s]; more than liblcm's own ten seconds


class LcmBus:
    """A connection with its own receiving thread.

    Publishing is safe from any thread. Handlers run on the receiving thread and must be quick.

    Raises:
        BusError: The bus cannot be reached; the error says what to type.
    """

    def __init__(self, url: BusUrl) -> None:
        self.url = url
        self.on_outage: Callable[[str], None] = lambda _: None
        self.on_received: Callable[[], None] = lambda: None
        self._handlers: dict[str, tuple[Handler, ...]] = {}
        self._subscriptions: dict[str, Subscription] = {}
        self._sending = threading.RLock()  # not Lock: a signal handler may publish too
        self._connection = Connection(
            url, self._subscribe_all, lambda text, _trouble: self.on_outage(text)
        )
        self._can_break = url.provider == "tcpq"
        self._broken: Instance | None = None  # the instance that broke while sending
        self._has_ended = False  # True once a log has ended
        self._is_streaming = False  # a message has come soon after the one before
        self._burst = 0  # times in a row that many messages waited
        self._paced = PacedSender(url) if url.is_multicast else None
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._requesting = threading.Lock()
        self._receiving = Receiving(is_lendable=url.provider in _LENDABLE)
        self._closed = self._is_of_parent = False
        self._thread = threading.Thread(target=self._run, name="lcm receiver", daemon=True)
        self._thread.start()

    @property
    def ports(self) -> list[int]:
        """The UDP ports that this instance sends from, except LCM's own (for large messages)."""
        return [self._paced.port] if self._paced else []

    def publish(
        self,
        channel: str,
        payload: bytes,
        type_name: str = "",  # noqa: ARG002 - for ``Bus``: LCM's channels name no type
        *,
        latched: bool = False,  # noqa: ARG002 - nor do they mark messages that may be late
    ) -> None:
        """Send one message; a large one goes out as paced fragments, after this returns.

        Raises:
            BusError: It cannot be sent.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        instance, paced = self._connection.instance, self._paced
        if instance is None:
            raise self._missing()
        if paced and (len(payload) > PACED_ABOVE_BYTES or channel in paced.channels):
            paced.send(channel, payload)
            return
        try:
            if paced:  # liblcm locks itself when it sends datagrams
                instance.publish(channel, payload)
            else:
                with self._sending:
                    instance.publish(channel, payload)
        except OSError as error:
            self._broken = instance
            raise BusError(f"cannot publish on {channel}: {error.strerror or error}") from error

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send those of these messages that cost less if sent together (see ``Bus``)."""
        return self._paced.send_together(messages) if self._paced else range(len(messages))

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler`` for each message on this channel.

        Raises:
            BusError: The subscription cannot be made.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        self._on_receiver(lambda: self._subscribe(channel, handler))

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        with contextlib.suppress(BusError):  # a closed bus delivers nothing anyway
            self._on_receiver(lambda: self._unsubscribe(channel, handler))

    def close(self) -> None:
        """Send waiting messages, stop the receiving thread and leave the bus."""
        with self._requesting:
            if self._closed:
                return
            self._closed = True
        if self._paced:
            self._paced.close()
        self._receiving.wake()
        self._thread.join(timeout=2.0)
        self._receiving.close()
        self._subscriptions.clear()
        self._connection.close()  # a thread that publishes now keeps the instance a moment longer

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``."""
        self._closed = self._is_of_parent = True
        self._paced = None
        self._connection.leave_to_parent()

    def _missing(self) -> BusError:
        """Return the error for a bus without an instance."""
        if self._closed:
            return refusal(is_of_parent=self._is_of_parent)
        return BusError(f"the connection to {self.url} is lost")

    def _instance(self) -> Instance:
        instance = self._connection.instance
        if instance is None or self._closed:
            raise self._missing()
        return instance

    def _on_receiver(self, work: Callable[[], None]) -> None:
        """Run ``work`` on the receiving thread and wait for it; its exception is raised here."""
        if threading.get_ident() == self._receiving.thread:
            work()
            return
        done: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()

        def run() -> None:
            try:
                work()
                done.put(None)
            except Exception as error:  # noqa: BLE001 - raised by the requester
                done.put(error)

        with self._requesting:
            if self._closed:
                raise self._missing()
            self._requests.put(run)
            self._receiving.wake()
        try:
            error = done.get(timeout=_REQUEST_TIMEOUT)
        except queue.Empty:
            raise BusError("the receiving thread is stuck in a handler") from None
        if error is not None:
            raise error

    def _subscribe(self, channel: str, handler: Handler) -> None:
        if channel not in self._subscriptions and not self._connection.is_lost:
            self._subscribe_channel(self._instance(), channel)
        self._handlers[channel] = (*self._handlers.get(channel, ()), handler)

    def _subscribe_all(self, instance: Instance) -> None:
        self._subscriptions.clear()
        for channel in self._handlers:
            self._subscribe_channel(instance, channel)

    def _subscribe_channel(self, instance: Instance, channel: str) -> None:
        if not self._connection.filter.passes(channel):
            self._connection.filter.let_pass({*self._subscriptions, channel})
        with self._sending:
            subscription = instance.subscribe(re.escape(channel), self._dispatch)
        if subscription is None:
            raise BusError(f"LCM cannot subscribe to '{channel}'")
        subscription.set_queue_capacity(QUEUE_CAPACITY)
        self._subscriptions[channel] = subscription

    def _unsubscribe(self, channel: str, handler: Handler) -> None:
        handlers = list(self._handlers.pop(channel, ()))
        if handler in handlers:
            handlers.remove(handler)
        if handlers:
            self._handlers[channel] = tuple(handlers)
        elif channel in self._subscriptions:
            with self._sending:
                self._instance().unsubscribe(self._subscriptions.pop(channel))
            self._connection.filter.let_pass(self._subscriptions)

    def _dispatch(self, channel: str, payload: bytes) -> None:
        now = time.time_ns()
        for handler in self._handlers.get(channel, ()):
            handler(payload, now)

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Receive on this thread until handlers were called or time is up (see ``Bus``)."""
        if self._closed or not self._receiving.is_lendable:
            wakeup.wait(timeout)
        elif self._receiving.lead():  # if not, work for this thread may just have come
            try:
                self._receive(wakeup, timeout)
            except (BusError, OSError, ValueError):  # a signal handler has closed the bus
                pass
            finally:
                self._receiving.leave()

    def hand_over(self) -> None:
        """Receive on the bus's own thread until this one waits again."""
        self._receiving.hand_over()

    def _receive(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Wait for messages, requests or an event."""
        instance, own = self._instance(), self._receiving.wakeup
        is_awake = wakeup.is_set or own.is_set or (timeout is not None and timeout < _GAP / 1000)
        if self._is_streaming and not is_awake and self._receive_next(instance):
            if not self._receiving.is_lendable:
                self.on_received()
            return
        event, wake, messages = wakeup.fileno(), own.fileno(), instance.fileno()
        start = time.monotonic()
        readable = select.select([event, wake, messages], [], [], timeout)[0]
        if messages in readable:
            waited = time.monotonic() - start
            self._is_streaming = _AT_ONCE < waited < _GAP / 1000
            if waited > _AT_ONCE:  # a single new message: no need to look for more
                instance.handle()
                self._burst = 0
            else:
                self._handle_burst(instance)
            if not self._receiving.is_lendable:
                self.on_received()
        if wake in readable:
            own.clear()
            self._serve_requests()
        if event in readable:
            wakeup.clear()

    def _receive_next(self, instance: Instance) -> bool:
        """Wait for the next message of a stream within liblcm, where no event can wake this thread.

        This saves one system call before the callback, an eighth of the latency between processes.
        An event waits for the next message, or for the gap that ends a stream. Returns False if no
        message came.
        """
        start = time.monotonic()
        try:
            has_come = instance.handle_timeout(_GAP) > 0
        except OSError:  # a signal came; its handler runs before the next wait
            has_come = False
        self._is_streaming = has_come and time.monotonic() - start > _AT_ONCE
        return has_come

    def _handle_burst(self, instance: Instance) -> None:
        """Deliver few messages at a time: callbacks run in between, and the queues do not overflow.

        If a burst does not end, the callbacks are too slow for the messages: then all waiting
        messages are delivered at once, and the queues keep the newest.
        """
        handled = self._handle(instance, _FEW if self._burst < _LONGEST_BURST else _BATCH)
        self._burst = self._burst + 1 if handled and handled >= _FEW else 0

    def _run(self) -> None:
        """Receive while no other thread does; the bus's own thread."""
        while not self._closed:
            if not self._receiving.follow(lambda: self._closed or not self._requests.empty()):
                with self._receiving:
                    if self._closed:  # the wake-up may have been meant for the previous thread
                        break
                    self._turn(None if self._has_ended else self._connection.instance)
        self._serve_requests()  # requests made while it closed

    def _turn(self, instance: Instance | None) -> None:
        """Wait for messages, requests and attempts to connect, and handle them."""
        works, readable = self._wait(instance)
        wake = self._receiving.wakeup.fileno()
        if wake in readable:
            self._receiving.wakeup.clear()
            self._serve_requests()
        if instance is None:
            if self._connection.left() == 0.0:
                self._connection.try_again()
            return
        if works and len(readable) > readable.count(wake):
            works = self._handle(instance, _BATCH) is not None
            self.on_received()
        if works and not (self._can_break and self._broken is instance):
            return
        if not self._can_break:
            self._has_ended = True  # requests are still served
        elif not self._closed:
            with self._sending:
                self._subscriptions.clear()
            self._broken = None
            self._connection.lose()

    def _wait(self, instance: Instance | None) -> tuple[bool, list[int]]:
        """Return whether the connection works, and the readable descriptors."""
        try:
            wake = self._receiving.wakeup.fileno()
            if instance is None:
                return True, select.select([wake], [], [], self._connection.left())[0]
            longest = _CHECK_PERIOD if self._can_break else None
            return True, select.select([wake, instance.fileno()], [], [], longest)[0]
        except (OSError, ValueError):  # closed by a publishing thread when the connection broke
            return False, []

    def _serve_requests(self) -> None:
        while not self._requests.empty():
            self._requests.get()()

    def _handle(self, instance: Instance, most: int) -> int | None:
        """Deliver waiting messages; return their number, None at the end of a log or connection."""
        try:
            for handled in range(most):
                if self._closed or not instance.handle_timeout(0):
                    return handled
        except OSError:
            return None
        return most
