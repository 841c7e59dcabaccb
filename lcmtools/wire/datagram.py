"""The datagrams of LCM's UDP multicast (``udpm``): reading any datagram, writing correct ones.

Sans-I/O: bytes in, values out. Nothing here knows a socket, a clock or a message type. No datagram,
however malformed, makes it fail: one that cannot be read is returned as ``MalformedDatagram``.

Format (all integers big-endian), from lcm-proj/lcm, lcm/udpm_util.h:
short message  "LC02" seqno:u32 channel NUL payload
fragment       "LC03" seqno:u32 message_size:u32 offset:u32 number:u16 count:u16
               [channel NUL, in fragment 0 only] part
"""

import struct
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

MAGIC_SHORT = b"LC02"
MAGIC_FRAGMENT = b"LC03"
SHORT_MESSAGE_MAX = 65499
"""Largest channel + NUL + payload that liblcm sends in one datagram, in bytes."""
FRAGMENT_MAX = 65487
"""Largest part (channel + NUL counted in the first) of one fragment, in bytes."""
MESSAGE_MAX = 1 << 28
"""liblcm's receivers refuse larger messages, in bytes."""

_SHORT_HEADER = struct.Struct(">4sI")
short_head = _SHORT_HEADER.pack
"""Returns the bytes before the channel of a short message: ``short_head(MAGIC_SHORT, seqno)``."""
_FRAGMENT_HEADER = struct.Struct(">4sIIIHH")
SHORT_HEADER_BYTES, FRAGMENT_HEADER_BYTES = _SHORT_HEADER.size, _FRAGMENT_HEADER.size
CHANNEL_MAX = 63
"""Longest channel name without its NUL, in bytes."""
_LATEST_END = SHORT_HEADER_BYTES + CHANNEL_MAX + 1  # of a channel in a short message


class ShortMessage(NamedTuple):
    """A whole message in one datagram; a named tuple for the reason given in ``packet``."""

    seqno: int
    channel: str
    payload: bytes


class Fragment(NamedTuple):
    """One part of a message that is too large for a datagram."""

    seqno: int  # the message's sequence number, given by its sender
    message_size: int  # bytes of the whole payload
    offset: int  # place of this part in the payload [byte]
    number: int  # 0, 1, 2, ... below count
    count: int  # type: ignore[assignment] # not tuple.count: fragments of the message
    channel: str | None  # in fragment 0 only
    part: bytes | memoryview  # a part of the datagram; not copied again


class MalformedDatagram(NamedTuple):
    """A datagram that is not one of LCM's, with the reason."""

    reason: str


def parse(datagram: bytes) -> ShortMessage | Fragment | MalformedDatagram:
    """Read one datagram; never raises."""
    magic = datagram[:4]
    if magic == MAGIC_SHORT:
        return _parse_short(datagram)
    if magic == MAGIC_FRAGMENT:
        return _parse_fragment(datagram)
    return MalformedDatagram(f"starts with {magic!r}, not with LC02 or LC03")


def split_short(datagram: bytes) -> tuple[bytes, bytes | None]:
    """Return a short message's encoded channel and its payload: None for any other datagram.

    The least that ``parse`` does, for those who read thousands a second.
    """
    end = datagram.find(b"\0", SHORT_HEADER_BYTES, _LATEST_END)
    if end > 0 and datagram.startswith(MAGIC_SHORT):
        return datagram[SHORT_HEADER_BYTES:end], datagram[end + 1 :]
    return b"", None


def short_message(seqno: int, channel: str, payload: bytes) -> bytes:
    """Return the datagram of a message that fits into one (see SHORT_MESSAGE_MAX)."""
    return short_head(MAGIC_SHORT, seqno & 0xFFFFFFFF) + _channel_bytes(channel) + payload


def fragments(seqno: int, channel: str, payload: bytes) -> Iterator[bytes]:
    """Yield the datagrams of a message that does not fit into one, cut as by liblcm.

    Raises:
        ValueError: The payload is larger than receivers accept.
    """
    if len(payload) > MESSAGE_MAX:
        raise ValueError(f"{len(payload)} bytes; LCM's receivers refuse more than {MESSAGE_MAX}")
    name = _channel_bytes(channel)
    view = memoryview(payload)
    count = -(-(len(name) + len(payload)) // FRAGMENT_MAX)
    offset = 0
    for number in range(count):
        room = FRAGMENT_MAX - (len(name) if number == 0 else 0)
        header = _FRAGMENT_HEADER.pack(
            MAGIC_FRAGMENT, seqno & 0xFFFFFFFF, len(payload), offset, number, count
        )
        part = view[offset : offset + room]
        yield b"".join((header, name, part) if number == 0 else (header, part))
        offset += len(part)


def datagrams(seqno: int, channel: str, payload: bytes) -> Iterator[bytes]:
    """Yield the datagrams of a message as liblcm sends it: one if it fits, else fragments."""
    if len(_channel_bytes(channel)) + len(payload) <= SHORT_MESSAGE_MAX:
        yield short_message(seqno, channel, payload)
    else:
        yield from fragments(seqno, channel, payload)


@lru_cache(1024)  # called for each message sent
def _channel_bytes(channel: str) -> bytes:
    # surrogateescape: a channel that is not UTF-8 keeps its bytes, on the way in and out
    return channel.encode("utf-8", "surrogateescape") + b"\0"


def _parse_short(datagram: bytes) -> ShortMessage | MalformedDatagram:
    if len(datagram) < _SHORT_HEADER.size:
        return MalformedDatagram("short message: shorter than its header")
    name, payload = split_short(datagram)
    if payload is None:
        return MalformedDatagram("short message: channel name not ended within 63 bytes")
    channel = name.decode("utf-8", "surrogateescape")
    return ShortMessage(int.from_bytes(datagram[4:8], "big"), channel, payload)


def _parse_fragment(datagram: bytes) -> Fragment | MalformedDatagram:
    if len(datagram) < _FRAGMENT_HEADER.size:
        return MalformedDatagram("fragment: shorter than its header")
    _, seqno, size, offset, number, count = _FRAGMENT_HEADER.unpack_from(datagram)
    if number >= count:
        return MalformedDatagram(f"fragment: number {number} of {count}")
    if size > MESSAGE_MAX:
        return MalformedDatagram(f"fragment: message of {size} bytes")
    start, channel = _FRAGMENT_HEADER.size, None
    if number == 0:
        end = datagram.find(b"\0", start, start + CHANNEL_MAX + 1)
        if end < 0:
            return MalformedDatagram("fragment: channel name not ended within 63 bytes")
        channel = datagram[start:end].decode("utf-8", "surrogateescape")
        start = end + 1
    if offset + len(datagram) - start > size:
        return MalformedDatagram(f"fragment: reaches beyond the message's {size} bytes")
    return Fragment(seqno, size, offset, number, count, channel, memoryview(datagram)[start:])
