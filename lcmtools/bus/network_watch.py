"""Membership that follows the network.

A socket joins a multicast group on the interface that the route to it has at that moment, and hears
nothing more once messages are sent over another one: a laptop that gets a cable, a network that
goes away. Whenever the system's interfaces or routes change, the sockets join their groups again.
On Linux the system reports changes (rtnetlink(7)); elsewhere there is a look once a second. There
is no thread for it: who waits for messages of a group waits for these reports too, and looks.

On Linux a socket also joins on the loopback interface, over which messages go while there is no
route at all (see ``multicast.send_to_group``).
"""

import contextlib
import errno
import os
import socket
import struct
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from weakref import WeakKeyDictionary

from lcmtools.bus.kernel import IS_LINUX

_NETLINK_ROUTE = 0
_CHANGES = 0x1 | 0x10 | 0x40 | 0x80  # RTMGRP_LINK, _IPV4_IFADDR, _IPV4_ROUTE, _IPV4_RULE
# struct nlmsghdr with RTM_GETROUTE (26) and NLM_F_REQUEST (1), struct rtmsg, and RTA_DST (1)
_ROUTE_REQUEST = struct.Struct("=IHHIIBBxxxxxxxxxxHH4s")
_NEW_ROUTE, _OUTPUT, _ATTRIBUTES = 24, 4, 28  # RTM_NEWROUTE, RTA_OIF, the offset of attributes
_ANSWER_TIME = 0.2  # [s]
_PERIOD = 1.0  # [s] between looks where the system does not report changes
LOOPBACK = 1  # number of Linux's loopback interface in every network namespace
TOLD: dict[bool, str] = {
    True: "the network has changed: messages to {group} now go over {interface}",
    False: "there is no route to {group}: messages reach only programs of this computer; "
    "see lcmtools wtf",
}
"""Sentences for whether there is a route."""


def route_interface(group: str) -> str:
    """Return the interface of the route to a group; "" if there is none or it is unknown.

    The kernel knows it: with rules for several tables, as of a VPN, the main table does not tell.
    """
    asked = _asked_interface(group)
    return _main_interface(group) if asked is None else asked


def _asked_interface(group: str) -> str | None:
    """Return the interface by the kernel's answer (rtnetlink(7)); None if it does not answer."""
    if sys.platform != "linux":
        return None
    with (
        contextlib.suppress(OSError, struct.error),
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _NETLINK_ROUTE) as kernel,
    ):
        kernel.settimeout(_ANSWER_TIME)
        kernel.send(
            _ROUTE_REQUEST.pack(
                _ROUTE_REQUEST.size, 26, 1, 1, 0, socket.AF_INET, 32, 8, 1, socket.inet_aton(group)
            )
        )
        answer = kernel.recv(4096)
        if struct.unpack_from("=H", answer, 4)[0] != _NEW_ROUTE:
            return ""  # an error: no route, or one that forbids
        at = _ATTRIBUTES
        while at + 8 <= len(answer):
            size, kind, value = struct.unpack_from("=HHI", answer, at)
            if kind == _OUTPUT:
                return socket.if_indextoname(value)
            at += max(4, (size + 3) & ~3)
    return None


def _main_interface(group: str) -> str:
    """Return the interface by the main table of routes."""
    best, found = (-1, 0), ""
    try:
        lines = Path("/proc/net/route").read_text(errors="replace").splitlines()[1:]
    except OSError:
        return ""
    own = struct.unpack("=I", socket.inet_aton(group))[0]
    for columns in map(str.split, lines):
        with contextlib.suppress(ValueError, IndexError):
            network, mask = int(columns[1], 16), int(columns[7], 16)
            rank = mask.bit_count(), -int(columns[6])  # the longest prefix, the smallest metric
            if own & mask == network and rank > best:
                best, found = rank, columns[0]
    return found


def join(receiver: socket.socket, group: str) -> bool:
    """Join a group on the interface of the route to it; return False if that is done already.

    If a socket may have no more memberships, it leaves the group on the other interfaces.

    Raises:
        OSError: There is no route, or no membership at all is permitted.
    """
    membership = struct.pack("=4sl", socket.inet_aton(group), socket.INADDR_ANY)
    try:
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            return False
        if error.errno != errno.ENOBUFS:
            raise
        _leave_everywhere(receiver, group)
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
    return True


def _leave_everywhere(receiver: socket.socket, group: str) -> None:
    latest = max((index for index, _ in socket.if_nameindex()), default=0)
    for index in range(1, latest + 1):  # also of interfaces that are gone
        membership = struct.pack("=4s4si", socket.inet_aton(group), b"", index)
        with contextlib.suppress(OSError):
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_DROP_MEMBERSHIP, membership)


def join_loopback(receiver: socket.socket, group: str) -> None:
    """Join a group on the loopback interface as well, on Linux."""
    if IS_LINUX:
        with contextlib.suppress(OSError):
            membership = struct.pack("=4s4si", socket.inet_aton(group), b"", LOOPBACK)
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)


class NetworkWatch:
    """The sockets of this process that are in multicast groups, and the reports of changes."""

    def __init__(self) -> None:
        self._members: WeakKeyDictionary[socket.socket, str] = WeakKeyDictionary()
        self._interfaces: dict[str, str] = {}  # of the routes to the groups
        self._tell: list[Callable[[str], None]] = []
        self._changes: socket.socket | None = None
        self._looking = threading.Lock()
        self._next_look = 0.0

    @property
    def descriptors(self) -> tuple[int, ...]:
        """The descriptor that is readable after a change; none if the system reports none."""
        return () if self._changes is None else (self._changes.fileno(),)

    def follow(self, receiver: socket.socket, group: str) -> None:
        """Let a socket that joins a group join again, until it is closed or freed."""
        if self._changes is None:
            self._changes = _changes()
        self._members[receiver] = group
        self._interfaces.setdefault(group, route_interface(group))

    def longest_wait(self, timeout: float | None) -> float | None:
        """Return the time to wait before ``look`` [s]: as given, if the system reports changes."""
        if self._changes is not None or not self._members:
            return timeout
        return _PERIOD if timeout is None else min(timeout, _PERIOD)

    def tell(self, listener: Callable[[str], None]) -> None:
        """Call a function with a sentence, on the thread that looks, when a route changes."""
        self._tell.append(listener)

    def forget(self, listener: Callable[[str], None]) -> None:
        """Undo ``tell``."""
        with contextlib.suppress(ValueError):
            self._tell.remove(listener)

    def leave_to_parent(self) -> None:
        """Begin again in a forked process, where another thread may have held the lock."""
        self._members.clear()
        self._interfaces.clear()
        self._tell.clear()
        self._changes, self._looking = None, threading.Lock()

    def look(self) -> None:
        """Join again where the routes lead now, if something has changed; never waits."""
        if self._members and self._looking.acquire(blocking=False):
            try:
                if self._has_changed():
                    self._join_again()
            finally:
                self._looking.release()

    def _has_changed(self) -> bool:
        """Take the reports; without any, there may be a change each second."""
        if self._changes is None:
            if is_due := (now := time.monotonic()) >= self._next_look:
                self._next_look = now + _PERIOD
            return is_due
        try:
            self._changes.recv(1 << 16)
        except OSError as error:
            return error.errno == errno.ENOBUFS  # some reports are lost
        return True

    def _join_again(self) -> None:
        for receiver, group in tuple(self._members.items()):
            with contextlib.suppress(OSError):  # no route now, or closed meanwhile
                if join(receiver, group):
                    join_loopback(receiver, group)
        for group, before in tuple(self._interfaces.items()):
            now = route_interface(group)
            if now != before:
                self._interfaces[group] = now
                text = TOLD[bool(now)].format(group=group, interface=now)
                for listener in tuple(self._tell):
                    with contextlib.suppress(Exception):  # a log, for example, whose reader ended
                        listener(text)


def _changes() -> socket.socket | None:
    """Return a socket that receives a report of each change; None if the system has none."""
    if sys.platform != "linux":
        return None
    with contextlib.suppress(OSError):  # a sandbox without netlink
        changes = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _NETLINK_ROUTE)
        changes.settimeout(0.0)
        changes.bind((0, _CHANGES))
        return changes
    return None


network_watch = NetworkWatch()
"""The watch of this process."""


def member(group: str) -> socket.socket:
    """Return a socket that is in a group and follows the network, for sockets of liblcm.

    On Linux, sockets receive what reaches the computer for any member (IP_MULTICAST_ALL, ip(7)).
    """
    joined = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    joined.settimeout(0.0)  # never blocks: liblcm's thread may read from it, see bus/liblcm
    with contextlib.suppress(OSError):  # no route now
        join(joined, group)
    network_watch.follow(joined, group)
    return joined


os.register_at_fork(after_in_child=network_watch.leave_to_parent)
