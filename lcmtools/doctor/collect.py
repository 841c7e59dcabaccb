"""Collecting the evidence: all that ``wtf`` reads from the outside, once."""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from lcmtools.bus.kernel import receive_buffers, selective_sockets
from lcmtools.bus.listeners import listening_sockets
from lcmtools.bus.processes import Process, is_local
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import BusUrl
from lcmtools.doctor import host as computer
from lcmtools.doctor import programs
from lcmtools.doctor.evidence import (
    Evidence,
    HostClock,
    Listener,
    SenderFacts,
    SimulatedClock,
)
from lcmtools.doctor.listening import Listening, target_rate
from lcmtools.errors import BusError, UsageError
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.graph.protocol import PERIOD
from lcmtools.observe.losses import losses
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.senders import SocketTable, is_here, user_name

_REQUESTS = 5  # for announcements at the end of a look, at most
_ANSWER_TIME = 0.05  # [s] several times what nodes need


def collect(url: BusUrl, environment: Mapping[str, str], listen: float) -> Evidence:
    """Look at a bus for ``listen`` seconds. A bus that does not work is evidence, not an error."""
    here = computer.host(url, environment)
    evidence = Evidence(url=str(url), ttl=url.ttl if url.is_multicast else 0, host=here)
    failures = computer.reassembly_failures()
    try:
        with BusMonitor(url, "wtf", environment, whole=True) as monitor:
            evidence = _look(monitor, evidence, listen)
    except BusError as error:
        return replace(evidence, bus_problem=error.what, bus_remedy=error.hint)
    stale = {node.id for node in evidence.graph.nodes if node.stale}
    records = NodeRecords(url, environment)
    return replace(
        evidence,
        stale_published=records.topics(stale, Role.PUBLISHER),
        stale_subscribed=records.topics(stale, Role.SUBSCRIBER),
        host=replace(here, reassembly_failures=computer.reassembly_failures() - failures),
    )


def unusable(error: UsageError) -> Evidence:
    """The evidence where the environment names the bus wrongly."""
    remedy = error.hint.replace("write 'udpm:", "export LCM_DEFAULT_URL='udpm:")
    return Evidence(url="", bus_problem=error.what, bus_remedy=remedy)


def _look(monitor: BusMonitor, evidence: Evidence, listen: float) -> Evidence:
    before = monitor.settle(foreign=False)
    table, on_bus = _sockets(monitor.url)
    busy_before, start = _clock_busy(before), time.monotonic()
    waited_before = {one.pid: programs.waited_time(one.pid) for one in table.holders.values()}
    listening = Listening(monitor.types_of)
    _take(monitor, listening, listen)
    after = _counted_again(monitor, listening, listen)
    later, still_on_bus = _sockets(monitor.url)
    seconds = time.monotonic() - start
    busy = {
        pid: (spent - busy_before.get(pid, spent)) / 1e9 / seconds
        for pid, spent in _clock_busy(after).items()
    }
    names = programs.ProgramNames(monitor, listening, after, later)
    ports = {sender.port for sender in monitor.tap.sequences} if monitor.tap else set()
    processes = programs.lcm_processes(monitor.url, later.rows.values(), later.holders, ports)
    return replace(
        evidence,
        before=before,
        graph=after,
        listened=listen,
        malformed=names.malformed(monitor),
        own_drops=(monitor.tap.drops() if monitor.tap else None) or 0,
        senders=_senders(monitor, names),
        streams=tuple(
            replace(one, name=names.senders.name(one.sender), pid=names.pid(one))
            for one in listening.streams()
        ),
        listeners=_listeners(on_bus & still_on_bus, table, names),
        oddities=listening.oddities(names.senders.name),
        clock=_clock(listening, after, names, busy),
        processes=programs.with_topics(processes, after),
        processor_wait=_longest_wait(waited_before),
        users={uid: user_name(uid) for uid in {row.uid for row in later.rows.values()}},
        clocks=_clocks(after),
        remote=frozenset(node.id for node in after.nodes if not is_here(node)),
    )


def _take(monitor: BusMonitor, listening: Listening, seconds: float) -> None:
    for packet in monitor.packets(seconds):
        listening.take(packet)


def _counted_again(monitor: BusMonitor, listening: Listening, listen: float) -> Graph:
    """The graph with the nodes' counters as they are at the end, if the look was long enough.

    The request for them, or an answer, may be lost between computers, and a sender there would be
    reported by its address, although it is a node. So the request is repeated until every sender on
    another computer has its node. Plain LCM programs never answer, hence the limit: where one
    datagram in ten is lost, five requests without an answer happen once in 4,000 looks.
    """
    for _ in range(_REQUESTS if listen >= PERIOD / 10 else 0):
        monitor.probe()
        _take(monitor, listening, _ANSWER_TIME)
        senders = (seen.sender for seen in monitor.graph().foreign())
        if all(sender is None or is_local(sender.address) for sender in senders):
            break
    return monitor.graph()


def _longest_wait(before: Mapping[int, int]) -> float:
    """The longest time that a process has waited for a processor since [s]."""
    waits = (programs.waited_time(pid) - t for pid, t in before.items() if pid != os.getpid())
    return max(0, *waits, 0) / 1e9


def _sockets(url: BusUrl) -> tuple[SocketTable, frozenset[int]]:
    """This computer's UDP sockets, and the inodes of those that receive from the bus."""
    if not url.is_multicast:
        return SocketTable({}, {}), frozenset()
    return SocketTable.read(), listening_sockets(url)


def _senders(monitor: BusMonitor, names: programs.ProgramNames) -> tuple[SenderFacts, ...]:
    tap = monitor.tap
    if tap is None:
        return ()
    facts, lost = [], losses(monitor.numbered)
    for sender, sequence in tap.sequences.items():
        if sender.port == tap.port:
            continue
        users = {row.uid for row in names.table.sockets(sender)}
        facts.append(
            SenderFacts(
                sender,
                names.senders.name(sender),
                is_local=is_local(sender.address),
                messages=sequence.messages,
                lost=lost[sender].lost if sender in lost else 0,
                ttl=tap.ttls.get(sender),
                uid=users.pop() if len(users) == 1 else None,
                paces=names.senders.node(sender) is not None,
            )
        )
    return tuple(facts)


def _clocks(graph: Graph) -> tuple[HostClock, ...]:
    """The other computers' clocks; a computer's quickest announcement counts."""
    lags: dict[tuple[str, str], dict[str, float]] = {}
    for node in graph.nodes:
        if node.lag is not None and node.sender and not is_here(node):
            place = node.host, node.sender.address
            lags.setdefault(place, {})[node.name] = node.lag / 1e9
    return tuple(HostClock(*place, min(of.values()), tuple(of)) for place, of in lags.items())


def _listeners(
    on_bus: frozenset[int], before: SocketTable, names: programs.ProgramNames
) -> tuple[Listener, ...]:
    buffers, after = receive_buffers(), names.table
    found = []
    # the kernel's numbers mean nothing for a channel socket: its filter drops nearly everything
    for inode in on_bus - selective_sockets():
        row, earlier = after.rows.get(inode), before.rows.get(inode)
        process = after.holders.get(inode)
        if row is None or earlier is None or (process and process.pid == os.getpid()):
            continue
        if process and programs.never_reads(process.pid):
            continue
        nodes = names.by_pid.get(process.pid, []) if process else []
        found.append(
            Listener(
                names.of_process(process) if process else f"a program of user {row.uid}",
                process.pid if process else None,
                row.uid,
                drops=max(0, row.drops - earlier.drops),
                queued_bytes=row.queued_bytes,
                was_queued_bytes=earlier.queued_bytes,
                buffer_bytes=buffers.get(inode),
                state=programs.state_of(process.pid) if process else "",
                is_tool=process is not None and _is_tool(process, nodes),
                is_node=bool(nodes),
            )
        )
    return tuple(sorted(found, key=lambda listener: (listener.pid or 0, listener.name)))


def _is_tool(process: Process, nodes: Sequence[Node]) -> bool:
    """Return whether a process is a command of lcmtools, whose filter drops on purpose."""
    if nodes:
        return all(node.tool for node in nodes)
    return any(Path(word).name == "lcmtools" for word in process.command.split()[:3])


def _clock_busy(graph: Graph) -> dict[int, int]:
    """The time that the local publishers of ``/clock`` have computed so far [ns]."""
    publishers = graph.topic("/clock").publishers
    return {node.pid: programs.busy_time(node.pid) for node, _ in publishers if is_here(node)}


def _clock(
    listening: Listening, graph: Graph, names: programs.ProgramNames, busy: Mapping[int, float]
) -> SimulatedClock | None:
    """The pace of simulated time, with the share of time that its local publisher computed."""
    ratio, sender = listening.clock_ratio(), listening.clock_sender
    if ratio is None:
        return None
    publishers = [node for node, _ in graph.topic("/clock").publishers]
    node = names.senders.node(sender) or (publishers[0] if len(publishers) == 1 else None)
    target = target_rate(node.command) if node else 1.0
    share = busy.get(node.pid) if node and is_here(node) else None
    return SimulatedClock(names.senders.name(sender), ratio, target, share)
