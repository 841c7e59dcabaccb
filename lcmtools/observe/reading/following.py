"""Whole messages of some channels, while a monitor reads only the heads of all.

The channels may change at any time. On a multicast bus each is subscribed to; on others the monitor
has whole messages. A view to which any message may be of interest later reads all large ones.
"""

import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TypeAlias

from lcmtools.bus.base import Bus, Handler
from lcmtools.bus.open import open_bus
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.observe.reading.large_messages import LargeMessages
from lcmtools.wire.packet import Packet

Receiver: TypeAlias = Callable[[Packet], None]  # called with each message, on another thread


class Following:
    """The followed channels of a bus, and the callbacks that receive their messages.

    With ``keep``, it gets all large messages of the bus, but for streams that nobody follows.
    """

    def __init__(self, url: BusUrl, keep: Receiver | None = None) -> None:
        self._url, self._keep = url, keep
        self._lock = threading.Lock()
        self._receivers: dict[str, tuple[Receiver, ...]] = {}
        self._bus: Bus | None = None  # opened for the first channel
        self._handlers: dict[str, Handler] = {}  # of the channels that are subscribed to
        self._heard: set[str] = set()  # followed channels that have had a message
        self._large: set[str] = set()  # those of which the monitor reads only the heads
        self._all: LargeMessages | None = None
        if keep and url.is_multicast:
            self._all = LargeMessages(url, self._take_large, self._awaits_large)

    @property
    def channels(self) -> list[str]:
        """The channels, sorted."""
        with self._lock:
            return sorted(self._receivers)

    def add(self, channel: str, receive: Receiver) -> Callable[[], None]:
        """Pass a channel's whole messages on from now; return a call to end it."""
        if self._all:
            self._all.wait()
        with self._lock:
            self._receivers[channel] = (*self._receivers.get(channel, ()), receive)
        if self._url.is_multicast and self._all is None and channel not in self._handlers:
            with suppress(BusError):  # the monitor reports what is wrong with the network
                self._subscribe(channel)
        return partial(self._remove, channel, receive)

    def pass_on(self, packet: Packet) -> None:
        """Pass on a packet that the monitor has read."""
        receivers = self._receivers.get(packet.channel)
        if receivers and packet.channel not in self._handlers:
            self._heard.add(packet.channel)
            if packet.whole_bytes is None:
                _give(packet, receivers)
            else:
                self._large.add(packet.channel)

    def close(self) -> None:
        """Stop passing packets on."""
        with self._lock:
            self._receivers.clear()
        if self._bus:
            self._bus.close()
        if self._all:
            self._all.close()

    def _remove(self, channel: str, receive: Receiver) -> None:
        with self._lock:
            receivers = list(self._receivers.get(channel, ()))
            if receive not in receivers:
                return
            receivers.remove(receive)
            self._receivers[channel] = tuple(receivers)
            if receivers:
                return
            del self._receivers[channel]
            self._heard.discard(channel)
            self._large.discard(channel)  # it may be small when it is followed again
            handler = self._handlers.pop(channel, None)
        if self._bus and handler:
            self._bus.unsubscribe(channel, handler)

    def _subscribe(self, channel: str) -> None:
        def take(payload: bytes, time: int) -> None:
            _give(Packet(channel, payload, time), self._receivers.get(channel, ()))

        self._bus = self._bus or open_bus(self._url)
        self._bus.subscribe(channel, take, is_large=True)
        self._handlers[channel] = take

    def _take_large(self, packet: Packet) -> None:
        if self._keep:
            self._keep(packet)
        _give(packet, self._receivers.get(packet.channel, ()))

    def _awaits_large(self) -> bool:
        """Return True while a followed channel has large messages, or its first may be large."""
        with self._lock:
            return any(one in self._large or one not in self._heard for one in self._receivers)


def _give(packet: Packet, receivers: tuple[Receiver, ...]) -> None:
    for receive in receivers:
        receive(packet)
