"""The frames of LCM's provider ``tcpq``, by which programs talk to a server: reading and writing.

Sans-I/O. All integers are big-endian, from lcm-proj/lcm, lcm/lcm_tcpq.c:
greeting     magic:u32 version:u32, sent first by each side
publish      1:u32 size:u32 channel size:u32 payload; in both directions
subscribe    2:u32 size:u32 pattern; unsubscribe is 3
"""

import struct
from collections.abc import Iterator
from typing import NamedTuple

from lcmtools.errors import LcmtoolsError
from lcmtools.wire.datagram import MESSAGE_MAX

SERVER_GREETING = struct.pack(">II", 0x287617FA, 0x0100)
CLIENT_GREETING = struct.pack(">II", 0x287617FB, 0x0100)
PUBLISH, SUBSCRIBE, UNSUBSCRIBE = 1, 2, 3
LARGE = "/_lcmtools/large/"
"""Begins a pattern that matches no channel; the address of a client's first connection follows.

Who subscribes to it gets the large messages for that client.
"""

_WORD, _HEAD = 4, 8  # bytes of a number; bytes of the kind and the first size
_MOST_NAME = {PUBLISH: 255, SUBSCRIBE: 4096, UNSUBSCRIBE: 4096}
"""The most bytes of a name; here liblcm allows channels of more than 63."""


class StreamError(LcmtoolsError):
    """Bytes that are not frames of tcpq."""


class Frame(NamedTuple):
    """One frame of a client."""

    kind: int  # PUBLISH, SUBSCRIBE or UNSUBSCRIBE
    name: str  # the channel, or the pattern of channels
    data: bytes  # the whole frame


class FrameReader:
    """Splits the bytes of a client, or a server, into frames, in whatever pieces they come."""

    def __init__(self, greeting: bytes = CLIENT_GREETING) -> None:
        self._greeting = greeting
        self.is_greeted = False  # True if the client has sent its greeting
        self._bytes = bytearray()

    def read(self, data: bytes | memoryview) -> Iterator[Frame]:
        """Yield the frames that these bytes complete.

        Raises:
            StreamError: They are not frames; nothing more can be read.
        """
        waiting = self._bytes
        waiting += data
        place = 0 if self.is_greeted else self._read_greeting()
        while self.is_greeted and (end := self._end_of_frame(place)):
            kind, size = struct.unpack_from(">II", waiting, place)
            name = waiting[place + _HEAD : place + _HEAD + size]
            yield Frame(kind, name.decode("utf-8", "surrogateescape"), bytes(waiting[place:end]))
            place = end
        del waiting[:place]

    def _read_greeting(self) -> int:
        start = bytes(self._bytes[: len(self._greeting)])
        if not self._greeting[:_WORD].startswith(start[:_WORD]):
            raise StreamError(f"it does not speak tcpq, it begins with {start!r}")
        self.is_greeted = len(start) == len(self._greeting)
        return len(start) if self.is_greeted else 0

    def _end_of_frame(self, start: int) -> int:
        """Return the offset after a frame; 0 if it is incomplete."""
        waiting = self._bytes
        if len(waiting) < start + _HEAD:
            return 0
        kind, size = struct.unpack_from(">II", waiting, start)
        if kind not in _MOST_NAME:
            raise StreamError(f"it sent a frame of the unknown kind {kind}")
        if not 0 < size <= _MOST_NAME[kind]:
            raise StreamError(f"it sent a name of {size} bytes")
        end = start + _HEAD + size
        if kind == PUBLISH:
            if len(waiting) < end + _WORD:
                return 0
            length = int.from_bytes(waiting[end : end + _WORD], "big")
            if length > MESSAGE_MAX:
                raise StreamError(f"it sent a message of {length} bytes; LCM carries {MESSAGE_MAX}")
            end += _WORD + length
        return end if len(waiting) >= end else 0


def publish_frame(channel: str, payload: bytes) -> bytes:
    """Return the frame of a message."""
    size = len(payload).to_bytes(_WORD, "big")
    return b"".join((_named(PUBLISH, channel), size, payload))


def subscribe_frame(pattern: str) -> bytes:
    """Return the frame of a subscription."""
    return _named(SUBSCRIBE, pattern)


def payload_of(frame: Frame) -> bytes:
    """Return the payload of a publishing frame."""
    start = int.from_bytes(frame.data[_WORD:_HEAD], "big") + _HEAD + _WORD
    return frame.data[start:]


def _named(kind: int, name: str) -> bytes:
    data = name.encode("utf-8", "surrogateescape")
    return struct.pack(">II", kind, len(data)) + data
