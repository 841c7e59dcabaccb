"""Marks on the sockets with which lcmtools hears a bus, which everybody on the computer may see.

What a node or a command of lcmtools hears it announces; what a plain LCM program hears nobody can
know. A process may be both. So it is the socket that is marked: by its type of service, which
means nothing on a socket that sends nothing, and which the kernel tells any user (sock_diag(7), see
lcmtools.bus.socket_memory). The values are for local use (RFC 2474, 6: code points that end in 11).
"""

import contextlib
import socket

ANNOUNCED = 0x5C
"""Whatever is heard with it is announced, or is only looked at."""
SELECTIVE = 0x4C
"""The same; besides, its filter drops most of what comes, on purpose.

The kernel counts what a filter drops as it counts what a full buffer loses, and shows only the sum.
"""


def mark(receiver: socket.socket, value: int) -> None:
    """Put a mark on a socket that receives and never sends."""
    with contextlib.suppress(OSError):  # who looks takes it for a plain program's
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, value)
