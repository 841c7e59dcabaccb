"""The events in the bytes of an LCM log, which may be damaged.

The format: events one after another, each a sync word, a number, the time in microseconds since
1970, the sizes of channel and payload, and these two; all big-endian.
(https://lcm-proj.github.io/lcm/content/log-file-format.html).
"""

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING

from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    import mmap

SYNC = bytes.fromhex("eda1da01")
"""Every event starts with it."""

_HEAD = struct.Struct(">4sqqII")


def events(log: "bytes | mmap.mmap") -> Iterator[Packet]:
    """Yield the messages of a log, with the times of their recording; skip damaged events."""
    start = log.find(SYNC)
    while 0 <= start <= len(log) - _HEAD.size:
        _, _, time, channel_size, payload_size = _HEAD.unpack_from(log, start)
        middle = start + _HEAD.size + channel_size
        end = middle + payload_size
        if end != len(log) and log[end : end + len(SYNC)] != SYNC:
            start = log.find(SYNC, start + 1)
            continue
        channel = log[start + _HEAD.size : middle].decode("utf-8", "surrogateescape")
        yield Packet(channel, log[middle:end], time * 1000)
        start = end
