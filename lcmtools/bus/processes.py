"""Which process is behind a UDP port: the socket table and the processes of this computer.

Linux only (/proc). Elsewhere, and for other users' processes, the answer is "not known", never a
guess. See proc(5).
"""

import contextlib
import os
import socket
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

_PROC = Path("/proc")
_SOCKET_TABLE = _PROC / "net" / "udp"


@dataclass(frozen=True, slots=True)
class UdpSocket:
    """A row of the system's UDP socket table.

    Attributes:
        address: Local IPv4 address; "0.0.0.0" for any.
        port: Local port.
        inode: The socket's identity.
        uid: The user it belongs to.
        drops: Datagrams that the kernel dropped because its buffer was full.
    """

    address: str
    port: int
    inode: int
    uid: int
    drops: int


@dataclass(frozen=True, slots=True)
class Process:
    """A process of this computer.

    Attributes:
        pid: Its number.
        command: Its command line.
        start_ticks: When it started, in clock ticks since boot: with the pid, its identity.
    """

    pid: int
    command: str
    start_ticks: int = 0


def udp_sockets() -> list[UdpSocket]:
    """All UDP sockets of this network namespace; empty where the system does not tell."""
    try:
        lines = _SOCKET_TABLE.read_text().splitlines()[1:]
    except OSError:
        return []
    return [_parse_row(line.split()) for line in lines]


def process_of_port(port: int) -> Process | None:
    """The process that owns the UDP socket on this local port; None when it is not known.

    A port that several processes share (the group's own, which Java also sends from) tells nothing.
    """
    inodes = {row.inode for row in udp_sockets() if row.port == port}
    found = {process.pid: process for process in owners(inodes).values()}
    return next(iter(found.values())) if len(found) == 1 else None


def owners(inodes: Iterable[int]) -> dict[int, Process]:
    """The process that holds each socket, for the processes that this user may look into."""
    wanted = {f"socket:[{inode}]": inode for inode in inodes}
    found: dict[int, Process] = {}
    for pid in _pids() if wanted else ():
        for target in _open_files(pid):
            if target in wanted and (process := process_of(pid)):
                found.setdefault(wanted[target], process)
    return found


def process_of(pid: int) -> Process | None:
    """What runs under this pid; None when nothing does (any more: a zombie has ended)."""
    try:
        command = (_PROC / str(pid) / "cmdline").read_bytes().replace(b"\0", b" ").strip()
        status = (_PROC / str(pid) / "stat").read_text()
    except OSError:
        return None
    fields = status.rpartition(")")[2].split()  # the name before it may contain anything
    if fields[0] in ("Z", "X"):
        return None
    return Process(pid, command.decode("utf-8", "replace"), int(fields[19]))


def is_local(address: str) -> bool:
    """Whether an IPv4 address is one of this computer's."""
    if address == "0.0.0.0" or address.startswith("127."):  # noqa: S104 - a comparison
        return True
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


def unheard_senders(group: str, heard_ports: set[int], known_pids: set[int]) -> set[int]:
    """Ports of programs on this computer that may publish to the group but were not heard yet.

    LCM programs publish from an unbound socket on an ephemeral port, and join the group with it.
    Candidates are such sockets of processes that use liblcm and are not among ``known_pids``.

    Args:
        group: The multicast group.
        heard_ports: UDP ports that were heard already.
        known_pids: Processes whose publications are known otherwise (announced nodes).
    """
    if not _is_joined(group):
        return set()
    candidates = {
        row.inode: row.port
        for row in udp_sockets()
        if row.address == "0.0.0.0" and row.port not in heard_ports  # noqa: S104 - a comparison
    }
    listeners_elsewhere = known_pids | {os.getpid()}
    return {
        candidates[inode]
        for inode, process in owners(candidates).items()
        if process.pid not in listeners_elsewhere and _uses_lcm(process.pid)
    }


def _uses_lcm(pid: int) -> bool:
    """Whether the process has liblcm or its Python binding loaded."""
    try:
        maps = (_PROC / str(pid) / "maps").read_bytes()
    except OSError:
        return False
    return b"liblcm" in maps or b"/_lcm" in maps


def _is_joined(group: str) -> bool:
    """Whether any socket of this computer has joined the multicast group."""
    packed = struct.unpack("=I", socket.inet_aton(group))[0]
    try:
        return f"{packed:08X}" in (_PROC / "net" / "igmp").read_text()
    except OSError:
        return False


def _parse_row(columns: list[str]) -> UdpSocket:
    address, port = columns[1].split(":")
    packed = struct.pack("=I", int(address, 16))
    return UdpSocket(
        address=socket.inet_ntoa(packed),
        port=int(port, 16),
        inode=int(columns[9]),
        uid=int(columns[7]),
        drops=int(columns[12]),
    )


def _pids() -> list[int]:
    try:
        return [int(entry.name) for entry in _PROC.iterdir() if entry.name.isdigit()]
    except OSError:
        return []


def _open_files(pid: int) -> list[str]:
    """What the process's file descriptors point to; empty for other users' processes."""
    targets: list[str] = []
    with contextlib.suppress(OSError):
        for descriptor in (_PROC / str(pid) / "fd").iterdir():
            with contextlib.suppress(OSError):  # closed meanwhile
                targets.append(str(descriptor.readlink()))
    return targets
