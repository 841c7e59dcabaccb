"""When a datagram came, and with what time to live, as the kernel tells with it (ip(7), socket(7)).

Python reads it later, and perhaps many at once.
"""

import contextlib
import socket
import struct
import sys
import time

ANCILLARY_BYTES = 64
"""Room for what is told, as ``recvmsg`` wants it."""

_SO_TIMESTAMPNS = 35  # asm-generic/socket.h; Python's socket module does not name these
_RECVTTL = 12  # linux/in.h
_TIMESPEC = struct.Struct("@qq")


def ask_kernel(receiver: socket.socket) -> None:
    """Ask it to tell when each datagram came, and with what time to live."""
    for level, option in ((socket.SOL_SOCKET, _SO_TIMESTAMPNS), (socket.IPPROTO_IP, _RECVTTL)):
        with contextlib.suppress(OSError):  # not Linux: the time of reading serves instead
            receiver.setsockopt(level, option, 1)


def told(ancillary: list[tuple[int, int, bytes]]) -> tuple[int, int | None]:
    """The kernel's receive time, nanoseconds since 1970, and the time to live.

    The present where the kernel tells no time, None where it does not tell the other.
    """
    arrival, ttl = 0, None
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS and len(data) >= _TIMESPEC.size:
            seconds, nanoseconds = _TIMESPEC.unpack_from(data)
            arrival = seconds * 1_000_000_000 + nanoseconds
        elif level == socket.IPPROTO_IP and kind == socket.IP_TTL:
            ttl = int.from_bytes(data[:4], sys.byteorder)
    return arrival or time.time_ns(), ttl
