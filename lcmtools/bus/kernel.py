"""The Linux kernel's data on received datagrams, and marks on sockets that others can see.

Elsewhere than on Linux the present serves as the receive time, and sockets stay unmarked.
"""

import contextlib
import socket
import struct
import sys
import time

ANCILLARY_BYTES = 64
"""Room for the ancillary data that ``recvmsg`` is to return."""
ANNOUNCED = 0x5C
"""Mark of a socket whose subscriptions are announced, or that only observes.

What lcmtools' nodes and commands subscribe to is announced; what a plain LCM program subscribes to
is unknown. A process may be both, so the socket is marked: by its type of service, which means
nothing on a socket that never sends, and which the kernel shows every user (sock_diag(7), see
``socket_diag``). The values are for local use (RFC 2474, 6: code points that end in 11).
"""
SELECTIVE = 0x4C
"""Mark of an announced socket whose filter drops most datagrams on purpose.

The kernel counts what a filter drops and what a full buffer drops together.
"""

_SO_TIMESTAMPNS = 35  # asm-generic/socket.h; Python's socket module does not name these
_RECVTTL = 12  # linux/in.h
_TIMESPEC = struct.Struct("@qq")


def request_arrival(receiver: socket.socket) -> None:
    """Request each datagram's receive time and time to live as ancillary data (ip(7))."""
    for level, option in ((socket.SOL_SOCKET, _SO_TIMESTAMPNS), (socket.IPPROTO_IP, _RECVTTL)):
        with contextlib.suppress(OSError):
            receiver.setsockopt(level, option, 1)


def arrival(ancillary: list[tuple[int, int, bytes]]) -> tuple[int, int | None]:
    """Return the kernel's receive time [ns since 1970] and the time to live.

    The present where the kernel gives no time; None where it gives no time to live.
    """
    received, ttl = 0, None
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS and len(data) >= _TIMESPEC.size:
            seconds, nanoseconds = _TIMESPEC.unpack_from(data)
            received = seconds * 1_000_000_000 + nanoseconds
        elif level == socket.IPPROTO_IP and kind == socket.IP_TTL:
            ttl = int.from_bytes(data[:4], sys.byteorder)
    return received or time.time_ns(), ttl


def mark(receiver: socket.socket, value: int) -> None:
    """Mark a socket that receives and never sends; unmarked it counts as a plain program's."""
    with contextlib.suppress(OSError):
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, value)
