"""Names of senders: the node's, else the process's, else the address.

Looking a process up goes through all processes of this computer, so it is done once for a sender.
"""

import time
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePath

from lcmtools.bus.processes import (
    Process,
    Senders,
    UdpSocket,
    is_local,
    owners,
    senders_from,
    udp_sockets,
)
from lcmtools.graph.model import Node
from lcmtools.wire.packet import Sender

UNKNOWN = "unknown sender"
"""The name where the bus does not tell who sends: tcpq, memq and logs."""

_RETRY = 5.0  # [s] before one that was not found is looked up again
_TAKE_A_PATH = ("-cp", "-classpath", "--class-path", "-p", "--module-path")
_INTERPRETERS = ("python", "pypy", "java", "ruby", "perl", "lua", "node", "bash", "sh")


@dataclass(frozen=True, slots=True)
class SocketTable:
    """The UDP sockets of this computer at one time, and the processes behind them.

    Attributes:
        rows: The sockets by inode.
        holders: The processes that this user may look into, by inode.
    """

    rows: Mapping[int, UdpSocket]
    holders: Mapping[int, Process]

    @classmethod
    def read(cls, ports: Collection[int] | None = None) -> "SocketTable":
        """Read the system's table; only the sockets on these local ports, where some are given."""
        rows = {row.inode: row for row in udp_sockets() if ports is None or row.port in ports}
        return cls(rows, owners(rows))

    def sockets(self, sender: Sender) -> list[UdpSocket]:
        """The sockets that a sender may be; none for a sender on another computer."""
        if not is_local(sender.address):
            return []
        return [row for row in self.rows.values() if row.port == sender.port]

    def processes(self, sender: Sender) -> Senders:
        """The processes that a sender may be, as far as the system tells."""
        return senders_from(sender.port, self.sockets(sender), self.holders)

    def process(self, sender: Sender) -> Process | None:
        """The process that a sender is, where it can be only one."""
        return self.processes(sender).only


def process_name(process: Process) -> str:
    """A process by its program's short name and its number: "driver.py (pid 12)"."""
    return f"{program_name(process.command)} (pid {process.pid})"


class SenderNames:
    """Names the senders of a bus: by node, else by process, else by address.

    Args:
        read: Reads the socket table of some local ports.
        now: A monotonic clock [s].
        called: The name of a process.
    """

    def __init__(
        self,
        read: Callable[[Collection[int]], SocketTable] = SocketTable.read,
        now: Callable[[], float] = time.monotonic,
        called: Callable[[Process], str] = process_name,
    ) -> None:
        self._read = read
        self._now = now
        self._called = called
        self._nodes: dict[Sender, Node] = {}
        self._processes: dict[Sender, Process] = {}
        self._next_look: dict[Sender, float] = {}

    def learn(self, senders: Iterable[Sender | None], nodes: Iterable[Node] = ()) -> None:
        """Take note of nodes, and look up the processes of unknown senders, all at once."""
        self._nodes = {sender: node for node in nodes for sender in node.senders()}
        now = self._now()
        new = {sender for sender in senders if sender and self._is_unknown(sender, now)}
        self._next_look.update(dict.fromkeys(new, now + _RETRY))
        local = [sender for sender in new if is_local(sender.address)]
        table = self._read({sender.port for sender in local}) if local else SocketTable({}, {})
        found = {sender: table.process(sender) for sender in local}
        self._processes.update({sender: process for sender, process in found.items() if process})

    def node(self, sender: Sender | None) -> Node | None:
        """The node that sends from there."""
        return self._nodes.get(sender) if sender else None

    def process(self, sender: Sender | None) -> Process | None:
        """The process of this computer that sends from there, where that is known."""
        return self._processes.get(sender) if sender else None

    def name(self, sender: Sender | None) -> str:
        """The name of a sender; its address where nothing better is known."""
        if sender is None:
            return UNKNOWN
        if node := self.node(sender):
            return node.name
        process = self.process(sender)
        return self._called(process) if process else str(sender)

    def _is_unknown(self, sender: Sender, now: float) -> bool:
        is_known = sender in self._nodes or sender in self._processes
        return not is_known and self._next_look.get(sender, now) <= now


def program_name(command: str) -> str:
    """The short name of a program, of an interpreter's the script's: "driver.py"."""
    words = command.split() or ["?"]
    name = PurePath(words[0]).name
    if not name.startswith(_INTERPRETERS):
        return name
    for option, word in pairwise(words):
        if option == "-c":
            return name
        if option in _TAKE_A_PATH:  # "java -cp FOLDERS Main"
            continue
        if option == "-m" or not word.startswith("-"):
            return PurePath(word).name
    return name
