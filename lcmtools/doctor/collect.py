"""Collection of the evidence: ``wtf`` reads the bus and this computer once."""

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from lcmtools.bus.multicast import check_route
from lcmtools.bus.processes import Process, buffer_overflows, is_local
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl
from lcmtools.doctor import host as computer
from lcmtools.doctor import lcm_processes, receivers
from lcmtools.doctor.evidence import (
    Evidence,
    HostClock,
    SenderFacts,
    SimulatedClock,
    Stream,
)
from lcmtools.doctor.listening import Listening, target_rate
from lcmtools.errors import BusError, UsageError
from lcmtools.graph.model import Graph, NodeInfo, Role, Staleness
from lcmtools.graph.protocol import PERIOD
from lcmtools.observe.actuators import unattended_commands
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import is_gone, is_here, user_name
from lcmtools.observe.simulators import publishes_time

if TYPE_CHECKING:  # only --watch needs it
    from lcmtools.doctor.memory import Memory

_REQUESTS = 5  # for announcements at the end of a look, at most
_MOST_LATE = 200  # nodes that have not answered; more are made up by a stranger
_ANSWER_TIME = 0.05  # [s] several times as long as nodes need
USUAL, LONGER = 1.0, 3.5  # [s] a look, and one that goes on because something is in doubt
_LONG_ENOUGH = 0.3  # [s] a look of at least this duration may go on


def never(_evidence: Evidence) -> bool:
    """Return that nothing is in doubt."""
    return False


def collect(
    url: BusUrl,
    environment: Mapping[str, str],
    listen: float,
    memory: "Memory | None" = None,
    in_doubt: Callable[[Evidence], bool] = never,
) -> Evidence:
    """Observe a bus for ``listen`` seconds, or for ``LONGER`` if that leaves it ``in_doubt``.

    A bus that does not work is evidence, not an error. ``memory`` has the publishers of earlier
    looks.
    """
    here = computer.host(url, environment)
    evidence = Evidence(url=str(url), ttl=url.ttl if url.is_multicast else 0, host=here)
    failures, filtered = computer.reassembly_failures(), computer.rp_filter_drops()
    try:
        if url.is_multicast:
            check_route(url)  # lcmtools' programs would go on without one, others cannot
        with BusMonitor(url, "wtf", environment, whole=True) as monitor:
            evidence = _observe(monitor, evidence, listen, memory, in_doubt)
    except BusError as error:
        return replace(evidence, bus_problem=error.what, bus_remedy=error.hint)
    processes = lcm_processes.with_topics(evidence.processes, evidence.graph)
    stale = {node.id for node in evidence.graph.nodes if node.stale}
    records = NodeRecords(url, environment)
    sides = (Role.PUBLISHER, Role.SUBSCRIBER)
    published, subscribed = (records.topics(stale, side) for side in sides)
    evidence = replace(evidence, stale_published=published, stale_subscribed=subscribed)
    failures = computer.reassembly_failures() - failures
    drops = computer.rp_filter_drops() - filtered
    here = replace(here, reassembly_failures=failures, rp_filter_drops=drops)
    return replace(evidence, processes=processes, host=here)


def unusable(error: UsageError) -> Evidence:
    """Return the evidence if the bus in the environment is invalid."""
    remedy = error.hint.replace("write 'udpm:", "export LCM_DEFAULT_URL='udpm:")
    return Evidence(url="", bus_problem=error.what, bus_remedy=remedy)


def _observe(
    monitor: BusMonitor,
    evidence: Evidence,
    listen: float,
    memory: "Memory | None",
    in_doubt: Callable[[Evidence], bool],
) -> Evidence:
    baseline = _Baseline.now(monitor)
    evidence = replace(evidence, before=baseline.graph)
    if driven := [odometry for _, _, odometry in unattended_commands(baseline.graph)]:
        monitor.listen_to(driven)  # a simulator publishes no odometry that nobody wants

    def gathered(seconds: float) -> Evidence:
        found = _gather(monitor, evidence, baseline, seconds)
        return memory.recall(found) if memory else found

    _receive(monitor, baseline.listening, listen)
    found = gathered(listen)
    if _LONG_ENOUGH <= listen < LONGER and in_doubt(found):
        _receive(monitor, baseline.listening, LONGER - listen)
        found = gathered(LONGER)
    if memory:
        memory.remember(found)
    return found


@dataclass(frozen=True, slots=True)
class _Baseline:  # the state of the bus and of this computer at the start of a look
    graph: Graph
    table: SocketTable
    times: Mapping[int, tuple[int, int]]  # computing and waiting time by process [ns]
    waiting: Mapping[int, receivers.Waiting]  # the messages that wait for each listener
    overflows: int
    listening: Listening
    time: float

    @classmethod
    def now(cls, monitor: BusMonitor) -> "_Baseline":
        monitor.ask()
        table = _sockets(monitor.url)
        pids = {process.pid for process in table.holders.values()} - {os.getpid()}
        times, now = {pid: Process(pid).processor_times for pid in pids}, time.monotonic()
        waiting = receivers.waiting(table, table.listening(monitor.url))
        graph = monitor.settle(foreign=False)
        listening = Listening(monitor.types_of, port=monitor.url.port)
        overflows = buffer_overflows()
        return cls(graph, table, times, waiting, overflows, listening, now)

    def spent(self) -> dict[int, tuple[int, int]]:
        """Return each process's computing and waiting time since the start [ns]."""
        now = {pid: Process(pid).processor_times for pid in self.times}
        return {
            pid: (now[pid][0] - computed, now[pid][1] - waited)
            for pid, (computed, waited) in self.times.items()
        }


def _gather(
    monitor: BusMonitor, evidence: Evidence, baseline: _Baseline, listen: float
) -> Evidence:
    """Return the evidence of a look that lasted ``listen`` seconds."""
    listening = baseline.listening
    after = _with_ended(_refreshed_graph(monitor, listening, listen))
    overflows = buffer_overflows() - baseline.overflows
    later = _sockets(monitor.url)
    seconds, spent = time.monotonic() - baseline.time, baseline.spent()
    busy = {pid: (computed + waited) / 1e9 / seconds for pid, (computed, waited) in spent.items()}
    # a process that is stopped and continued repeatedly misses nothing
    running = {pid for pid, (computed, _) in spent.items() if computed}
    # also nodes that have left, because their messages are in the evidence
    nodes = {node.id: node for node in (*baseline.graph.nodes, *after.nodes)}
    names = lcm_processes.ProgramNames(monitor, listening, nodes.values(), later)
    ports = {sender.port for sender in monitor.tap.sequences} if monitor.tap else set()
    is_log = monitor.is_log
    processes = () if is_log else lcm_processes.lcm_processes(monitor.url, later, ports)
    return replace(
        evidence,
        graph=_without_departed(after, baseline.graph),
        listened=listen,
        malformed=names.malformed(monitor),
        own_drops=(monitor.tap.drops() if monitor.tap else None) or 0,
        senders=_senders(monitor, names),
        streams=tuple(_named(one, names, baseline.table) for one in listening.streams()),
        listeners=tuple(
            replace(one, state="") if one.pid in running else one
            for one in receivers.listeners(
                monitor.url, baseline.table, baseline.waiting, names, overflows
            )
        ),
        oddities=listening.oddities(names.name),
        frames=listening.frames(names.name),
        logs=listening.logs(),
        clock=clock_of(listening, after, names, busy),
        processes=tuple(replace(one, state="") if one.pid in running else one for one in processes),
        processor_wait=max((waited for _, waited in spent.values()), default=0) / 1e9,
        waits={node.pid: spent[node.pid][1] / 1e9 for node in after.nodes if node.pid in spent},
        users={uid: user_name(uid) for uid in {row.uid for row in later.rows.values()}},
        clocks=_clocks(after),
        remote=frozenset(node.id for node in after.nodes if not is_here(node)),
        relays=listening.relays.ends(),
    )


def _receive(monitor: BusMonitor, listening: Listening, seconds: float) -> None:
    for packet in monitor.packets(seconds):
        listening.add_packet(packet)


def _refreshed_graph(monitor: BusMonitor, listening: Listening, listen: float) -> Graph:
    """Return the graph with the nodes' counters at the end, if the look was long enough.

    Between computers the request or an answer may be lost, and a node would be reported as an
    unknown address. So the request is repeated until every sender on another computer has its node.
    Plain LCM programs never answer, so there is a limit: if one datagram in ten is lost, five
    requests without an answer happen once in 4,000 looks. A node that runs and has not answered may
    wait for a processor: it gets more time.
    """
    graph = monitor.graph()
    # a log holds no answers
    begin = {} if monitor.is_log else {node.id: node.sent for node in graph.nodes if node.sent}
    late = sum(_may_answer(node, begin) for node in graph.nodes)
    for request in range(_REQUESTS if listen >= PERIOD / 10 else 0):
        monitor.probe()
        _receive(monitor, listening, _ANSWER_TIME * (2**request if late else 1))
        graph = monitor.graph()
        late = sum(_may_answer(node, begin) for node in graph.nodes)
        senders = (seen.sender for seen in graph.foreign())
        are_named = all(x is None or x.name or is_local(x.address) for x in senders)
        if (are_named and not late) or late > _MOST_LATE:
            break
    return graph


def _with_ended(graph: Graph) -> Graph:
    """Return the graph with the nodes as ended whose process here was killed during the look."""
    nodes = (
        node._replace(stale=Staleness.ENDED) if is_gone(node) else node for node in graph.nodes
    )
    return graph._replace(nodes=tuple(nodes))


def _without_departed(graph: Graph, before: Graph) -> Graph:
    """Return the graph without the traffic of nodes that have left: no plain program sent it."""
    was, now = ({s for node in one.nodes for s in node.senders()} for one in (before, graph))
    left = was - now
    return graph._replace(traffic=tuple(x for x in graph.traffic if x.sender not in left))


def _may_answer(node: NodeInfo, begin: Mapping[str, int]) -> bool:
    """Return whether a node's answer is still to come: it announced nothing since ``begin``."""
    is_old = node.stale or node.sent == begin.get(node.id)
    if not is_old or node.stale is Staleness.ENDED or node.is_hidden:
        return False
    return not (is_here(node) and Process(node.pid).state in ("", "T", "t"))


def _senders(monitor: BusMonitor, names: lcm_processes.ProgramNames) -> tuple[SenderFacts, ...]:
    tap = monitor.tap
    if tap is None:
        return ()
    facts, lost = [], monitor.losses()
    for sender, sequence in tap.sequences.items():
        users = {row.uid for row in names.table.sockets(sender)}
        age = 0.0 if sequence.is_shared else _age(names.senders.process(sender))
        one = SenderFacts(
            *(sender, names.name(sender)),
            is_local=is_local(sender.address),
            messages=sequence.messages,
            lost=lost[sender].lost if sender in lost else 0,
            ttl=tap.ttls.get(sender),
            uid=users.pop() if len(users) == 1 else None,
            paces=names.senders.node(sender) is not None,
            process_age=age,
            average_rate=sequence.sent / age if age else 0.0,
        )
        facts += [one] if sender.port != tap.port else []
    return tuple(facts)


def _sockets(url: BusUrl) -> SocketTable:
    return SocketTable.read() if url.is_multicast else SocketTable()


def _age(process: Process | None) -> float:
    # [s] since it started; 0 if unknown
    usage = process.usage() if process else None
    return max(0.0, (time.time_ns() - usage.start_time) / 1e9) if usage else 0.0


def _named(stream: Stream, names: lcm_processes.ProgramNames, earlier: SocketTable) -> Stream:
    sender, name = stream.sender, names.name(stream.sender)
    is_here = sender and names.table.rows and is_local(sender.address)
    if not (sender and is_here) or names.table.sockets(sender):
        return replace(stream, name=name, pid=names.pid(stream))
    process = earlier.processes(sender).only  # it has ended meanwhile
    name = names.of_process(process) if process and name == str(sender) else name
    return replace(stream, name=name, pid=names.pid(stream), has_ended=True)


def _clocks(graph: Graph) -> tuple[HostClock, ...]:
    """Return the lags of the other computers' clocks, by their fastest announcements.

    The address of a computer behind a relay is not known here.
    """
    lags: dict[tuple[str, str], dict[str, float]] = {}
    for node in graph.nodes:
        if node.lag is not None and (node.sender or node.path) and not is_here(node):
            place = node.host, node.sender.computer if node.sender else ""
            lags.setdefault(place, {})[node.name] = node.lag / 1e9
    return tuple(HostClock(*place, min(of.values()), tuple(of)) for place, of in lags.items())


def clock_of(
    listening: Listening, graph: Graph, names: lcm_processes.ProgramNames, busy: Mapping[int, float]
) -> SimulatedClock | None:
    """Return the pace of simulated time, with the processor time of its local publisher."""
    ratio, sender = listening.clock_ratio(), listening.clock_sender
    if ratio is None and not listening.clock_jumps():
        return None
    publishers = list(filter(publishes_time, graph.nodes))
    node = names.senders.node(sender) or (publishers[0] if len(publishers) == 1 else None)
    target = target_rate(node.command) if node else 1.0
    share = busy.get(node.pid) if node and is_here(node) else None
    return SimulatedClock(names.name(sender), ratio, target, share, listening.clock_jumps())
