"""Limiting what the kernel buffers for a TCP connection to what its line carries in a moment.

A system buffers megabytes, which a slow line carries in seconds: a command would wait behind all of
it. Here a buffer shrinks while data spend more than a twentieth of a second in queues, and grows
when they spend less (as TCP Vegas does with its window). Only on Linux, not within a computer.
"""

import contextlib
import math
import socket
import struct
from collections.abc import Iterable
from typing import NamedTuple

from lcmtools.bus.kernel import IS_LINUX, duplicate, keep_little_waiting, open_descriptors

_QUEUED = 0.05  # [s] that data may spend in queues
_PERIOD = 0.05  # [s] between two adjustments
_RECENT = 5.0  # [s]
_FIRST_BYTES, _LEAST_BYTES, _MOST_BYTES = 1 << 14, 1 << 12, 1 << 22
_UNSENT_BYTES = 1 << 12
_TCP_INFO, _INFO_BYTES = 11, 152  # linux/tcp.h: struct tcp_info up to tcpi_min_rtt
_SEGMENT, _UNANSWERED, _ROUND_TRIP, _UNSENT, _LEAST_ROUND_TRIP = (
    16,
    24,
    68,
    144,
    148,
)  # offsets in it
_LOOPBACK = ("127.", "::1", "::ffff:127.")


class LineBuffer:
    """The size of one connection's sending buffer."""

    def __init__(self, connection: socket.socket) -> None:
        self._bytes = _FIRST_BYTES
        self._next = 0.0
        self.full_at = -math.inf  # the last time when it held all that it may [s]
        self._is_limited = IS_LINUX and not _is_here(connection)
        if self._is_limited:
            keep_little_waiting(connection, _UNSENT_BYTES)
            _limit(connection, self._bytes)

    @property
    def piece_bytes(self) -> int:
        """The most bytes to pass on at a time, so that the kernel does not take more than fits."""
        return max(_LEAST_BYTES, self._bytes // 4) if self._is_limited else _MOST_BYTES

    def adjust(self, connection: socket.socket, now: float) -> None:
        """Adjust the buffer to the line; ``now`` is the time of any monotonic clock [s]."""
        if not self._is_limited or now < self._next:
            return
        info = connection.getsockopt(socket.IPPROTO_TCP, _TCP_INFO, _INFO_BYTES)
        segment, unanswered, round_trip, unsent, least = (
            struct.unpack_from("=I", info, place)[0]
            for place in (_SEGMENT, _UNANSWERED, _ROUND_TRIP, _UNSENT, _LEAST_ROUND_TRIP)
        )
        self._next = now + max(_PERIOD, round_trip / 1e6)
        factor = (least / 1e6 + _QUEUED) / max(round_trip / 1e6, 1e-6)
        if factor > 1 and 2 * (segment * unanswered + unsent) < self._bytes:
            return  # it is not the buffer that limits
        self.full_at = now
        wanted = int(self._bytes * min(2.0, max(0.5, factor)))
        self._bytes = min(_MOST_BYTES, max(_LEAST_BYTES, wanted))
        _limit(connection, self._bytes)


class Addresses(NamedTuple):
    """The two addresses of a connection, which identify it in a process."""

    own: tuple[str, int]
    other: tuple[str, int]

    @classmethod
    def of(cls, descriptor: int) -> "Addresses":
        """Return the addresses of a connection by its descriptor; OSError if it has none."""
        with duplicate(descriptor) as connection:
            return _addresses(connection)

    @property
    def is_here(self) -> bool:
        """True if both ends are on one computer."""
        return self.other[0] == self.own[0] or self.other[0].startswith(_LOOPBACK)


class LineBuffers:
    """The buffers of connections that another library has opened in this process."""

    def __init__(self) -> None:
        self._known: dict[Addresses, tuple[int, LineBuffer]] = {}

    def follow(self, wanted: Iterable[Addresses]) -> None:
        """Limit the buffers of these connections from now on, and of no others."""
        missing = {ends for ends in wanted if not ends.is_here}
        self._known = {ends: kept for ends, kept in self._known.items() if ends in missing}
        missing -= self._known.keys()
        for descriptor in open_descriptors() if missing else ():
            with contextlib.suppress(OSError), duplicate(descriptor) as connection:
                if (ends := _addresses(connection)) in missing:
                    self._known[ends] = descriptor, LineBuffer(connection)

    def adjust(self, now: float) -> None:
        """Adjust all buffers to their lines."""
        for ends, (descriptor, buffer) in list(self._known.items()):
            # another file may have got the number meanwhile
            with contextlib.suppress(OSError), duplicate(descriptor) as connection:
                if _addresses(connection) == ends:
                    buffer.adjust(connection, now)

    def full(self, now: float) -> list[str]:
        """Return the addresses at the other ends of lines that were full in the last seconds."""
        recent = (x for x, (_, one) in list(self._known.items()) if now - one.full_at < _RECENT)
        return sorted({ends.other[0] for ends in recent})


def _addresses(connection: socket.socket) -> Addresses:
    return Addresses(connection.getsockname()[:2], connection.getpeername()[:2])


def _is_here(connection: socket.socket) -> bool:
    with contextlib.suppress(OSError):
        return _addresses(connection).is_here
    return True  # it is broken already


def _limit(connection: socket.socket, size: int) -> None:
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, size)
