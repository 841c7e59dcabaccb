"""Whole messages of some channels, while a monitor reads only the heads of all.

The channels may change at any time. Small messages come from the monitor; large ones, of which it
reads only the beginning, from a single tap, which exists while some are wanted. A view to which any
message may be of interest later reads all of them.
"""

import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TypeAlias

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.observe.reading.large_messages import LargeMessages
from lcmtools.wire.packet import Packet

Receiver: TypeAlias = Callable[[Packet], None]  # called with each message, on another thread

_TURN = 0.1  # [s] at most until a change of the channels takes effect
_AGAIN = 0.5  # [s] before a failed network is tried again


class Following:
    """The followed channels of a bus, and the callbacks that receive their messages.

    With ``keep``, it gets all large messages of the bus, but for streams that nobody follows.
    """

    def __init__(self, url: BusUrl, keep: Receiver | None = None) -> None:
        self._url = url
        self._lock = threading.Lock()
        self._receivers: dict[str, tuple[Receiver, ...]] = {}
        self._large: set[str] = set()  # channels of which the monitor reads only the heads
        self._thread: threading.Thread | None = None
        self._keep = keep
        self._heard: set[str] = set()  # followed channels that have had a message
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
            self._attend_large()
        return partial(self._remove, channel, receive)

    def pass_on(self, packet: Packet) -> None:
        """Pass on a packet that the monitor has read."""
        receivers = self._receivers.get(packet.channel)
        if not receivers:
            return
        self._heard.add(packet.channel)
        if packet.channel in self._large and not self._all:
            return
        if packet.whole_bytes is None:
            _give(packet, receivers)
            return
        with self._lock:
            self._large.add(packet.channel)
            self._attend_large()

    def close(self) -> None:
        """Stop passing packets on."""
        with self._lock:
            self._receivers.clear()
            thread = self._thread
        if thread:
            thread.join(2.0)
        if self._all:
            self._all.close()

    def _remove(self, channel: str, receive: Receiver) -> None:
        with self._lock:
            receivers = list(self._receivers.get(channel, ()))
            if receive in receivers:
                receivers.remove(receive)
            self._receivers[channel] = tuple(receivers)
            if not receivers:
                del self._receivers[channel]
                self._large.discard(channel)  # it may be small when it is followed again
                self._heard.discard(channel)

    def _attend_large(self) -> None:
        if self._thread is None and self._all is None and self._wanted():
            self._thread = threading.Thread(target=self._read_large, name="large messages")
            self._thread.daemon = True
            self._thread.start()

    def _take_large(self, packet: Packet) -> None:
        if self._keep:
            self._keep(packet)
        _give(packet, self._receivers.get(packet.channel, ()))

    def _awaits_large(self) -> bool:
        """Return True while a followed channel has large messages, or its first may be large."""
        with self._lock:
            return bool(self._wanted()) or not self._receivers.keys() <= self._heard

    def _wanted(self) -> tuple[str, ...]:
        return tuple(sorted(self._large & self._receivers.keys()))

    def _read_large(self) -> None:
        pause = threading.Event()
        while self._goes_on():
            with suppress(BusError, OSError):  # the monitor reports what is wrong with the network
                self._read_while_wanted()
                continue
            pause.wait(_AGAIN)

    def _goes_on(self) -> bool:
        with self._lock:
            if self._wanted():
                return True
            self._thread = None
            return False

    def _read_while_wanted(self) -> None:
        with self._lock:
            wanted = self._wanted()
        with Tap(self._url, always_whole=wanted) as tap:
            while wanted:
                for packet in tap.receive(_TURN):
                    if packet.channel in wanted:  # others only begin with a wanted one's name
                        _give(packet, self._receivers.get(packet.channel, ()))
                with self._lock:
                    before, wanted = wanted, self._wanted()
                if wanted != before:
                    tap.want_whole(wanted)


def _give(packet: Packet, receivers: tuple[Receiver, ...]) -> None:
    for receive in receivers:
        receive(packet)
