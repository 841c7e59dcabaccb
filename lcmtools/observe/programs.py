"""Programs on a bus that are no nodes: who sends what no node has announced, and who listens.

They are seen from outside: by the ports that messages come from, and by this computer's socket
table. What other computers' programs are called, and which channels a program listens to, does not
show.
"""

import os
import pwd
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from lcmtools.bus.listeners import listening_sockets
from lcmtools.bus.processes import Process, UdpSocket, is_local
from lcmtools.bus.url import BusUrl
from lcmtools.graph.model import Graph, Node, Traffic
from lcmtools.observe.senders import SocketTable
from lcmtools.wire.packet import Sender


@dataclass(frozen=True, slots=True)
class Program:
    """A program that is no node.

    Attributes:
        process: Its process; None where the system does not tell.
        user: Whose process it is; "" where that is not known.
        address: Its computer's address as messages come from it; "" for a local listener.
        ports: The UDP ports that it was seen to send from.
        traffic: What it was seen to publish.
        listens: Whether it receives from the bus; None where that does not show.
        sockets: Those that it receives from the bus with, as far as that shows.
        candidates: Where its process does not show: those that it may be.
    """

    process: Process | None
    user: str
    address: str
    ports: tuple[int, ...]
    traffic: tuple[Traffic, ...]
    listens: bool | None
    sockets: tuple[UdpSocket, ...] = ()
    candidates: tuple[Process, ...] = ()

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that it was seen to publish on, sorted, each once."""
        return tuple(sorted({seen.channel for seen in self.traffic}))


def programs(graph: Graph, url: BusUrl) -> list[Program]:
    """Return the programs of a bus that are no nodes, those of this computer first."""
    table, listening = SocketTable.read(), listening_sockets(url)
    known = {node.pid for node in graph.nodes if is_here(node)} | {os.getpid()}
    found: dict[_Key, list[Traffic]] = {}
    for seen in graph.foreign():
        found.setdefault(_key(seen.sender, table), []).append(seen)
    receivers: dict[Process | None, list[UdpSocket]] = {}
    for inode in listening:
        process, row = table.holders.get(inode), table.rows.get(inode)
        if process is None or process.pid not in known:
            found.setdefault((process, row.uid if row else None, ""), [])
        if row:
            receivers.setdefault(process, []).append(row)
    made = (_program(key, seen, receivers, table) for key, seen in found.items())
    return sorted(
        (one for one in made if not (one.process and one.process.pid in known)), key=_order
    )


def is_here(node: Node) -> bool:
    """Return whether a node runs on this computer."""
    if node.sender is not None and not is_local(node.sender.address):
        return False
    return node.host == socket.gethostname()


_Key = tuple[Process | None, int | None, str]  # process, user's number, address or ""


def _key(sender: Sender | None, table: SocketTable) -> _Key:
    if sender is None or not is_local(sender.address):
        return None, None, str(sender or "")
    process = table.process(sender)
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
    return Program(
        process,
        "" if uid is None else user_name(uid),
        next((sender.address for sender in senders), address),
        tuple(sorted({sender.port for sender in senders})),
        tuple(traffic),
        listens,
        tuple(receivers.get(process, []) if process else [] if traffic else unnamed),
        tuple(chain.from_iterable(maybe)),
    )


def _order(program: Program) -> tuple[bool, int, str]:
    process = program.process
    return process is None, process.pid if process else 0, program.address


def user_name(uid: int) -> str:
    """Return the name of a user; the number where that is not known."""
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
