"""The events in the bytes of an LCM log, which may be damaged.

The format: events one after another, each of a sync word, a number, the time in microseconds since
1970, the sizes of channel and payload, and these two; all big-endian
(https://lcm-proj.github.io/lcm/content/log-file-format.html).
"""

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    import mmap

SYNC = bytes.fromhex("eda1da01")
"""Starts every event."""
HEAD_BYTES = 28
"""Bytes of an event before its channel's name."""

_MOST_AT_ONCE = 64 << 20  # bytes
_HEAD = struct.Struct(">4sqqII")
_LONGEST_CHANNEL = 1000  # bytes; for liblcm an event with an empty or a longer name is damaged


class Event(NamedTuple):
    """The place of an event in a log."""

    start: int  # offset of its sync word [byte]
    payload_start: int
    end: int
    channel: str
    time: int  # time of recording [ns since 1970]

    @property
    def size(self) -> int:
        """Bytes of the payload."""
        return self.end - self.payload_start

    def packet(self, log: "bytes | mmap.mmap") -> Packet:
        """Return the event's message, given the log that it is in."""
        return Packet(self.channel, log[self.payload_start : self.end], self.time)

    def head(self, log: "bytes | mmap.mmap") -> Packet:
        """Return the same with only the fingerprint of its payload."""
        start = self.payload_start
        payload = log[start : min(start + 8, self.end)]
        return Packet(self.channel, payload, self.time, whole_bytes=self.end - start)


def events(log: "bytes | mmap.mmap", start: int = 0, end: int | None = None) -> Iterator[Event]:
    """Yield the places of the events of a log that begin in a range of bytes; skip damaged ones.

    An event is whole if all bytes of its lengths are there, whatever follows them. Bytes between
    the end of one event and the start of the next are damaged.
    """
    last = (len(log) if end is None else min(end, len(log))) - HEAD_BYTES
    names: dict[bytes, str] = {}
    start = _next_sync(log, start)
    while 0 <= start <= last:
        _, _, time, channel_size, payload_size = _HEAD.unpack_from(log, start)
        payload_start = start + HEAD_BYTES + channel_size
        stop = payload_start + payload_size
        is_followed = log[stop : stop + len(SYNC)] == SYNC
        is_sound = is_followed or stop == len(log) or _is_alone(log, start, stop)
        if not (is_sound and 0 < channel_size < _LONGEST_CHANNEL):
            start = _next_sync(log, start + 1)
            continue
        spelled = log[start + HEAD_BYTES : payload_start]
        channel = names.get(spelled)
        if channel is None:
            channel = names[spelled] = spelled.decode("utf-8", "surrogateescape")
        yield Event(start, payload_start, stop, channel, time * 1000)
        start = stop if is_followed else _next_sync(log, stop)


def _is_alone(log: "bytes | mmap.mmap", start: int, stop: int) -> bool:
    """Return whether an event is whole, though none follows it.

    If a sound event begins in it and ends after it, its own lengths are damaged.
    """
    if stop > len(log):
        return False
    inner = log.rfind(SYNC, start + 1, stop + len(SYNC) - 1)
    if not 0 <= inner <= len(log) - HEAD_BYTES:
        return True
    end = inner + HEAD_BYTES + sum(_HEAD.unpack_from(log, inner)[3:])
    return end <= stop or (end != len(log) and log[end : end + len(SYNC)] != SYNC)


def _next_sync(log: "bytes | mmap.mmap", start: int) -> int:
    """The place of the next sync word; -1 for none. Searches in pieces, to allow Ctrl-C."""
    while start < len(log):
        stop = start + _MOST_AT_ONCE
        found = log.find(SYNC, start, stop + len(SYNC) - 1)
        if found >= 0:
            return found
        start = stop
    return -1


def packets(log: "bytes | mmap.mmap") -> Iterator[Packet]:
    """Yield the messages of a log, with their times of recording; skip damaged events."""
    return (event.packet(log) for event in events(log))


def encode_head(number: int, packet: Packet) -> bytes:
    """Return an event up to its payload; ``number`` is its place in the log, from 0."""
    name, payload, time, *_ = packet
    channel = name.encode("utf-8", "surrogateescape")
    return _HEAD.pack(SYNC, number, time // 1000, len(channel), len(payload)) + channel
