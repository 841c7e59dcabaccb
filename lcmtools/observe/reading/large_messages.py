"""All large messages of a bus as a whole, so that one that is sent only once is not missed.

Streams of large messages that nobody wants, such as a camera's, are dropped by the kernel, and with
them what is larger than they are.
"""

from collections.abc import Callable
from contextlib import suppress
from threading import Event, Thread
from time import time_ns

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet

_TURN = 0.1  # [s] at most until a change of what is wanted takes effect
_AGAIN = 0.5  # [s] before a failed network is tried again
_OPENING = 1.0  # [s] at most to wait for the tap
_STREAM = 4  # messages of a channel within _WINDOW are a stream
_WINDOW = 2_000_000_000  # [ns]
_LOOK_AGAIN = 20_000_000_000  # [ns] after which it is seen whether a stream has ended
_ALL = 0xFFFFFFFF  # bytes


class LargeStreams:
    """The channels with streams of large messages. Pure: times are those of the packets [ns]."""

    def __init__(self) -> None:
        self._recent: dict[str, list[int]] = {}
        self._streams: dict[str, tuple[int, int]] = {}  # until when, and the least size

    def add(self, packet: Packet) -> None:
        """Count a message."""
        recent = [at for at in self._recent.get(packet.channel, ()) if packet.time - at < _WINDOW]
        self._recent[packet.channel] = [*recent, packet.time]
        if len(recent) >= _STREAM - 1:
            _, least = self._streams.get(packet.channel, (0, _ALL))
            until = packet.time + _LOOK_AGAIN
            self._streams[packet.channel] = until, min(least, len(packet.payload))

    def limit(self, now: int) -> int:
        """Return the size that only messages of streams reach [bytes]."""
        if not self._streams:
            return _ALL
        over = [channel for channel, (until, _) in self._streams.items() if until <= now]
        for channel in over:
            del self._streams[channel], self._recent[channel]
        return min((least - 1 for _, least in self._streams.values()), default=_ALL)


class LargeMessages:
    """A thread that passes all large messages on; streams only while ``is_wanted`` says so."""

    def __init__(
        self, url: BusUrl, receive: Callable[[Packet], None], is_wanted: Callable[[], bool]
    ) -> None:
        self._url, self._receive, self._is_wanted = url, receive, is_wanted
        self._is_open, self._ends = Event(), Event()
        self._thread = Thread(target=self._run, name="all large messages", daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Wait until messages are read, or the network has failed."""
        self._is_open.wait(_OPENING)

    def close(self) -> None:
        """Stop reading."""
        self._ends.set()
        self._thread.join(2.0)

    def _run(self) -> None:
        while not self._ends.is_set():
            with suppress(BusError, OSError):  # the monitor reports what is wrong with the network
                self._read()
            self._is_open.clear()
            self._ends.wait(_AGAIN)

    def _read(self) -> None:
        streams, limit = LargeStreams(), _ALL
        with Tap(self._url, whole=True, large_only=True) as tap:
            self._is_open.set()
            while not self._ends.is_set():
                for packet in tap.receive(_TURN):
                    streams.add(packet)
                    self._receive(packet)
                before, limit = limit, _ALL if self._is_wanted() else streams.limit(time_ns())
                if limit != before:
                    tap.pass_large(limit)
