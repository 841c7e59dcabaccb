"""One channel looked at closely: its latest message, decoded, and what its numbers have been.

Messages are taken in on one thread and looked at from another. What comes faster than a person or
this computer can follow is passed over: only so many messages a second are decoded.
"""

import threading
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.cli.spy.numbers import Line, lines_of
from lcmtools.cli.spy.sparkline import Sample
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message, candidates, message_class
from lcmtools.wire.packet import Packet

KEPT = 2400
"""Samples of each number."""
_MOST_PATHS = 300  # whose samples are kept
_SMALL, _LARGE = 1 / 55, 1 / 4  # [s] on average between two messages that are decoded
_LARGE_BYTES = 200_000
_HEAD_BYTES = 256


@dataclass(frozen=True, slots=True)
class Look:
    """What is known of a channel's messages.

    Attributes:
        lines: The latest message; empty before the first, and where it cannot be decoded.
        type: What it was decoded as; "" where it was not.
        others: What it may be too, by its fingerprint.
        fingerprint: Of the latest message; None for none.
        problem: Why it cannot be decoded; "" where it was.
        head: The beginning of its payload.
        size: Bytes of the payload.
        messages: How many have come since the channel is looked at.
        decoded: How many of them were decoded.
        time: When the latest came, nanoseconds since 1970.
    """

    lines: tuple[Line, ...] = ()
    type: str = ""
    others: tuple[str, ...] = ()
    fingerprint: int | None = None
    problem: str = ""
    head: bytes = b""
    size: int = 0
    messages: int = 0
    decoded: int = 0
    time: int = 0


class Study:
    """One channel looked at closely.

    Args:
        channel: Its name.
        types: What nodes say that its messages are.
    """

    def __init__(self, channel: str, types: Sequence[str] = ()) -> None:
        self.channel = channel
        self.types = tuple(types)
        self._lock = threading.Lock()
        self._toggled: set[str] = set()
        self._samples: dict[str, deque[Sample]] = {}
        self._message: Message | None = None
        self._packet: Packet | None = None
        self._type, self._problem = "", ""
        self._messages = self._decoded = self._next = 0

    def hear(self, packet: Packet) -> None:
        """Take a packet into account; those of other channels are none of its business."""
        if packet.channel != self.channel:
            return
        with self._lock:
            self._messages += 1
            if packet.whole_bytes is None and packet.time >= self._next:
                pause = _LARGE if packet.size > _LARGE_BYTES else _SMALL
                pause_ns = round(pause * 1e9)
                self._next = max(self._next, packet.time - pause_ns) + pause_ns
                self._take(packet)

    def toggle(self, path: str) -> None:
        """Open a part of the message that is closed, or close it."""
        with self._lock:
            self._toggled ^= {path}

    def clear(self) -> None:
        """Forget what the numbers have been."""
        with self._lock:
            self._samples.clear()
            self._messages = self._decoded = 0

    def samples(self, path: str) -> list[Sample]:
        """What a number has been: times [ns] and values."""
        with self._lock:
            return list(self._samples.get(path, ()))

    def look(self) -> Look:
        """What is known now."""
        with self._lock:
            packet = self._packet
            if packet is None:
                return Look(messages=self._messages)
            names = [] if packet.fingerprint is None else candidates(packet.fingerprint)
            return Look(
                tuple(lines_of(self._message, self._toggled)) if self._message else (),
                self._type,
                tuple(name for name in names if name != self._type),
                packet.fingerprint,
                self._problem,
                packet.payload[:_HEAD_BYTES],
                packet.size,
                self._messages,
                self._decoded,
                packet.time,
            )

    def _take(self, packet: Packet) -> None:
        self._packet = packet
        self._message, self._type, self._problem = None, "", ""
        try:
            self._type, self._message = decoded(packet, self.types)
        except LcmtoolsError as error:
            self._problem = str(error)
            return
        self._decoded += 1
        for line in lines_of(self._message, self._toggled):
            if line.number is not None:
                self._keep(line.path, (packet.time, line.number))

    def _keep(self, path: str, sample: Sample) -> None:
        samples = self._samples.get(path)
        if samples is None:
            if len(self._samples) >= _MOST_PATHS:
                return
            samples = self._samples[path] = deque(maxlen=KEPT)
        samples.append(sample)


def decoded(packet: Packet, announced: Sequence[str] = ()) -> tuple[str, Message]:
    """What a packet says, and its type: the one announced, else the likeliest.

    Raises:
        DecodeError: It cannot be decoded, with why.
        LcmtoolsError: The type's .lcm file is wrong.
    """
    if packet.fingerprint is None:
        raise DecodeError(f"{packet.size} bytes are too few for an LCM message")
    names = candidates(packet.fingerprint)
    if not names:
        raise DecodeError(f"unknown type, fingerprint {packet.fingerprint:#018x}")
    name = next((name for name in announced if name in names), names[0])
    return name, decode(message_class(name, packet.fingerprint), packet.payload)
