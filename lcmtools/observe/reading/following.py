"""Whole messages of some channels, while a monitor reads only the heads of all.

The channels may change at any time. Small messages come from the monitor; large ones, of which it
reads only the beginning, from a single tap, which exists while some are wanted.
"""

import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TypeAlias

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet

Take: TypeAlias = Callable[[Packet], None]  # called with each message, on another thread

_TURN = 0.1  # [s] at most until a change of the channels takes effect
_AGAIN = 0.5  # [s] before a failed network is tried again


class Following:
    """The followed channels of a bus, and the callbacks that take their messages."""

    def __init__(self, url: BusUrl) -> None:
        self._url = url
        self._lock = threading.Lock()
        self._takers: dict[str, tuple[Take, ...]] = {}
        self._large: set[str] = set()  # channels of which the monitor reads only the heads
        self._thread: threading.Thread | None = None

    @property
    def channels(self) -> list[str]:
        """The channels, sorted."""
        with self._lock:
            return sorted(self._takers)

    def add(self, channel: str, take: Take) -> Callable[[], None]:
        """Pass a channel's whole messages on from now; return a call to end it."""
        with self._lock:
            self._takers[channel] = (*self._takers.get(channel, ()), take)
            self._attend_large()
        return partial(self._remove, channel, take)

    def pass_on(self, packet: Packet) -> None:
        """Pass on a packet that the monitor has read."""
        takers = self._takers.get(packet.channel)
        if not takers or packet.channel in self._large:
            return
        if packet.whole_bytes is None:
            _give(packet, takers)
            return
        with self._lock:
            self._large.add(packet.channel)
            self._attend_large()

    def close(self) -> None:
        """Stop passing packets on."""
        with self._lock:
            self._takers.clear()
            thread = self._thread
        if thread:
            thread.join(2.0)

    def _remove(self, channel: str, take: Take) -> None:
        with self._lock:
            takers = list(self._takers.get(channel, ()))
            if take in takers:
                takers.remove(take)
            self._takers[channel] = tuple(takers)
            if not takers:
                del self._takers[channel]
                self._large.discard(channel)  # it may be small when it is followed again

    def _attend_large(self) -> None:
        if self._thread is None and self._wanted():
            self._thread = threading.Thread(target=self._read_large, name="large messages")
            self._thread.daemon = True
            self._thread.start()

    def _wanted(self) -> tuple[str, ...]:
        return tuple(sorted(self._large & self._takers.keys()))

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
                        _give(packet, self._takers.get(packet.channel, ()))
                with self._lock:
                    before, wanted = wanted, self._wanted()
                if wanted != before:
                    tap.want_whole(wanted)


def _give(packet: Packet, takers: tuple[Take, ...]) -> None:
    for take in takers:
        take(packet)
