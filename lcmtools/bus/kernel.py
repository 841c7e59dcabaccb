"""The kernel's interface: options of sockets, and numbers of its namespaces.

Everything here has a fallback for systems other than Linux: nothing is filtered, and answers are
None or empty. The table of all sockets is in ``sockets``, processes are in ``processes``.
"""

import contextlib
import os
import socket
import struct
import sys
import time
import zlib
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from lcmtools.bus.socket_filter import FilterProgram

STAMP_ROOM = socket.CMSG_SPACE(16)
"""Size of the ancillary data that ``recvmsg`` is to return: a receive time [byte]."""
ANCILLARY_BYTES = STAMP_ROOM + socket.CMSG_SPACE(4)  # and a time to live
ANNOUNCED = 0x5C
"""Mark of a socket whose subscriptions are announced, or that only observes.

The subscriptions of lcmtools' nodes and commands are announced; those of a plain LCM program are
unknown. As a process may be both, the socket is marked, by its type of service, which has no effect
on a socket that never sends and which the kernel shows to every user. The values are for local use
(RFC 2474, 6: code points that end in 11).
"""
SELECTIVE = 0x4C
"""Mark of an announced socket whose filter drops most datagrams on purpose.

The kernel counts what a filter drops and what a full buffer drops together.
"""
SUBSCRIBED = 0x6C
"""Mark of an announced socket whose filter drops channels that its node does not subscribe to."""
UNFILTERED = 0x7C
"""Mark of an announced socket that receives every channel, as the system refused its filter."""
OWN_MARKS = ANNOUNCED, SELECTIVE, SUBSCRIBED, UNFILTERED

_WANTED_BUFFER_BYTES = 8 << 20
# asm-generic/socket.h and linux/in.h; Python's socket module does not name these
_SO_ATTACH_FILTER, _SO_DETACH_FILTER, _SO_MEMINFO, _SO_NETNS_COOKIE = 26, 27, 55, 71
_IP_RECVTTL, _SO_RCVTIMEO = 12, 20
_UDP_SEGMENT, _TCP_INFO = 103, 11  # linux/udp.h, linux/tcp.h
_MEMORY_USED, _MEMORY_LIMIT, _MEMORY_DROPS = 0, 1, 8  # indices of its numbers (linux/sock_diag.h)
IS_LINUX = sys.platform == "linux"
# the option for receive times, the kind of its ancillary data and the unit of its fractions [ns]:
# SO_TIMESTAMPNS on Linux, SO_TIMESTAMP on macOS and BSD (sys/socket.h)
_STAMP_OPTION, STAMP_KIND, _STAMP_UNIT = (35, 35, 1) if IS_LINUX else (0x0400, 0x02, 1000)
_STAMPS = {8: struct.Struct("=ii"), 16: struct.Struct("=qq" if IS_LINUX else "=qi")}
"""Seconds and fraction of a receive time by its size [byte]."""

_LITTLE_BYTES = 1 << 16
_RETRANSMITS = 2  # index in struct tcp_info (linux/tcp.h): retransmissions without an answer


def drop_what_is_late(connection: socket.socket, seconds: float) -> None:
    """Let a connection break if its peer has not acknowledged data for ``seconds`` (tcp(7)).

    Data waiting for it are dropped too. A system without this option waits for minutes.
    """
    keep_little_waiting(connection)
    if hasattr(socket, "TCP_USER_TIMEOUT"):
        milliseconds = int(seconds * 1000)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, milliseconds)


def keep_little_waiting(connection: socket.socket, most_bytes: int = _LITTLE_BYTES) -> None:
    """Let the kernel buffer little more of a connection's data than the line can take at once.

    Data that wait in the program can still be dropped; data in the kernel will arrive. They leave
    without waiting for the acknowledgement of earlier data (without Nagle's algorithm).
    """
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if hasattr(socket, "TCP_NOTSENT_LOWAT"):
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, most_bytes)


def is_unanswered(connection: socket.socket) -> bool:
    """Return whether data had to be retransmitted and are still not acknowledged."""
    option = socket.IPPROTO_TCP, _TCP_INFO, 8
    return IS_LINUX and connection.getsockopt(*option)[_RETRANSMITS] > 0


def duplicate(descriptor: int) -> socket.socket:
    """Return another library's socket, which blocks or not as before, whatever Python's default."""
    blocks = os.get_blocking(descriptor)
    copy = socket.socket(fileno=os.dup(descriptor))
    os.set_blocking(descriptor, blocks)
    return copy


def share_port(receiver: socket.socket) -> None:
    """Let other sockets receive from the same group and port, as liblcm does."""
    with contextlib.suppress(OSError):  # then it may be the only one
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if not IS_LINUX:  # macOS and BSD need both
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)


def request_arrival(receiver: socket.socket, *, ttl: bool = True) -> bool:
    """Request each datagram's receive time, and its time to live, as ancillary data (ip(7)).

    Return False if the system gives no receive time.
    """
    with contextlib.suppress(OSError):
        if IS_LINUX and ttl:
            receiver.setsockopt(socket.IPPROTO_IP, _IP_RECVTTL, 1)
    with contextlib.suppress(OSError):
        receiver.setsockopt(socket.SOL_SOCKET, _STAMP_OPTION, 1)
        return True
    return False


def received_at(stamp: bytes) -> int:
    """Return the receive time in ancillary data of STAMP_KIND [ns since 1970].

    On 32-bit Linux, and for 32-bit programs on any, seconds and fraction have 32 bits each.
    """
    layout = _STAMPS.get(len(stamp))
    if layout is None:
        return time.time_ns()
    seconds, fraction = layout.unpack_from(stamp)
    return int(seconds * 1_000_000_000 + fraction * _STAMP_UNIT)


def arrival(ancillary: list[tuple[int, int, bytes]]) -> tuple[int, int | None]:
    """Return the kernel's receive time [ns since 1970] and the time to live.

    The current time if the kernel gives no time; None if it gives no time to live.
    """
    received, ttl = 0, None
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == STAMP_KIND:
            received = received_at(data)
        elif level == socket.IPPROTO_IP and kind == socket.IP_TTL:
            ttl = int.from_bytes(data[:4], sys.byteorder)
    return received or time.time_ns(), ttl


def cuts_datagrams(sender: socket.socket) -> bool:
    """Return whether ``send_cut`` is possible; since Linux 4.18."""
    with contextlib.suppress(OSError):
        return IS_LINUX and sender.getsockopt(socket.IPPROTO_UDP, _UDP_SEGMENT) >= 0
    return False


def send_cut(sender: socket.socket, datagrams: Sequence[bytes], address: tuple[str, int]) -> None:
    """Send datagrams of one size, at most 64 and 65 kB, with one call (UDP_SEGMENT, udp(7)).

    The system passes them on as one, which is cut at the receivers' sockets: this costs a fraction
    of sending each alone.

    Raises:
        OSError: None was sent; sent one by one, they may be accepted.
    """
    cut = socket.IPPROTO_UDP, _UDP_SEGMENT, struct.pack("@H", len(datagrams[0]))
    sender.sendmsg([b"".join(datagrams)], [cut], 0, address)


def mark(receiver: socket.socket, value: int) -> None:
    """Mark a socket that receives and never sends; an unmarked one counts as a plain program's."""
    with contextlib.suppress(OSError):
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, value)


def attach(receiver: socket.socket, program: FilterProgram) -> bool:
    """Let a socket receive only what passes a filter; if it is refused, everything: return False.

    The old filter and the new one share little memory (``net.core.optmem_max``, 20 kB before Linux
    6.7) until the old one is freed. If both together do not fit, the old one is removed first.
    """
    if not IS_LINUX:
        return False
    rows = (struct.pack("=HBBI", i.code, i.if_true, i.if_false, i.k) for i in program)
    code = array("B", b"".join(rows))  # struct sock_filter
    # struct sock_fprog: the number of instructions and their address
    argument = struct.pack("@HP", len(program), code.buffer_info()[0])
    for _ in range(2):
        with contextlib.suppress(OSError):
            receiver.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, argument)
            return True
        detach(receiver)
    return False


def detach(receiver: socket.socket) -> None:
    """Let a socket receive everything."""
    with contextlib.suppress(OSError):  # it has no filter
        receiver.setsockopt(socket.SOL_SOCKET, _SO_DETACH_FILTER, 0)


def bound_wait(receiver: socket.socket, seconds: float) -> bool:
    """Let a blocking socket wait for ``seconds`` at most; return False if it may wait longer."""
    if not IS_LINUX:
        return False
    with contextlib.suppress(OSError):
        longest = struct.pack("@ll", 0, round(seconds * 1e6))  # struct timeval
        receiver.setsockopt(socket.SOL_SOCKET, _SO_RCVTIMEO, longest)
        return True
    return False


class Buffer(NamedTuple):
    """The state of a socket's receive buffer."""

    used: int  # bytes that wait, with the kernel's overhead
    limit: int  # bytes that may wait
    dropped: int  # datagrams that the filter or the full buffer dropped


def buffer(receiver: socket.socket) -> Buffer | None:
    """Return the state of a socket's receive buffer, if known."""
    with contextlib.suppress(OSError, IndexError):
        numbers = receiver.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_MEMORY_DROPS + 1))
        found = memoryview(numbers).cast("I")
        return Buffer(found[_MEMORY_USED], found[_MEMORY_LIMIT], found[_MEMORY_DROPS])
    return None


def receive_buffer_bytes() -> int:
    """Return the largest useful receive buffer that this system grants to every user."""
    size = _WANTED_BUFFER_BYTES
    with contextlib.suppress(OSError, ValueError):
        return min(size, int(Path("/proc/sys/net/core/rmem_max").read_text()))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        while True:
            with contextlib.suppress(OSError):  # macOS refuses too large a buffer
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, size)
                return size
            size //= 2


def open_descriptors() -> set[int]:
    """Return the file descriptors of this process."""
    try:
        return {int(entry.name) for entry in Path("/proc/self/fd").iterdir()}
    except OSError:
        return set()


def own_network() -> int:
    """Return the number of this thread's network namespace; 0 if the system has none."""
    try:
        return Path("/proc/thread-self/ns/net").stat().st_ino
    except OSError:
        return 0


def network_cookie() -> int:
    """Return a number of this thread's network namespace, which no later one gets; 0 if unknown."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
            number = one.getsockopt(socket.SOL_SOCKET, _SO_NETNS_COOKIE, 8)
    except OSError:
        return 0
    return int.from_bytes(number, sys.byteorder)


def own_pid_namespace() -> int:
    """Return the number of the namespace of this process's pid; 0 if the system has none."""
    try:
        return Path("/proc/self/ns/pid").stat().st_ino
    except OSError:
        return 0


def computer_id() -> int:
    """Return a 32-bit number for this computer since its boot, and its network namespace.

    Programs with the same number share processes and loopback; containers differ.
    """
    try:
        run = Path("/proc/sys/kernel/random/boot_id").read_bytes()
    except OSError:
        run = socket.gethostname().encode()
    return zlib.crc32(b"%d %s" % (own_network(), run))
