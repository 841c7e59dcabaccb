"""The sockets of this computer that receive from the bus, and whether their programs keep up.

A socket's counter of drops includes the datagrams that its filter drops. The system's counter has
only the drops of full buffers, of all sockets.

liblcm's thread empties the socket also while a callback of the program hangs. It keeps one byte in
a pipe for as long as messages wait, and each call of ``handle`` reads it (lcm-proj/lcm,
lcm/lcm_udpm.c). Must not judge.
"""

import contextlib
import fcntl
import os
import struct
import termios
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from lcmtools.bus import kernel
from lcmtools.bus.processes import PROC, Process, process_of
from lcmtools.bus.sockets import SocketTable, UdpSocket
from lcmtools.bus.url import BusUrl
from lcmtools.doctor.evidence import Listener
from lcmtools.doctor.lcm_processes import ProgramNames
from lcmtools.graph.command_line import interpreter
from lcmtools.graph.model import NodeInfo
from lcmtools.observe.reading.senders import user_name

_BEHIND = 0.5  # share of its buffer that is full if a program reads too slowly


class BufferDrops:
    """The drops between two readings of the table of sockets by inode.

    ``filtered`` sockets have a filter that drops on purpose. ``overflows`` are the drops of full
    buffers of all sockets between the two readings.
    """

    def __init__(
        self,
        before: Mapping[int, UdpSocket],
        after: Mapping[int, UdpSocket],
        filtered: Collection[int],
        overflows: int,
    ) -> None:
        self._before, self._after, self._filtered = before, after, filtered
        others = sum(self._counted(one) for one in after if one not in filtered)
        self._unexplained = max(0, overflows - others)

    def of(self, inode: int, buffer_bytes: int | None) -> int:
        """Return a socket's dropped datagrams. For a filtered socket this is an upper bound."""
        counted = self._counted(inode)
        if inode not in self._filtered:
            return counted
        rows = [row for table in (self._before, self._after) if (row := table.get(inode))]
        queued = max((row.queued_bytes for row in rows), default=0)
        is_behind = bool(buffer_bytes) and queued >= _BEHIND * (buffer_bytes or 0)
        return min(counted, self._unexplained) if is_behind else 0

    def _counted(self, inode: int) -> int:
        was, now = self._before.get(inode), self._after.get(inode)
        return max(0, now.drops - was.drops) if was and now else 0


class Waiting(NamedTuple):
    """The pipes of a process that have a byte, and how often the process has read anything."""

    reads: str  # the number of its calls of read(), as /proc has it; "" if unknown
    pipes: frozenset[str]  # of which it has both ends ("pipe:[4711]")

    @classmethod
    def of(cls, process: Process, files: Mapping[int, str]) -> "Waiting":
        """Return this of a process now, by its descriptors."""
        reads = process.text("io").partition("syscr: ")[2].split("\n")[0]
        pipes = {number: name for number, name in files.items() if name.startswith("pipe:")}
        ends, folder = Counter(pipes.values()), f"{PROC}/{process.pid}/fd"
        full = (n for file, n in pipes.items() if ends[n] > 1 and _has_one_byte(f"{folder}/{file}"))
        return cls(reads, frozenset(full) if reads else frozenset())


def waiting(table: SocketTable, on_bus: Collection[int]) -> dict[int, Waiting]:
    """Return the messages that wait for the processes that receive from the bus."""
    listening = {table.holders[inode] for inode in on_bus if inode in table.holders}
    listening = {process for process in listening if process.pid != os.getpid()}
    return {one.pid: Waiting.of(one, table.files.get(one.pid, {})) for one in listening}


def _hanging(earlier: Mapping[int, Waiting], table: SocketTable) -> frozenset[int]:
    """Return the processes for which messages waited, and which have read nothing since then."""
    unread: dict[int, frozenset[str]] = {}
    for pid, was in earlier.items():
        process = Process(pid)
        if was.pipes and process.uses_lcm:
            now = Waiting.of(process, table.files.get(pid, {}))
            unread[pid] = was.pipes & now.pipes if now.reads == was.reads else frozenset()
    wanted = frozenset(chain.from_iterable(unread.values()))
    # those that several processes have are not liblcm's
    held = (wanted.intersection(files.values()) for files in table.files.values() if wanted)
    holders = Counter(chain.from_iterable(held))
    return frozenset(pid for pid, pipes in unread.items() if any(holders[n] == 1 for n in pipes))


def _has_one_byte(file: str) -> bool:
    with contextlib.suppress(OSError):
        opened = os.open(file, os.O_RDONLY | os.O_NONBLOCK)
        try:
            (size,) = struct.unpack("i", fcntl.ioctl(opened, termios.FIONREAD, bytes(4)))
        finally:
            os.close(opened)
        return bool(size == 1)
    return False


def listeners(
    url: BusUrl,
    before: SocketTable,
    earlier: Mapping[int, Waiting],
    names: ProgramNames,
    overflows: int,
) -> tuple[Listener, ...]:
    """Return the sockets that have received from the bus since the table ``before`` was read.

    ``earlier`` are the messages that waited then; ``overflows`` are the drops of full buffers.
    """
    after = names.table
    # a channel socket's kernel counters mean nothing: its filter drops nearly everything
    selective = after.marked(kernel.SELECTIVE)
    filtered = selective | after.marked(kernel.SUBSCRIBED, kernel.UNFILTERED)
    drops = BufferDrops(before.rows, after.rows, filtered, overflows)
    hung = _hanging(earlier, after)
    found = []
    for inode in (before.listening(url) & after.listening(url)) - selective:
        row, process = after.rows[inode], after.holders.get(inode)
        if process and (process.pid == os.getpid() or _never_reads(process)):
            continue
        if after.has_gone(inode) or (process and process_of(process.pid) is None):
            continue  # it was killed meanwhile
        nodes = names.by_pid.get(process.pid, []) if process else []
        found.append(
            Listener(
                names.of_process(process) if process else f"a program of {user_name(row.uid)}",
                process.pid if process else None,
                row.uid,
                drops=drops.of(inode, after.buffers.get(inode)),
                queued_bytes=row.queued_bytes,
                was_queued_bytes=before.rows[inode].queued_bytes,
                buffer_bytes=after.buffers.get(inode),
                state=process.state if process else "",
                is_tool=process is not None and _is_tool(process, nodes),
                is_node=bool(nodes),
                joined=after.joined_interfaces(inode, url.host),
                interpreter=interpreter(process.command) if process else "",
                is_unfiltered=after.marks.get(inode) == kernel.UNFILTERED,
                hangs=process is not None and process.pid in hung,
            )
        )
    return tuple(sorted(found, key=lambda listener: (listener.pid or 0, listener.name)))


def _never_reads(process: Process) -> bool:
    """Return whether a process only sends, although it has a socket that receives.

    lcm.jar has a socket that receives even for sending, and starts the thread that reads it with
    the first subscription.
    """
    if Path(process.words[0]).name != "java":
        return False
    return not any(name.startswith("Thread-") for name in process.of_threads("comm"))


def _is_tool(process: Process, nodes: Sequence[NodeInfo]) -> bool:
    """Return whether a process is a command of lcmtools. Its filter drops datagrams on purpose."""
    if nodes:
        return all(node.tool for node in nodes)
    return any(Path(word).name == "lcmtools" for word in process.command.split()[:3])
