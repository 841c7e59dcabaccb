"""The programs behind messages: names of senders, and programs on a bus that are not nodes.

A sender is named by its node, else its process, else its address. Programs that are not nodes are
seen from outside: by the ports that messages come from, and by this computer's socket table. The
names of programs on other computers, and the channels that a program subscribes to, are unknown.
"""

import os
import pwd
import socket
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

from lcmtools.bounded import BoundedDict
from lcmtools.bus.kernel import OWN_MARKS, own_pid_namespace
from lcmtools.bus.processes import Process, is_local, process_of
from lcmtools.bus.sockets import SocketTable, UdpSocket
from lcmtools.bus.url import BusUrl
from lcmtools.graph.command_line import short_name
from lcmtools.graph.model import Graph, NodeInfo, Traffic
from lcmtools.wire.packet import Sender

_Key = tuple[Process | None, int | None, str]  # process, user id, address or ""

UNKNOWN = "unknown sender"  # the name if the bus does not identify senders: tcpq, memq and logs

_MOST_SENDERS = 4000  # that are looked up, and whose processes are remembered
_RETRY = 5.0  # [s] before a sender that was not found is looked up again


def process_name(process: Process) -> str:
    """Return a process as its program's short name and its pid: "driver.py (pid 12)"."""
    return f"{short_name(process.command)} (pid {process.pid})"


class SenderNames:
    """Names of senders: by node, else by process, else by address.

    Looking up a process goes through all processes of this computer, so it is done once per sender.
    ``now`` is a monotonic clock [s]; ``called`` returns the name of a process.
    """

    def __init__(
        self,
        read: Callable[[], SocketTable] = SocketTable.read,
        now: Callable[[], float] = time.monotonic,
        called: Callable[[Process], str] = process_name,
    ) -> None:
        self._read, self._now, self._called = read, now, called
        self._nodes: dict[Sender, NodeInfo] = {}
        self._processes = BoundedDict[Sender, Process](_MOST_SENDERS)
        self._next_look = BoundedDict[Sender, float](_MOST_SENDERS)

    def update(self, senders: Iterable[Sender | None], nodes: Iterable[NodeInfo] = ()) -> None:
        """Note the nodes, and look up the processes of unknown senders, all at once."""
        self._nodes = {sender: node for node in nodes for sender in node.senders()}
        now = self._now()
        new = {sender for sender in senders if sender and self._is_unknown(sender, now)}
        for sender in new:
            self._next_look[sender] = now + _RETRY
        local = [sender for sender in new if is_local(sender.address) and not sender.name]
        table = self._read() if local else SocketTable()
        for sender in local:
            if process := table.processes(sender).only:
                self._processes[sender] = process

    def node(self, sender: Sender | None) -> NodeInfo | None:
        """Return the node that a sender belongs to."""
        return self._nodes.get(sender) if sender else None

    def process(self, sender: Sender | None) -> Process | None:
        """Return a sender's process on this computer, if known."""
        return self._processes.get(sender) if sender else None

    def name(self, sender: Sender | None) -> str:
        """Return the name of a sender; its address if nothing better is known."""
        if sender is None:
            return UNKNOWN
        if node := self.node(sender):
            return node.name
        process = self.process(sender)
        return self._called(process) if process else str(sender)

    def _is_unknown(self, sender: Sender, now: float) -> bool:
        is_known = sender in self._nodes or sender in self._processes
        return not is_known and (self._next_look.get(sender, now)) <= now


class Program(NamedTuple):
    """A program that is not a node."""

    process: Process | None  # None if the system does not show it
    user: str  # the user who runs it; "" if unknown
    address: str  # the address that its messages come from; "" for a local listener
    ports: tuple[int, ...]  # the UDP ports that it sends from
    traffic: tuple[Traffic, ...]  # its observed messages
    listens: bool | None  # True if it receives from the bus; None if unknown
    # The sockets that receive from the bus, as far as the system shows them.
    sockets: tuple[UdpSocket, ...] = ()
    # The processes that it may be, if its own is not shown.
    candidates: tuple[Process, ...] = ()
    observer: str = ""  # the relay or server that observed it; "" if it is on this bus
    bus: str = ""  # the other bus on which the relay did so

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels on which it was seen to publish, sorted, each once."""
        return tuple(sorted({seen.channel for seen in self.traffic}))


def programs(graph: Graph, url: BusUrl) -> list[Program]:
    """Return the programs on a bus that are not nodes, those of this computer first."""
    is_log = url.provider == "file"  # whose programs need not run now, or here
    table = SocketTable() if is_log else SocketTable.read()
    known = {*nodes_by_pid(graph.nodes, table.holders.values()), os.getpid()}
    found: dict[_Key, list[Traffic]] = {}
    for seen in graph.foreign():
        found.setdefault(_key(seen.sender, table), []).append(seen)
    receivers: dict[Process | None, list[UdpSocket]] = {}
    for inode in table.listening(url):
        process, row = table.holders.get(inode), table.rows[inode]
        is_own = process is None and table.marks.get(inode) in OWN_MARKS  # of another user
        if is_own or table.has_gone(inode):
            continue
        if process is None or process.pid not in known:
            found.setdefault((process, row.uid, ""), [])
        receivers.setdefault(process, []).append(row)
    made = [
        _program(key, seen, receivers, table)
        for key, seen in found.items()
        if not (key[0] and key[0].pid in known)
    ]
    return sorted(made, key=_order)


def listening_programs(graph: Graph, url: BusUrl) -> list[Program] | None:
    """Return the programs that are no nodes and receive from a bus, on channels that nobody sees.

    None if such programs are not seen, as on a server's bus.
    """
    if not url.is_multicast:
        return None
    return [program for program in programs(graph, url) if program.listens]


def is_here(node: NodeInfo) -> bool:
    """Return whether a node's process is one of this computer, so that its pid is valid here.

    False for a node in a log, behind a relay, or in a container with processes of its own.
    """
    if node.is_recorded or node.path or is_contained(node):
        return False
    if node.sender is not None and not is_local(node.sender.address):
        return False
    return node.host == socket.gethostname()


def is_contained(node: NodeInfo) -> bool:
    """Return whether a node's pid is of another namespace than those of this process."""
    return node.pid_namespace not in (0, own_pid_namespace())


def nodes_by_pid(
    nodes: Iterable[NodeInfo], processes: Iterable[Process]
) -> Mapping[int, Sequence[NodeInfo]]:
    """Return the nodes of this computer's processes by their pids here.

    A node in a container has another pid there; it is found if its process is one of these.
    """
    found: dict[int, list[NodeInfo]] = defaultdict(list)
    contained: dict[tuple[int, int], list[NodeInfo]] = defaultdict(list)
    for node in nodes:
        if is_here(node):
            found[node.pid].append(node)
        elif is_contained(node) and not (node.is_recorded or node.path):
            contained[node.pid_namespace, node.pid].append(node)
    for process in {process.pid: process for process in processes}.values() if contained else ():
        found[process.pid] += contained.get(process.innermost_pid, ())
    return {pid: some for pid, some in found.items() if some}


def is_gone(node: NodeInfo) -> bool:
    """Return whether a node's process on this computer has ended."""
    return is_here(node) and process_of(node.pid) is None


def _key(sender: Sender | None, table: SocketTable) -> _Key:
    if sender is None or sender.name or not is_local(sender.address):
        return None, None, str(sender or "")
    process = table.processes(sender).only
    users = {row.uid for row in table.sockets(sender)}
    uid = users.pop() if len(users) == 1 else None
    return process, uid, "" if process else str(sender)


def _program(
    key: _Key,
    traffic: list[Traffic],
    receivers: Mapping[Process | None, list[UdpSocket]],
    table: SocketTable,
) -> Program:
    process, uid, address = key
    senders = {seen.sender for seen in traffic if seen.sender}
    listens = process in receivers if process else None if traffic else True
    unnamed = [row for row in receivers.get(None, []) if row.uid == uid]
    maybe = (table.processes(sender).candidates for sender in senders if process is None)
    observer, bus = next(((x.observer, x.bus) for x in traffic if x.observer), ("", ""))
    places = (sender.address if observer else sender.name or sender.address for sender in senders)
    return Program(
        process,
        "" if uid is None else user_name(uid),
        next(places, address),
        tuple(sorted({sender.port for sender in senders})),
        tuple(traffic),
        listens,
        tuple(receivers.get(process, []) if process else [] if traffic else unnamed),
        tuple(chain.from_iterable(maybe)),
        observer,
        bus,
    )


def _order(program: Program) -> tuple[bool, int, str]:
    process = program.process
    return process is None, process.pid if process else 0, program.address


def user_name(uid: int) -> str:
    """Return the name of a user; the user id if unknown."""
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
