"""Programs on a bus that are no nodes: who sends what no node has announced, and who listens.

They are seen from outside: by the ports that messages come from, and by this computer's socket
table. What other computers' programs are called, and which channels a program listens to, does not
show.
"""

import os
import pwd
import socket
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lcmtools.bus.listeners import listening_sockets
from lcmtools.bus.processes import Process, UdpSocket, is_local, owners, senders_from, udp_sockets
from lcmtools.bus.url import BusUrl
from lcmtools.graph.model import Graph, Node, Traffic
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
    """The programs of a bus that are no nodes, those of this computer first."""
    traffic = graph.foreign()
    rows = {row.inode: row for row in udp_sockets()}
    sockets = listening_sockets(url)
    holders = owners(rows)
    known = {node.pid for node in graph.nodes if is_here(node)} | {os.getpid()}
    found = _senders(traffic, rows.values(), holders)
    for inode in sockets:
        process = holders.get(inode)
        if process is None or process.pid not in known:
            found.setdefault((process, rows[inode].uid if inode in rows else None, ""), [])
    ears: dict[Process | None, list[UdpSocket]] = {}
    for inode in sockets & rows.keys():
        ears.setdefault(holders.get(inode), []).append(rows[inode])
    made = [_program(key, seen, ears, rows.values(), holders) for key, seen in found.items()]
    return sorted((program for program in made if not _is(program, known)), key=_order)


def is_here(node: Node) -> bool:
    """Whether a node runs on this computer."""
    if node.sender is not None and not is_local(node.sender.address):
        return False
    return node.host == socket.gethostname()


_Key = tuple[Process | None, int | None, str]  # process, user's number, address or ""


def _senders(
    traffic: Iterable[Traffic], rows: Iterable[UdpSocket], holders: dict[int, Process]
) -> dict[_Key, list[Traffic]]:
    """What was seen, by the program that sent it."""
    by_port: dict[int, list[UdpSocket]] = {}
    for row in rows:
        by_port.setdefault(row.port, []).append(row)
    found: dict[_Key, list[Traffic]] = {}
    for seen in traffic:
        found.setdefault(_key(seen.sender, by_port, holders), []).append(seen)
    return found


def _key(
    sender: Sender | None, by_port: dict[int, list[UdpSocket]], holders: dict[int, Process]
) -> _Key:
    if sender is None or not is_local(sender.address):
        return None, None, str(sender or "")
    rows = by_port.get(sender.port, [])
    process = senders_from(sender.port, rows, holders).only
    users = {row.uid for row in rows}
    uid = users.pop() if len(users) == 1 else None
    return (process, uid, "") if process else (None, uid, str(sender))


def _program(
    key: _Key,
    traffic: list[Traffic],
    ears: Mapping[Process | None, list[UdpSocket]],
    rows: Iterable[UdpSocket],
    holders: Mapping[int, Process],
) -> Program:
    process, uid, address = key
    senders = {seen.sender for seen in traffic if seen.sender}
    listens = process in ears if process else None if traffic else True
    local = [sender for sender in senders if process is None and is_local(sender.address)]
    hidden = [row for row in ears.get(None, []) if row.uid == uid]
    return Program(
        process,
        "" if uid is None else user_name(uid),
        next((sender.address for sender in senders), address),
        tuple(sorted({sender.port for sender in senders})),
        tuple(traffic),
        listens,
        tuple(ears.get(process, []) if process else [] if traffic else hidden),
        tuple(p for s in local for p in senders_from(s.port, rows, holders).candidates),
    )


def _is(program: Program, pids: set[int]) -> bool:
    return program.process is not None and program.process.pid in pids


def _order(program: Program) -> tuple[bool, int, str]:
    process = program.process
    return process is None, process.pid if process else 0, program.address


def user_name(uid: int) -> str:
    """What a user is called; the number where that is not known."""
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
