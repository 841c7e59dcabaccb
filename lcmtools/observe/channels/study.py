"""One channel in detail: its latest message, decoded, and the history of its numbers.

Messages arrive on one thread and are read from another. Only as many messages per second are
decoded as a person and this computer can follow.
"""

import math
import threading
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import Message
from lcmtools.observe.channels.field_lines import FieldLine, field_lines
from lcmtools.observe.reading.decoding import Decoder, possible_types
from lcmtools.wire.packet import Packet

Sample = tuple[int, float]  # a time [ns] and a number

KEPT = 2400  # samples of each number
_MOST_PATHS = 300  # fields whose samples are kept
_SMALL, _LARGE = 1_000_000_000 // 55, 250_000_000  # [ns] on average between decoded messages
_LARGE_BYTES = 200_000
_HEAD_BYTES = 256


@dataclass(frozen=True, slots=True)
class ChannelState:
    """The state of a channel at one time."""

    # The latest message; empty before the first one, and if it cannot be decoded.
    lines: tuple[FieldLine, ...] = ()
    type: str = ""  # its type; "" if it was not decoded
    others: tuple[str, ...] = ()  # other types with its fingerprint
    fingerprint: int | None = None  # its fingerprint; None if it has none
    problem: str = ""  # the reason why it cannot be decoded; "" if it was
    head: bytes = b""  # the first bytes of its payload
    size: int = 0  # bytes of the payload
    messages: int = 0  # the number of messages so far
    decoded: int = 0  # the number of decoded messages
    time: int = 0  # arrival of the latest [ns since 1970]


class Study:
    """A channel in detail; its nodes announce ``types``."""

    def __init__(self, channel: str, types: Sequence[str] = ()) -> None:
        self.channel = channel
        self._types = tuple(types)
        self._decoder = Decoder(lambda _: self._types)
        self._lock = threading.Lock()
        self._toggled: set[str] = set()
        self._samples: dict[str, deque[Sample]] = {}
        self._message: Message | None = None
        self._state = ChannelState()
        self._messages = self._decoded = self._next = 0

    def add_packet(self, packet: Packet) -> None:
        """Process a packet; packets of other channels are ignored."""
        if packet.channel != self.channel:
            return
        with self._lock:
            self._messages += 1
            if packet.whole_bytes is None and packet.time >= self._next:
                pause = _LARGE if packet.size > _LARGE_BYTES else _SMALL
                self._next = max(self._next, packet.time - pause) + pause
                self._decode(packet)

    def announced(self, types: Sequence[str]) -> None:
        """Set the types that nodes now announce."""
        if tuple(types) != self._types:
            self._types = tuple(types)
            self._decoder = Decoder(lambda _: self._types)

    def toggle(self, path: str) -> None:
        """Open a closed part of the message, or close an open one."""
        with self._lock:
            self._toggled ^= {path}

    def clear(self) -> None:
        """Forget the history of the numbers."""
        with self._lock:
            self._samples.clear()
            self._messages = self._decoded = 0

    def samples(self, path: str) -> list[Sample]:
        """Return the history of a number."""
        with self._lock:
            return list(self._samples.get(path, ()))

    def state(self) -> ChannelState:
        """Return the current state."""
        with self._lock:
            lines = tuple(field_lines(self._message, self._toggled)) if self._message else ()
            return replace(self._state, lines=lines, messages=self._messages, decoded=self._decoded)

    def _decode(self, packet: Packet) -> None:
        self._message, problem = None, ""
        try:
            self._message = self._decoder.decode(packet)
        except LcmtoolsError as error:
            problem = str(error)
        name = self._decoder.types(packet)[0] if self._message else ""
        number = packet.fingerprint
        names = [] if number is None else possible_types(number, self.channel)
        others = tuple(other for other in names if other != name)
        head = packet.payload[:_HEAD_BYTES]
        seen = packet.fingerprint, problem, head, packet.size
        self._state = ChannelState((), name, others, *seen, time=packet.time)
        if self._message is None:
            return
        self._decoded += 1
        for line in field_lines(self._message, self._toggled):
            if line.number is not None and (
                line.path in self._samples or len(self._samples) < _MOST_PATHS
            ):
                samples = self._samples.setdefault(line.path, deque(maxlen=KEPT))
                samples.append((packet.time, line.number))


@dataclass(frozen=True, slots=True)
class Sparkline:
    """A number over time, with its smallest and largest value."""

    # The mean in each interval, newest last, scaled to 0 .. 1; an interval without samples repeats
    # the one before. Intervals before the first sample have no bar.
    bars: tuple[float, ...] = ()
    low: float = 0.0
    high: float = 0.0


def curve(samples: Iterable[Sample], now: int, count: int, bin_ns: int) -> Sparkline:
    """Return the curve of a number from samples in order of time, up to ``now`` [ns].

    There are at most ``count`` bars, of ``bin_ns`` each: the intervals are fixed, to avoid flicker.
    Samples that are not finite are left out.
    """
    first = now // bin_ns - count + 1
    bins: dict[int, list[float]] = {}
    before: float | None = None
    for time, value in samples:
        place = time // bin_ns - first
        if not math.isfinite(value) or time > now:
            continue
        if place < 0:
            before = value
        else:
            bins.setdefault(place, []).append(value)
    known = [value for values in bins.values() for value in values]
    known += [] if before is None else [before]
    if not known:
        return Sparkline()
    bars = []
    for place in range(count):
        if values := bins.get(place):
            mean = math.fsum(value / len(values) for value in values)
            before = max(min(values), min(mean, max(values)))  # rounding must not change a constant
        if before is not None:
            bars.append(before)
    low, high = min(bars), max(bars)
    scale = high / 2 - low / 2  # halves, because the difference may overflow
    scaled = tuple((bar / 2 - low / 2) / scale if scale else 0.0 for bar in bars)
    return Sparkline(scaled, min(known), max(known))
