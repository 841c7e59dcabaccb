"""Collecting the evidence: all that ``wtf`` reads from the outside, once."""

import contextlib
import os
import shlex
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from lcmtools.bus.listeners import listening_sockets
from lcmtools.bus.processes import Process, UdpSocket, is_local, owners, senders_from, udp_sockets
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.socket_diag import receive_buffers, selective_sockets
from lcmtools.bus.url import BusUrl
from lcmtools.doctor.computers import HostClock
from lcmtools.doctor.elsewhere import with_topics
from lcmtools.doctor.host import (
    busy_time,
    host,
    lcm_processes,
    never_reads,
    reassembly_failures,
    state_of,
    waited_time,
)
from lcmtools.doctor.listening import Listening
from lcmtools.doctor.model import Evidence, Listener, SenderFacts, SimClock
from lcmtools.errors import BusError
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.graph.protocol import PERIOD
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import is_here, user_name
from lcmtools.wire.packet import Sender

_NAME_CHARACTERS = 60
_CLOCK_SPAN = 0.3  # [s] of ticks that tell how fast simulated time is
_TOOL = "lcmtools"


def collect(url: BusUrl, environment: Mapping[str, str], listen: float) -> Evidence:
    """Look at a bus for ``listen`` seconds. A bus that does not work is evidence, not an error."""
    here = host(url, environment)
    evidence = Evidence(url=str(url), ttl=url.ttl if url.is_multicast else 0, host=here)
    failures = reassembly_failures()
    try:
        with BusMonitor(url, "wtf", environment, whole=True) as monitor:
            evidence = _look(monitor, evidence, listen)
    except BusError as error:
        return replace(evidence, bus_problem=error.what, bus_remedy=error.hint)
    stale = {node.id for node in evidence.graph.nodes if node.stale}
    records = NodeRecords(url, environment)
    evidence = replace(
        evidence,
        hushed=records.topics(stale, Role.PUBLISHER),
        deafened=records.topics(stale, Role.SUBSCRIBER),
    )
    failed = reassembly_failures() - failures
    return replace(evidence, host=replace(here, reassembly_failures=failed))


def _look(monitor: BusMonitor, evidence: Evidence, listen: float) -> Evidence:
    before = monitor.settle(foreign=False)
    table, busy_before, start = _Table.read(monitor.url), _busy_nodes(before), time.monotonic()
    waited_before = {one.pid: waited_time(one.pid) for one in table.holders.values()}
    listening = Listening(lambda topic: monitor.graph().topic(topic).types)
    with contextlib.suppress(EOFError):  # a log has ended
        for packet in monitor.packets(listen):
            listening.hear(packet)
    after = _counted_again(monitor, listening, listen)
    later, seconds = _Table.read(monitor.url), time.monotonic() - start
    busy = {
        pid: (spent - busy_before.get(pid, spent)) / 1e9 / seconds
        for pid, spent in _busy_nodes(after).items()
    }
    names = _Names(after, later)
    return replace(
        evidence,
        before=before,
        graph=after,
        listened=listen,
        malformed=_malformed(monitor, names),
        own_drops=(monitor.tap.drops() if monitor.tap else None) or 0,
        senders=_senders(monitor, names),
        streams=tuple(replace(s, pid=names.pid(s.sender)) for s in listening.streams(names.of)),
        listeners=_listeners(table, later, names),
        oddities=listening.oddities(names.of),
        clock=_clock(listening, after, names, busy),
        processes=with_topics(
            lcm_processes(monitor.url, later.rows.values(), later.holders, _heard_ports(monitor)),
            after,
        ),
        waited=_longest_wait(waited_before),
        users={uid: user_name(uid) for uid in {row.uid for row in later.rows.values()}},
        clocks=_clocks(after),
        remote=frozenset(node.id for node in after.nodes if not is_here(node)),
    )


def _counted_again(monitor: BusMonitor, listening: Listening, listen: float) -> Graph:
    """The graph with the nodes' counters as they are at the end, where it was long enough."""
    if listen >= PERIOD / 10:
        monitor.probe()
        with contextlib.suppress(EOFError):
            for packet in monitor.packets(0.05):
                listening.hear(packet)
    return monitor.graph()


def _heard_ports(monitor: BusMonitor) -> set[int]:
    """The ports that messages have come from."""
    return {sender.port for sender in monitor.tap.sequences} if monitor.tap else set()


def _longest_wait(before: Mapping[int, int]) -> float:
    """How long any of the processes has waited for a processor since [s]."""
    own = os.getpid()
    waits = [waited_time(pid) - spent for pid, spent in before.items() if pid != own]
    return max(0, *waits, 0) / 1e9


@dataclass(frozen=True, slots=True)
class _Table:
    """The UDP sockets of this computer at one time.

    Attributes:
        rows: By inode.
        holders: The processes that this user may look into.
        on_bus: Those that receive from the bus.
    """

    rows: Mapping[int, UdpSocket]
    holders: Mapping[int, Process]
    on_bus: frozenset[int]

    @classmethod
    def read(cls, url: BusUrl) -> "_Table":
        if not url.is_multicast:
            return cls({}, {}, frozenset())
        rows = {row.inode: row for row in udp_sockets()}
        return cls(rows, owners(rows), listening_sockets(url))


class _Names:
    """What people call senders and processes."""

    def __init__(self, graph: Graph, table: _Table) -> None:
        self._nodes = {sender: node for node in graph.nodes for sender in node.senders()}
        self._table = table
        self._by_pid: dict[int, list[Node]] = {}
        for node in graph.nodes:
            if is_here(node):
                self._by_pid.setdefault(node.pid, []).append(node)

    def of(self, sender: Sender | None) -> str:
        """A sender's node or program, else its address."""
        if sender is None:
            return "somebody"
        node = self._nodes.get(sender)
        if node:
            return node.name
        process = self.process(sender)
        return f"{self.of_process(process)}" if process else str(sender)

    def pid(self, sender: Sender | None) -> int | None:
        """A sender's process on this computer."""
        node = self._nodes.get(sender) if sender else None
        if node:
            return node.pid if is_here(node) else None
        process = self.process(sender) if sender else None
        return process.pid if process else None

    def node(self, sender: Sender) -> Node | None:
        """The node that sends from there."""
        return self._nodes.get(sender)

    def nodes_of(self, pid: int) -> list[Node]:
        """The nodes of a process of this computer."""
        return self._by_pid.get(pid, [])

    def rows(self, sender: Sender) -> list[UdpSocket]:
        """The sockets of this computer that a sender may be."""
        if not is_local(sender.address):
            return []
        return [row for row in self._table.rows.values() if row.port == sender.port]

    def process(self, sender: Sender) -> Process | None:
        """A sender's process, where it can only be one."""
        return senders_from(sender.port, self.rows(sender), self._table.holders).only

    def of_process(self, process: Process) -> str:
        """A process's nodes, or its command, with its number."""
        nodes = self.nodes_of(process.pid)
        called = ", ".join(node.name for node in nodes) or process.called(_NAME_CHARACTERS)
        return f"{called} (pid {process.pid})"


def _malformed(monitor: BusMonitor, names: _Names) -> tuple[tuple[str, str], ...]:
    found = monitor.tap.malformed if monitor.tap else {}
    rows = []
    for sender, reason in found.items():
        process = names.process(sender)
        who = f"{sender}, {names.of_process(process)}" if process else str(sender)
        rows.append((who, reason))
    return tuple(rows)


def _senders(monitor: BusMonitor, names: _Names) -> tuple[SenderFacts, ...]:
    tap = monitor.tap
    if tap is None:
        return ()
    facts, numbered = [], tap.numbered
    for sender, sequence in tap.sequences.items():
        if sender.port == tap.port:
            continue
        users = {row.uid for row in names.rows(sender)}
        node = names.node(sender)
        facts.append(
            SenderFacts(
                sender,
                names.of(sender),
                is_local=is_local(sender.address),
                messages=sequence.messages,
                lost=sequence.lost if sender in numbered else 0,
                ttl=tap.ttls.get(sender),
                uid=users.pop() if len(users) == 1 else None,
                paces=node is not None,
            )
        )
    return tuple(facts)


def _clocks(graph: Graph) -> tuple[HostClock, ...]:
    """The other computers' clocks; a computer's quickest announcement tells most."""
    lags: dict[tuple[str, str], dict[str, float]] = {}
    for node in graph.nodes:
        if node.lag is not None and node.sender and not is_here(node):
            place = node.host, node.sender.address
            lags.setdefault(place, {})[node.name] = node.lag / 1e9
    return tuple(
        HostClock(*place, min(nodes.values()), tuple(nodes)) for place, nodes in lags.items()
    )


def _listeners(before: _Table, after: _Table, names: _Names) -> tuple[Listener, ...]:
    buffers = receive_buffers()
    found = []
    # of a mailbox the kernel's numbers tell nothing: its filter drops nearly all that comes
    for inode in (before.on_bus & after.on_bus) - selective_sockets():
        row, earlier = after.rows.get(inode), before.rows.get(inode)
        process = after.holders.get(inode)
        if row is None or earlier is None or (process and process.pid == os.getpid()):
            continue
        if process and never_reads(process.pid):
            continue
        found.append(
            Listener(
                names.of_process(process) if process else f"a program of user {row.uid}",
                process.pid if process else None,
                row.uid,
                drops=max(0, row.drops - earlier.drops),
                queued_bytes=row.queued_bytes,
                was_queued_bytes=earlier.queued_bytes,
                buffer_bytes=buffers.get(inode),
                state=state_of(process.pid) if process else "",
                is_tool=process is not None and _is_tool(process, names),
                is_node=process is not None and bool(names.nodes_of(process.pid)),
            )
        )
    return tuple(sorted(found, key=lambda listener: (listener.pid or 0, listener.name)))


def _is_tool(process: Process, names: _Names) -> bool:
    """Whether a process is a command of lcmtools that looks, and whose filter drops on purpose."""
    nodes = names.nodes_of(process.pid)
    if nodes:
        return all(node.tool for node in nodes)
    return any(Path(word).name == _TOOL for word in process.command.split()[:3])


def _busy_nodes(graph: Graph) -> dict[int, int]:
    """How long the local publishers of ``/clock`` have computed so far [ns]."""
    publishers = graph.topic("/clock").publishers
    return {node.pid: busy_time(node.pid) for node, _ in publishers if is_here(node)}


def _clock(
    listening: Listening, graph: Graph, names: _Names, busy: Mapping[int, float]
) -> SimClock | None:
    ticks = listening.clock_ticks
    if len(ticks) < 2:  # noqa: PLR2004 - an interval
        return None
    seconds = (ticks[-1][0] - ticks[0][0]) / 1e9
    if seconds < _CLOCK_SPAN or any(later[1] < earlier[1] for earlier, later in pairwise(ticks)):
        return None
    sender = listening.clock_sender
    node = names.node(sender) if sender else None
    if node is None:
        found = [n for n, e in graph.topic("/clock").publishers if e.role is Role.PUBLISHER]
        node = found[0] if len(found) == 1 else None
    return SimClock(
        names.of(sender),
        _steady_ratio(ticks),
        _wanted_rate(node.command) if node else 1.0,
        busy.get(node.pid) if node and is_here(node) else None,
    )


def _steady_ratio(ticks: Sequence[tuple[int, int]]) -> float:
    """Simulated seconds in a second, in the best quarter: one stumble is no slowness."""
    step = max(1, (len(ticks) - 1) // 4)
    parts = [(ticks[n], ticks[n + step]) for n in range(0, len(ticks) - step, step)]
    return max((b[1] - a[1]) / max(1, b[0] - a[0]) for a, b in parts)


def _wanted_rate(command: str) -> float | None:
    """The --rate of a simulator's command line; 1 without, None where it says 0."""
    try:
        words = shlex.split(command.replace("--rate=", "--rate "))
    except ValueError:
        return 1.0
    for option, value in pairwise(words):
        if option == "--rate":
            with contextlib.suppress(ValueError):
                return float(value) or None
    return 1.0
