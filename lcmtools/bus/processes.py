"""The process that uses a UDP port, from the socket table and this computer's processes.

Uses proc(5). On other systems, and for other users' processes, the answer is "not known", never a
guess; only whether a process runs is always known.
"""

import contextlib
import mmap
import os
import socket
import struct
import time
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from ipaddress import IPv4Address
from pathlib import Path
from typing import NamedTuple

from lcmtools.bus.kernel import computer_id

_PROC = Path("/proc")
_LCM_MARK = b"LCM_SELF_TEST"  # is in programs that are statically linked with liblcm
_SOCKET_TABLES = (_PROC / "net" / "udp", _PROC / "net" / "udp6")  # Java's sockets are in the second
_ANY_V6, _MAPPED_V6 = "0" * 32, f"{'0' * 16}FFFF0000"  # IPv6 sockets that also receive IPv4

_SESSION_DIGITS = 16  # digits of a Zenoh session's id; its first half is its computer's number


class UdpSocket(NamedTuple):
    """A row of the system's UDP socket table."""

    address: str  # IPv4; "0.0.0.0" for any
    port: int
    inode: int  # the socket's identity
    uid: int
    drops: int  # datagrams dropped because its buffer was full
    queued_bytes: int = 0  # bytes of waiting datagrams, with the kernel's overhead


class Process(NamedTuple):
    """A process of this computer."""

    pid: int
    command: str  # its command line
    start_ticks: int = 0  # its start [clock ticks since boot]; with the pid, its identity


class Usage(NamedTuple):
    """A process's use of the computer's resources."""

    uid: int
    start_time: int  # nanoseconds since 1970, to a hundredth of a second
    memory_bytes: int  # physical memory
    processor_time: float  # CPU time of all threads so far [s]


def sockets_are_known() -> bool:
    """Return whether this system lists its UDP sockets, and which processes have them."""
    return os.access(_SOCKET_TABLES[0], os.R_OK)


def udp_sockets() -> list[UdpSocket]:
    """Return all UDP sockets of this network namespace; empty if unknown."""
    found = []
    for table in _SOCKET_TABLES:
        with contextlib.suppress(OSError):
            rows = (_parse_row(line.split()) for line in table.read_text().splitlines()[1:])
            found += [row for row in rows if row is not None]
    return found


def buffer_overflows() -> int:
    """Return the number of UDP datagrams that full receive buffers dropped, since the start."""
    return network_counter("snmp", "Udp:", "RcvbufErrors")


def network_counter(file: str, group: str, name: str) -> int:
    """Return a counter of this network namespace; 0 if it is unknown.

    The file has a line of names before each line of numbers.
    """
    with contextlib.suppress(OSError, ValueError, IndexError):
        lines = (_PROC / "net" / file).read_text().splitlines()
        rows = [line.split() for line in lines if line.startswith(group)]
        return int(rows[1][rows[0].index(name)])
    return 0


class PossibleSenders(NamedTuple):
    """The processes that may send from a local UDP port."""

    candidates: tuple[Process, ...]  # known processes, sorted by pid
    are_all: bool = True  # True if there can be no others

    @property
    def only(self) -> Process | None:
        """The only possible sender; None if there may be others."""
        return self.candidates[0] if self.are_all and len(self.candidates) == 1 else None


def senders_from(
    port: int, rows: Iterable[UdpSocket], holders: Mapping[int, Process]
) -> PossibleSenders:
    """Return the possible senders from a port, from the socket table and the holders of inodes.

    On the bus's own port, which listeners share, only Java sends: it binds the port to any address,
    whereas liblcm, which does not send from there, binds it to the group's.
    """
    able = [r for r in rows if r.port == port and not IPv4Address(r.address).is_multicast]
    found = {holders[row.inode] for row in able if row.inode in holders}
    ordered = sorted(found, key=lambda process: process.pid)
    return PossibleSenders(tuple(ordered), all(row.inode in holders for row in able))


def owners(inodes: Iterable[int]) -> dict[int, Process]:
    """Return the process that holds each socket, of those that this user may inspect."""
    targets = {f"socket:[{inode}]": inode for inode in inodes}
    found: dict[int, Process] = {}
    process_at = cache(process_of)
    for pid, target in open_files() if targets else ():
        if target in targets and (process := process_at(pid)):
            found.setdefault(targets[target], process)
    return found


def tcp_holders(port: int, server: int) -> set[int]:
    """Return the pids that hold the connection from one port of the loopback to another.

    Empty if unknown.
    """
    ends = f" 0100007F:{port:04X} 0100007F:{server:04X} "
    with contextlib.suppress(OSError):
        rows = [row for row in (_PROC / "net/tcp").read_text().splitlines() if ends in row]
        return {process.pid for process in owners(int(row.split()[9]) for row in rows).values()}
    return set()


def was_told(pid: int, text: str) -> bool:
    """Return whether a text is in the environment or the command line of a process."""
    return any(text in _text(pid, name) for name in ("environ", "cmdline"))


def process_of(pid: int) -> Process | None:
    """Return the process with this pid; None if there is none (a zombie has ended).

    Where proc(5) does not show it, its command and start are unknown.
    """
    try:
        fields = _status(pid)
        command = (_PROC / str(pid) / "cmdline").read_bytes().replace(b"\0", b" ").strip()
    except OSError:  # it has ended, or /proc hides it (hidepid, another namespace)
        return Process(pid, "") if _takes_signals(pid) else None
    if fields[0] in ("Z", "X"):
        return None
    return Process(pid, command.decode("utf-8", "replace"), int(fields[19]))


def command_lines() -> Iterator[tuple[int, str]]:
    """Yield the processes with their command lines, in which a zero byte ends each word."""
    for pid in map(int, filter(str.isdigit, os.listdir(_PROC) if shows_own_pids() else ())):  # noqa: PTH208
        yield pid, _text(pid, "cmdline")


def surroundings_of(pid: int) -> tuple[int, Mapping[str, str]]:
    """Return a process's network namespace and environment; 0 and nothing if unknown."""
    network = 0
    with contextlib.suppress(OSError):
        network = (_PROC / str(pid) / "ns/net").stat().st_ino
    words = _text(pid, "environ").split("\0")
    return network, dict(word.split("=", 1) for word in words if "=" in word)


def _text(pid: int, file: str) -> str:
    """Return a file of a process; "" if it has ended, or is another user's."""
    with contextlib.suppress(OSError), open(f"{_PROC}/{pid}/{file}", "rb") as opened:  # noqa: PTH123
        return opened.read().decode("utf-8", "replace")
    return ""


def innermost_pid(pid: int) -> tuple[int, int]:
    """Return a process's pid namespace and its pid there, as in a container; zeros if unknown."""
    folder = _PROC / str(pid)
    with contextlib.suppress(OSError, StopIteration, ValueError):
        lines = (folder / "status").read_text(errors="replace").splitlines()
        pids = next(line for line in lines if line.startswith("NSpid:"))
        return (folder / "ns/pid").stat().st_ino, int(pids.split()[-1])
    return 0, 0


def is_stopped(pid: int) -> bool:
    """Return whether a process is stopped until it is continued, as after Ctrl-Z."""
    try:
        return _status(pid)[0] in ("T", "t")
    except OSError:
        return False


def _takes_signals(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except PermissionError:  # another user's process
        return True
    except (OSError, OverflowError):
        return False
    return pid > 0  # others are groups


def usage_of(pid: int) -> Usage | None:
    """Return a process's use of resources; None if unknown."""
    try:
        fields = _status(pid)
        uptime = float((_PROC / "uptime").read_text().split()[0])
        uid = (_PROC / str(pid)).stat().st_uid
    except (OSError, ValueError):
        return None
    ticks = os.sysconf("SC_CLK_TCK")
    age = uptime - int(fields[19]) / ticks
    return Usage(
        uid=uid,
        start_time=time.time_ns() - round(age * 1e9),
        memory_bytes=int(fields[21]) * os.sysconf("SC_PAGE_SIZE"),
        processor_time=(int(fields[11]) + int(fields[12])) / ticks,
    )


def shows_own_pids() -> bool:
    """Return whether /proc has the pids of this process's namespace, and not of another one."""
    with contextlib.suppress(OSError, ValueError):
        return int((_PROC / "self").readlink().name) == os.getpid()
    return False


def _status(pid: int) -> list[str]:
    """Return the fields of /proc/PID/stat after the name.

    Raises:
        OSError: There is no such process, or /proc has the pids of another namespace.
    """
    if not shows_own_pids():
        raise OSError
    status = (_PROC / str(pid) / "stat").read_bytes()
    # the name before it may contain anything, also half a character
    return status.rpartition(b")")[2].decode().split()


def is_local(address: str) -> bool:
    """Return whether an IPv4 address, or a Zenoh session, belongs to this computer."""
    if len(address) == _SESSION_DIGITS and "." not in address:
        return address.startswith(f"{computer_id():08x}")
    if address == "0.0.0.0" or address.startswith("127."):  # noqa: S104 - a comparison
        return True
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


def silent_senders(group: str, group_port: int, seen: set[int], known_pids: set[int]) -> set[int]:
    """Return the ports of programs here that may publish to the group but have not done so yet.

    LCM programs publish from an unbound socket on an ephemeral port, and join the group with it.
    Candidates are such sockets of processes that use liblcm, except processes that listen only on
    other buses. ``seen`` are ports; ``known_pids`` are processes whose publications are known in
    another way (announced nodes).
    """
    if not _is_joined(group):
        return set()
    rows = udp_sockets()
    unbound = (row for row in rows if row.address == "0.0.0.0")  # noqa: S104 - a comparison
    own = (row for row in unbound if os.getuid() in (0, row.uid))
    silent = [row for row in own if row.port not in seen]
    if not silent:  # finding the owners means inspecting every open file
        return set()
    holders = owners(row.inode for row in rows)
    known = known_pids | {os.getpid()} | _listening_elsewhere(rows, holders, group_port)
    held = ((row.port, holders[row.inode].pid) for row in silent if row.inode in holders)
    return {port for port, pid in held if pid not in known and uses_lcm(pid)}


def _listening_elsewhere(
    rows: Iterable[UdpSocket], holders: Mapping[int, Process], group_port: int
) -> set[int]:
    """Return the processes that listen to multicast groups, but to none on this port."""
    ports: dict[int, set[int]] = {}
    for row in rows:
        if row.inode in holders and IPv4Address(row.address).is_multicast:
            ports.setdefault(holders[row.inode].pid, set()).add(row.port)
    return {pid for pid, own in ports.items() if group_port not in own}


def uses_lcm(pid: int) -> bool:
    """Return whether the process has liblcm or its Python binding loaded, or linked in."""
    try:
        maps = (_PROC / str(pid) / "maps").read_bytes()
    except OSError:
        return False
    return b"liblcm" in maps or b"/_lcm" in maps or _contains(_PROC / str(pid) / "exe", _LCM_MARK)


def _contains(file: Path, text: bytes) -> bool:
    """Return whether a file contains these bytes, without reading it all into memory."""
    with (
        contextlib.suppress(OSError, ValueError),
        file.open("rb") as opened,
        mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content,
    ):
        return content.find(text) >= 0
    return False


def _is_joined(group: str) -> bool:
    """Return whether any socket of this computer has joined the multicast group."""
    number = struct.unpack("=I", socket.inet_aton(group))[0]
    try:
        return f"{number:08X}" in (_PROC / "net" / "igmp").read_text()
    except OSError:
        return False


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


def open_files() -> Iterator[tuple[int, str]]:
    """Yield pids with the targets of their descriptors, except other users' processes."""
    if not shows_own_pids():
        return
    # strings are used because thousands of Paths would take most of the time
    with contextlib.suppress(OSError):  # a system without proc(5)
        for pid in filter(str.isdigit, os.listdir(_PROC)):  # noqa: PTH208
            folder = f"{_PROC}/{pid}/fd"
            with contextlib.suppress(OSError):  # another user's, or ended meanwhile
                for descriptor in os.listdir(folder):  # noqa: PTH208
                    with contextlib.suppress(OSError):  # closed meanwhile
                        yield int(pid), os.readlink(f"{folder}/{descriptor}")  # noqa: PTH115
