"""The UDP sockets of this computer, and the programs that have them.

One table, read once for a look. It shows neither a program's channels nor programs on other
computers. On systems other than Linux it is empty, and what it does not show is "not known".
"""

import contextlib
import os
import socket
import struct
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import cache
from ipaddress import IPv4Address
from types import MappingProxyType
from typing import NamedTuple

from lcmtools.bus.kernel import OWN_MARKS
from lcmtools.bus.processes import PROC, Process, is_local, open_files, process_of
from lcmtools.bus.url import BusUrl
from lcmtools.forks import cached_property
from lcmtools.wire.packet import Sender

_TABLES = (PROC / "net" / "udp", PROC / "net" / "udp6")  # Java's sockets are in the second
_ANY_V6, _MAPPED_V6 = "0" * 32, f"{'0' * 16}FFFF0000"  # IPv6 sockets that also receive IPv4
_ANY = "0.0.0.0"  # noqa: S104 - a comparison

_READ_PERIOD = 1.0  # [s] between two readings of the socket table
_SECOND_READING = 0.05  # [s]: sockets are marked from their first moment

_PIDFD_GETFD, _MCAST_MSFILTER = 438, 48  # asm-generic/unistd.h, linux/in.h
_NETLINK_SOCK_DIAG, _SOCK_DIAG_BY_FAMILY = 4, 20
_REQUEST_DUMP = 0x301  # NLM_F_REQUEST | NLM_F_DUMP
_ERROR, _DONE = 2, 3
_TYPE_OF_SERVICE, _MEMORY = 5, 7  # INET_DIAG_TOS, INET_DIAG_SKMEMINFO
_MEMORY_LIMIT = struct.Struct("=4xI")  # the second of its numbers (linux/sock_diag.h)
_EXTENSIONS = 1 << (_TYPE_OF_SERVICE - 1) | 1 << (_MEMORY - 1)
_ALL_STATES = 0xFFFFFFFF
_HEADER = struct.Struct("=IHHII")  # struct nlmsghdr
_ATTRIBUTE = struct.Struct("=HH")
_REQUEST = struct.Struct("=BBBBI48x")  # struct inet_diag_req_v2
_MESSAGE_BYTES, _INODE_OFFSET = 72, 68  # of struct inet_diag_msg
_TIMEOUT = 0.2  # [s]


class UdpSocket(NamedTuple):
    """A row of the system's UDP socket table."""

    address: str  # IPv4; "0.0.0.0" for any
    port: int
    inode: int  # the socket's identity
    uid: int
    drops: int  # datagrams dropped because its buffer was full
    queued_bytes: int = 0  # bytes of waiting datagrams, with the kernel's overhead


class PossibleSenders(NamedTuple):
    """The processes that may send from a local UDP port."""

    candidates: tuple[Process, ...]  # known processes, sorted by pid
    are_all: bool = True  # True if there can be no others

    @property
    def only(self) -> Process | None:
        """The only possible sender; None if there may be others."""
        return self.candidates[0] if self.are_all and len(self.candidates) == 1 else None


class SocketTable:
    """The UDP sockets of this network namespace at one time, by their inodes.

    What is behind them is read when it is first asked for.
    """

    def __init__(
        self,
        rows: Mapping[int, UdpSocket] = MappingProxyType({}),
        holders: Mapping[int, Process] | None = None,
    ) -> None:
        self.rows = rows
        if holders is not None:
            self.holders = holders

    @classmethod
    def read(cls) -> "SocketTable":
        """Read the system's table; it is empty if unknown."""
        found: list[UdpSocket] = []
        for table in _TABLES:
            with contextlib.suppress(OSError):
                rows = (_parse_row(line.split()) for line in table.read_text().splitlines()[1:])
                found += [row for row in rows if row is not None]
        return cls({row.inode: row for row in found})

    @cached_property
    def files(self) -> Mapping[int, Mapping[int, str]]:
        """The targets of the descriptors of each process that this user may inspect."""
        return open_files()

    @cached_property
    def holders(self) -> Mapping[int, Process]:
        """The process that has each socket, of those that this user may inspect."""
        return _holders(self.rows, self.files) if self.rows else {}

    @cached_property
    def marks(self) -> Mapping[int, int]:
        """The marks of sockets, as ``kernel.mark`` sets them."""
        known = ((inode, one.get(_TYPE_OF_SERVICE)) for inode, one in self._attributes.items())
        return {inode: value[0] for inode, value in known if value}

    @cached_property
    def buffers(self) -> Mapping[int, int]:
        """The sizes of the sockets' receive buffers [byte]."""
        known = ((inode, one.get(_MEMORY)) for inode, one in self._attributes.items())
        return {inode: _MEMORY_LIMIT.unpack_from(value)[0] for inode, value in known if value}

    @cached_property
    def _attributes(self) -> Mapping[int, Mapping[int, bytes]]:
        return {**dict(_attributes(socket.AF_INET)), **dict(_attributes(socket.AF_INET6))}

    def has_gone(self, inode: int) -> bool:
        """Return whether a socket was closed while its process was looked for, so that none is."""
        there = self._attributes if inode not in self.holders else {}
        return bool(there) and inode not in there

    def marked(self, *marks: int) -> frozenset[int]:
        """Return the sockets with one of these marks."""
        return frozenset(inode for inode, mark in self.marks.items() if mark in marks)

    def listening(self, url: BusUrl) -> frozenset[int]:
        """Return the sockets that receive from a multicast bus."""
        hosts = (_ANY, url.host) if url.is_multicast else ()
        rows = self.rows.values()
        return frozenset(r.inode for r in rows if r.port == url.port and r.address in hosts)

    def sockets(self, sender: Sender) -> list[UdpSocket]:
        """Return the sockets that may be a sender's; none for a sender on another computer."""
        if sender.name or not is_local(sender.address):
            return []
        return [row for row in self.rows.values() if row.port == sender.port]

    def processes(self, sender: Sender) -> PossibleSenders:
        """Return the processes that may be a sender, as far as the system shows them.

        On the bus's own port, which listeners share, only Java sends: it binds the port to any
        address, whereas liblcm, which does not send from there, binds it to the group's.
        """
        able = [r.inode for r in self.sockets(sender) if not IPv4Address(r.address).is_multicast]
        found = {self.holders[inode] for inode in able if inode in self.holders}
        ordered = sorted(found, key=lambda process: process.pid)
        return PossibleSenders(tuple(ordered), all(inode in self.holders for inode in able))

    def silent_senders(self, url: BusUrl, seen: set[int], known_pids: set[int]) -> set[int]:
        """Return the ports of programs that may publish on a bus but have not done so yet.

        LCM programs publish from an unbound socket on an ephemeral port, and join the group with
        it. Candidates are such sockets of processes that use liblcm, except processes that listen
        only on other buses. ``seen`` are ports; ``known_pids`` are processes whose publications are
        known in another way (announced nodes).
        """
        own = (row for row in self.rows.values() if os.getuid() in (0, row.uid))
        silent = [row for row in own if row.address == _ANY and row.port not in seen]
        if not silent or not joined(url.host):  # finding the owners means inspecting every file
            return set()
        known = known_pids | {os.getpid()} | self._listening_elsewhere(url.port)
        held = ((row.port, self.holders[row.inode]) for row in silent if row.inode in self.holders)
        return {port for port, process in held if process.pid not in known and process.uses_lcm}

    def _listening_elsewhere(self, group_port: int) -> set[int]:
        """Return the processes that listen to multicast groups, but to none on this port."""
        ports: dict[int, set[int]] = {}
        for inode, process in self.holders.items():
            if IPv4Address(self.rows[inode].address).is_multicast:
                ports.setdefault(process.pid, set()).add(self.rows[inode].port)
        return {pid for pid, own in ports.items() if group_port not in own}

    def joined_interfaces(self, inode: int, group: str) -> tuple[str, ...]:
        """Return the interfaces on which a socket has joined a multicast group.

        Empty if the system does not tell: it needs a copy of the socket, which root may get and, if
        Yama allows it, the process's user (pidfd_getfd(2)).
        """
        import ctypes

        if sys.platform != "linux":
            return ()
        pid = self.holders[inode].pid if inode in self.holders else 0
        files = self.files.get(pid, {}).items()
        number = next((n for n, target in files if target == f"socket:[{inode}]"), None)
        if number is None:
            return ()
        libc = ctypes.CDLL(None, use_errno=True)
        found: list[str] = []
        with contextlib.suppress(OSError):
            process = os.pidfd_open(pid)
            copy = libc.syscall(_PIDFD_GETFD, process, number, 0)
            os.close(process)
            if copy < 0:
                return ()
            for index, name in socket.if_nameindex():
                # struct group_filter, which getsockopt reads; it fails without a membership
                address = struct.pack("=HH4s", socket.AF_INET, 0, socket.inet_aton(group))
                query = struct.pack("@Ixxxx128sII", index, address, 0, 0)
                answer, size = ctypes.create_string_buffer(query), ctypes.c_uint(len(query))
                if not libc.getsockopt(copy, 0, _MCAST_MSFILTER, answer, ctypes.byref(size)):
                    found.append(name)
            os.close(copy)
        return tuple(found)


class PlainListeners:
    """The programs that listen to a bus without announcing subscriptions: unmarked sockets.

    On a system that shows no marks there may always be one.
    """

    def __init__(self, url: BusUrl, now: Callable[[], float] = time.monotonic) -> None:
        self._url = url
        self._now = now
        self._next_reading = now()
        self._possible = True
        self._foreign: frozenset[int] = frozenset()

    def possible(self, *, at_once: bool = False) -> bool:
        """Return whether there may be any, as of at most a second ago.

        Always True if datagrams leave this computer or listeners cannot be known; False within a
        single process. ``at_once`` means as of now: one seen for the first time counts too.
        """
        if self._url.provider == "memq":
            return False
        if not self._url.is_multicast or self._url.ttl:
            return True
        if at_once or self._now() >= self._next_reading:
            self._read()
        return self._possible or (at_once and bool(self._foreign))

    def _read(self) -> None:
        """Read the socket table again; a foreign socket counts once it has been seen twice.

        Its marks are read after its rows, and sockets may appear or disappear in between.
        """
        before, table = self._foreign, SocketTable.read()
        sockets = table.listening(self._url)
        self._foreign = sockets - table.marked(*OWN_MARKS) if sockets else sockets
        certain = bool(self._foreign & before)
        # If even this process's socket is missing, the system shows none. And a program that was
        # here before the first reading may have listened from the first message on.
        self._possible = not sockets or certain or (self._possible and bool(self._foreign))
        is_sure = self._foreign <= before
        self._next_reading = self._now() + (_READ_PERIOD if is_sure else _SECOND_READING)


def sockets_are_known() -> bool:
    """Return whether this system lists its UDP sockets, and which processes have them."""
    return os.access(_TABLES[0], os.R_OK)


def joined(group: str) -> tuple[str, ...]:
    """Return the interfaces on which any socket of this computer has joined a multicast group."""
    packed = f"{struct.unpack('=I', socket.inet_aton(group))[0]:08X}"
    found, interface = [], ""
    with contextlib.suppress(OSError):
        for line in (PROC / "net" / "igmp").read_text(errors="replace").splitlines()[1:]:
            columns = line.split()
            if columns and not line[0].isspace():
                interface = columns[1].rstrip(":")
            elif columns and columns[0] == packed:
                found.append(interface)
    return tuple(found)


def tcp_holders(port: int, server: int) -> frozenset[Process]:
    """Return the processes that have the connection from one port of the loopback to another.

    Empty if unknown.
    """
    ends = f" 0100007F:{port:04X} 0100007F:{server:04X} "
    with contextlib.suppress(OSError):
        rows = [row for row in (PROC / "net/tcp").read_text().splitlines() if ends in row]
        inodes = {int(row.split()[9]) for row in rows}
        return frozenset(_holders(inodes, open_files()).values()) if inodes else frozenset()
    return frozenset()


def _holders(inodes: Collection[int], files: Mapping[int, Mapping[int, str]]) -> dict[int, Process]:
    """Return the process that holds each socket."""
    targets = {f"socket:[{inode}]": inode for inode in inodes}
    found: dict[int, Process] = {}
    process_at = cache(process_of)
    for pid, of_process in files.items():
        for inode in map(targets.get, of_process.values()):
            if inode is not None and inode not in found and (process := process_at(pid)):
                found[inode] = process
    return found


def _parse_row(columns: list[str]) -> UdpSocket | None:
    """Return the socket of a row; None if it is for IPv6 only."""
    address, port = columns[1].split(":")
    if len(address) == len(_ANY_V6) and address != _ANY_V6 and address[:24] != _MAPPED_V6:
        return None
    return UdpSocket(
        address=socket.inet_ntoa(struct.pack("=I", int(address[-8:], 16))),
        port=int(port, 16),
        inode=int(columns[9]),
        uid=int(columns[7]),
        drops=int(columns[12]),
        queued_bytes=int(columns[4].partition(":")[2], 16),
    )


def _attributes(family: int) -> Iterator[tuple[int, Mapping[int, bytes]]]:
    """Yield inode and attributes of every UDP socket of this network namespace.

    One sock_diag(7) request, which any user may send, is answered with all sockets.
    """
    if sys.platform != "linux":
        return
    with (
        contextlib.suppress(OSError, struct.error),
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _NETLINK_SOCK_DIAG) as kernel,
    ):
        kernel.settimeout(_TIMEOUT)
        request = _REQUEST.pack(family, socket.IPPROTO_UDP, _EXTENSIONS, 0, _ALL_STATES)
        size = _HEADER.size + len(request)
        kernel.send(_HEADER.pack(size, _SOCK_DIAG_BY_FAMILY, _REQUEST_DUMP, 1, 0) + request)
        while data := kernel.recv(1 << 16):
            for answer, body in _records(data, _HEADER):
                if answer in (_DONE, _ERROR):
                    return
                inode = struct.unpack_from("=I", body, _INODE_OFFSET)[0]
                yield inode, dict(_records(body, _ATTRIBUTE, _MESSAGE_BYTES))


def _records(data: bytes, header: struct.Struct, start: int = 0) -> Iterator[tuple[int, bytes]]:
    """Yield kind and body of netlink's messages or attributes, whose headers begin equally."""
    while start + header.size <= len(data):
        size, kind, *_ = header.unpack_from(data, start)
        if size < header.size:
            return
        yield kind, data[start + header.size : start + size]
        start += (size + 3) & ~3
