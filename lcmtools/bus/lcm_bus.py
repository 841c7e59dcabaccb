"""The bus of nodes: an LCM instance, and the thread that receives.

Subscribing, unsubscribing and receiving happen on the thread that has the right to receive. It
drains the library at once into the subscribers' queues, which keep the newest messages. Publishing
and subscribing threads are serialized where liblcm does not do so.
"""

import contextlib
import re
import select
import threading
import time
from collections.abc import Collection, Sequence

from lcmtools.bus.base import Handler
from lcmtools.bus.liblcm import QUEUE_CAPACITY, Connection, Instance, Subscription
from lcmtools.bus.paced import PACED_ABOVE_BYTES, PacedSender
from lcmtools.bus.receiving_bus import BATCH, ReceivingBus
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError
from lcmtools.names import check_channel, check_length, is_utf_8

_LENDABLE = ("udpm", "mpudpm", "memq")
"""Providers whose messages any thread may wait for; others end or lose their connection."""
_AT_ONCE = 0.00005  # [s] at most that a wait takes if messages have arrived before
_GAP = 5  # [ms] at most between the messages of a stream
_CHECK_PERIOD = 0.5  # [s] between checks for a connection that broke while sending


class LcmBus(ReceivingBus):
    """A connection with its own receiving thread.

    Publishing is safe from any thread. Handlers run on the receiving thread and must be quick.

    Raises:
        BusError: The bus cannot be reached; the error says what to type.
    """

    def __init__(self, url: BusUrl) -> None:
        super().__init__(url)
        self._subscriptions: dict[str, Subscription] = {}
        self._sending = threading.RLock()  # not Lock: a signal handler may publish too
        self._connection = Connection(
            url, self._subscribe_all, lambda text, _trouble: self.on_outage(text)
        )
        self._can_break = url.provider == "tcpq"
        self._broken: Instance | None = None  # the instance that broke while sending
        self._has_ended = False  # True once a log has ended
        self._is_streaming = False  # a message has come soon after the one before
        self._wait_began = 0.0  # time.monotonic() when the last wait began
        self._paced = PacedSender(url) if url.is_multicast else None
        self._start(is_lendable=url.provider in _LENDABLE)

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
        instance, paced = self._connection.instance, self._paced
        check = check_length if paced else check_channel
        check(channel)
        if instance is None:
            raise self._missing()
        is_large = len(payload) > PACED_ABOVE_BYTES
        # liblcm's Python sends on no channel that is not UTF-8
        if paced and (is_large or channel in paced.channels or not is_utf_8(channel)):
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

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``."""
        super().leave_to_parent()
        self._paced = None
        self._connection.leave_to_parent()

    def _missing(self) -> BusError:
        lost = BusError(f"the connection to {self.url} is lost")
        return self._refusal() if self._closed else lost

    def _instance(self) -> Instance:
        instance = self._connection.instance
        if instance is None or self._closed:
            raise self._missing()
        return instance

    def _subscribe(self, channel: str, handler: Handler) -> None:
        if channel not in self._subscriptions and not self._connection.is_lost:
            self._subscribe_channel(self._instance(), channel)
        self._add_handler(channel, handler)

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
        self._remove_handler(channel, handler)
        if channel not in self._handlers and channel in self._subscriptions:
            with self._sending:
                self._instance().unsubscribe(self._subscriptions.pop(channel))
            self._connection.filter.let_pass(self._subscriptions)

    def _descriptors(self) -> Sequence[int]:
        instance = self._connection.instance
        return () if instance is None else (instance.fileno(),)

    def _receive(self, most: int) -> int:
        instance = self._connection.instance
        return 0 if instance is None else self._handle(instance, most) or 0

    def _leave(self) -> None:
        if self._paced:
            self._paced.close()
        self._subscriptions.clear()
        self._connection.close()  # a thread that publishes now keeps the instance a moment longer

    def _wait_for_messages(self, event: WakeupEvent | None, timeout: float | None) -> bool:
        """Wait for messages, requests or an event; of a stream, for its next message only."""
        if self._is_streaming and self._may_wait_in_liblcm(event, timeout) and self._receive_next():
            return True
        self._wait_began = time.monotonic()
        return super()._wait_for_messages(event, timeout)

    def _may_wait_in_liblcm(self, event: WakeupEvent | None, timeout: float | None) -> bool:
        is_awake = self._right.wakeup.is_set or (event is not None and event.is_set)
        return not is_awake and (timeout is None or timeout >= _GAP / 1000)

    def _handle_messages(self) -> None:
        """Handle a single message that was waited for, without a look for more."""
        waited, instance = time.monotonic() - self._wait_began, self._connection.instance
        self._is_streaming = _AT_ONCE < waited < _GAP / 1000
        if waited > _AT_ONCE and instance is not None:
            self._burst = 0
            with contextlib.suppress(OSError):  # a signal handler has closed the bus
                instance.handle()
        else:
            super()._handle_messages()

    def _receive_next(self) -> bool:
        """Wait for the next message of a stream within liblcm, where no event can wake this thread.

        This saves one system call before the callback, an eighth of the latency between processes.
        An event waits for the next message, or for the gap that ends a stream. Returns False if no
        message came.
        """
        start = time.monotonic()
        try:
            has_come = self._instance().handle_timeout(_GAP) > 0
        except (BusError, OSError):  # a signal came; its handler runs before the next wait
            has_come = False
        self._is_streaming = has_come and time.monotonic() - start > _AT_ONCE
        return has_come

    def _receive_on_own_thread(self) -> None:
        instance = None if self._has_ended else self._connection.instance
        works, readable = self._wait(instance)
        wake = self._right.wakeup.fileno()
        if wake in readable:
            self._right.wakeup.clear()
            self._serve_requests()
        if instance is None:
            if self._connection.left() == 0.0:
                self._connection.try_again()
            return
        if works and len(readable) > readable.count(wake):
            works = self._handle(instance, BATCH) is not None
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
            wake = self._right.wakeup.fileno()
            if instance is None:
                return True, select.select([wake], [], [], self._connection.left())[0]
            longest = _CHECK_PERIOD if self._can_break else None
            return True, select.select([wake, instance.fileno()], [], [], longest)[0]
        except (OSError, ValueError):  # closed by a publishing thread when the connection broke
            return False, []

    def _handle(self, instance: Instance, most: int) -> int | None:
        """Deliver waiting messages; return their number, None at the end of a log or connection."""
        try:
            for handled in range(most):
                if self._closed or not instance.handle_timeout(0):
                    return handled
        except OSError:
            return None
        return most
