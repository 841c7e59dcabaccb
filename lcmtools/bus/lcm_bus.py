"""The bus of nodes without multicast groups: an LCM instance, and the thread that receives.

Subscribing, unsubscribing and receiving happen on the thread that has the right to receive. It
drains the library at once into the subscribers' queues, which keep the newest messages. Publishing
and subscribing threads are serialized.
"""

import contextlib
import re
from collections.abc import Sequence

from lcmtools.bus.liblcm import QUEUE_CAPACITY, Connection, Instance, Subscription
from lcmtools.bus.receiving_bus import ReceivingBus
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError

_LENDABLE = ("mpudpm", "memq")
"""Providers whose messages any thread may wait for; others end or lose their connection."""
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
        self._connection = Connection(
            url, self._subscribe_all, lambda text, _trouble: self.on_outage(text)
        )
        self._send = self._connection.publish
        self._unsubscribes = url.provider != "mpudpm"  # see bus/liblcm
        self._longest = _CHECK_PERIOD if url.provider == "tcpq" else None
        self._start(is_lendable=url.provider in _LENDABLE)

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``."""
        super().leave_to_parent()
        self._connection.leave_to_parent()

    def _begin(self, channel: str) -> None:
        instance = self._connection.instance  # None: it follows once the connection is back
        if instance and channel not in self._subscriptions:
            self._subscribe_channel(instance, channel)

    def _end(self, channel: str) -> None:
        if not self._unsubscribes:
            return
        subscription = self._subscriptions.pop(channel, None)
        if subscription and (instance := self._connection.instance):
            with self._connection.using:
                instance.unsubscribe(subscription)

    def _subscribe_all(self, instance: Instance) -> None:
        self._subscriptions.clear()
        for channel in self._handlers:
            self._subscribe_channel(instance, channel.decode())

    def _subscribe_channel(self, instance: Instance, channel: str) -> None:
        with self._connection.using:
            subscription = instance.subscribe(re.escape(channel), self._dispatch)
        if subscription is None:
            raise BusError(f"LCM cannot subscribe to '{channel}'")
        subscription.set_queue_capacity(QUEUE_CAPACITY)
        self._subscriptions[channel] = subscription

    def _descriptors(self) -> Sequence[int]:
        instance = self._connection.instance
        return () if instance is None else (instance.fileno(),)

    def _receive(self, most: int) -> int:
        with contextlib.suppress(OSError):
            return self._connection.handle(most)
        return 0

    def _leave(self) -> None:
        self._subscriptions.clear()
        self._connection.close()  # a thread that publishes now keeps the instance a moment longer

    def _receive_on_own_thread(self) -> None:
        wake = self._right.wakeup
        if self._connection.receive(self._longest, [wake.fileno()]):
            wake.clear()
            self._serve_requests()
        if self._connection.instance is None:
            self._subscriptions.clear()
        self.on_received()
