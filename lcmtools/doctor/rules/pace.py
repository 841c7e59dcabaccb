"""Rules about the rates of publishers: silent, slower than before, irregular."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import TypeAlias

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Finding, Observed, Severity, Statement, finding, rule, state
from lcmtools.doctor.rules.callbacks import busy_nodes
from lcmtools.doctor.rules.shared import WAKE_OR_END, simulator_ids
from lcmtools.graph.common_topics import MEANT_FOR_MANY
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import average_rate
from lcmtools.observe.simulators import publishes_time, silence

_STOPPED = frozenset({"T", "t"})
_SILENCE = 3.0  # [s]
_PERIODS = 10  # periods without a message are silence
_ENOUGH = 10  # messages that are enough for a usual rate
_SURE = 8  # expected messages that are enough to judge a rate
_FALLEN = 0.5
_LATE = 3  # periods without a message are a reason to look longer
_LONGEST = 3.5  # [s] of a look
_AGE = 5.0  # [s] the least age of a process for an average rate
_BURST = 4  # times the median interval on average
_AT_ONCE = 500_000  # [ns] between messages that are sent one after another
UNEVEN = 8  # times the usual interval
_BLAME = 0.6  # share of a gap that a wait for a processor excuses
SHORTEST = 0.1  # [s] an interval that is worth reporting

_Measured: TypeAlias = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class _Pace:  # a publisher's messages during the look, and its usual rate
    fact: str  # the kind of its fact
    publisher: Observed
    name: str  # of the publisher, as it is displayed
    topic: str  # "" for all topics together
    usual: float  # [Hz]
    sent: int  # messages
    span: float  # [s] in which they were sent
    age: float | None = None  # [s] of the newest message; None if unknown
    gap: float = 0.0  # [s] the longest between the messages before it

    @property
    def expected(self) -> float:
        """The messages that should have come."""
        return self.usual * self.span

    @property
    def has_fallen(self) -> bool:
        return self.sent < _FALLEN * self.expected

    @property
    def rate(self) -> float:
        """The rate now [Hz]; if no message came, its upper bound."""
        return self.sent / self.span if self.sent else 1 / max(self.span, self.age or 0.0)

    def is_doubtful(self) -> bool:
        """Return whether only a longer look shows whether the rate fell.

        One or two missing messages are no reason for a longer look.
        """
        is_late = self.age is not None and self.age > max(_LATE / self.usual, 0.5)
        is_suspicious = is_late or (self.has_fallen and self.expected >= _LATE)
        return is_suspicious and self.expected < _SURE <= _LONGEST * self.usual


@rule(
    "silent",
    remedy="check the node's log, and that its inputs still arrive",
    title={
        "silent": "The following have stopped publishing:",
        "stopped-programs": "The following programs are stopped: they send and receive nothing:",
    },
    facts={
        "ended-stream": "{publisher}, which has ended: {topic}, {seconds:.1f} s ago, {rate:.3g} Hz"
        " before",
        "process": "{process} (pid {process.pid})",
        "silent-node": "{publisher}: {topic}, the last of {messages} messages {seconds:.0f} s ago",
        "silent-stream": "{publisher}: {topic}, {seconds:.1f} s ago, {rate:.3g} Hz before",
    },
    remedies=WAKE_OR_END,
    unless={"stale-nodes": "pid", "stuck-listeners": "pid"},
    evidence="the nodes' counters, times of arrival, the state of processes; earlier looks with"
    " --watch",
    root_only="the state of other users' programs",
)
def publishers_publish(evidence: Evidence) -> Iterator[Finding]:
    """Publishers that published often still do.

    wtf compares their own counters, the traffic during the look, and with --watch earlier looks.
    Many stop for a good reason: no commands, or no subscribers.
    """
    # each publisher once, by the most reliable evidence
    facts: dict[tuple[str, str], Statement] = {}
    for kind, by, name, topic, age, before in _silent(evidence):
        fact = state(kind, publisher=by, topic=topic, seconds=age, **before)
        facts.setdefault((name, topic), fact)
    yield from finding("silent", facts.values(), severity=Severity.NOTE)
    yield from _stopped(evidence)


def _silent(evidence: Evidence) -> Iterator[tuple[str, Observed, str, str, float, _Measured]]:
    """Yield silent ones: kind of fact, publisher, name, topic, time [s], messages or rate before.

    A node's rate before is not known: its average since the start may be quite another one.
    """
    simulators = simulator_ids(evidence)
    for node, endpoint, is_subscribed in _publications(evidence):
        # a simulator measures for subscribers only
        is_wanted = is_subscribed or node.id not in simulators
        rate = average_rate(node, endpoint) if is_wanted else None
        age = silence(node, endpoint, evidence.graph.time) / 1e9
        if endpoint.messages >= _ENOUGH and rate and age > max(_SILENCE, _PERIODS / rate):
            known = {"messages": endpoint.messages}
            yield "silent-node", node, node.name, endpoint.topic, age, known
    for stream in _wanted_streams(evidence):
        interval = usual_interval(stream)
        # the last time is unknown if wtf was too slow or the list of times is full
        if interval and not (stream.is_cut or _is_over(stream, evidence) or evidence.own_drops):
            age = (evidence.graph.time - stream.times[-1]) / 1e9
            is_late = age * _BLAME > evidence.processor_wait
            gap = max(later - earlier for earlier, later in pairwise(stream.times)) / 1e9
            if is_late and age > max(_PERIODS * interval, _LATE * gap, 0.5):
                kind = "ended-stream" if stream.has_ended else "silent-stream"
                yield kind, stream, stream.name, stream.channel, age, {"rate": 1 / interval}
    for pace in _remembered(evidence):
        if pace.age is not None and pace.age > max(_PERIODS / pace.usual, _LATE * pace.gap, 0.5):
            rate_was = {"rate": pace.usual}
            yield "silent-stream", pace.publisher, pace.name, pace.topic, pace.age, rate_was


def _is_over(stream: Stream, evidence: Evidence) -> bool:
    """Return whether a stream has ended in order: its node left, or its program runs anew."""
    others = sum(one.channel == stream.channel for one in evidence.streams) - 1
    known = (*evidence.before.nodes, *evidence.graph.nodes)
    return stream.has_ended and (bool(others) or any(node.name == stream.name for node in known))


def _stopped(evidence: Evidence) -> Iterator[Finding]:
    stopped = [one for one in evidence.processes if one.state in _STOPPED and not one.bus]
    remedies = (state("wake-or-end", pid=one.pid).of("pid", str(one.pid)) for one in stopped)
    facts = (state("process", process=one) for one in stopped)
    return finding("stopped-programs", facts, *remedies)


@rule(
    "slow-rate",
    remedy="see what the node or its computer is busy with: lcmtools node info, top",
    severity=Severity.NOTE,
    title="The following have become slower:",
    facts={
        "slower": "{node}: {topic}, {rate:.3g} Hz instead of {usual:.3g} Hz",
        "slower-program": "{sender}: {rate:.3g} Hz in all, and {usual:.3g} Hz on average since its"
        " start",
        "slower-stream": "{sender}: {topic}, {rate:.3g} Hz instead of {usual:.3g} Hz",
    },
    unless={"silent": "pair"},
    evidence="the nodes' counters, LCM's sequence numbers with the age of processes; earlier looks"
    " with --watch",
    root_only="the age of other users' programs",
)
def rates_do_not_fall(evidence: Evidence) -> Iterator[Finding]:
    """Publishers are as fast as they were.

    Nodes count their messages, LCM numbers those of other programs: both give the average rate
    since the start. With --watch the rates of earlier looks are used, too.
    """
    facts: dict[tuple[str, str], Statement] = {}
    for pace in _paces(evidence):
        key = pace.name, pace.topic
        if pace.has_fallen and pace.expected >= _SURE:
            by, about = pace.publisher, {"topic": pace.topic} if pace.topic else {}
            parts = {"node": by} if isinstance(by, NodeInfo) else {"sender": by}
            fact = state(pace.fact, **parts, **about, rate=pace.rate, usual=pace.usual)
            facts.setdefault(key, fact)
    return finding("slow-rate", facts.values())


def is_in_doubt(evidence: Evidence) -> bool:
    """Return whether rates may have fallen.

    A stream that has just stopped may come in bursts.
    """
    stops = (isinstance(by, Stream) for _, by, *_ in _silent(evidence))
    return any(stops) or any(pace.is_doubtful() for pace in _paces(evidence))


@rule(
    "irregular",
    remedy="lcmtools hz TOPIC shows the intervals; find the call that blocks the node",
    severity=Severity.NOTE,
    title="The following come at irregular intervals:",
    facts={"gap": "{sender}: {topic}, {longest:.2f} s without a message, usually {usual:time}"},
    evidence="times of arrival; the time that programs waited for a processor",
    root_only="the waiting of other users' programs",
)
def rates_are_even(evidence: Evidence) -> Iterator[Finding]:
    """Frequent messages come at regular intervals.

    A gap may be caused by a callback that blocks, or by a busy computer.
    """
    facts = []
    for stream in _wanted_streams(evidence):
        interval = usual_interval(stream)
        if interval and len(stream.times) >= 2 * _ENOUGH and not _comes_in_bursts(stream):
            longest = max(later - earlier for earlier, later in pairwise(stream.times)) / 1e9
            # a program that had to wait for a processor is not to blame
            is_late = longest * _BLAME > evidence.processor_wait
            if is_late and longest > max(SHORTEST, UNEVEN * interval):
                times = {"longest": longest, "usual": interval}
                facts.append(state("gap", sender=stream, topic=stream.channel, **times))
    return finding("irregular", facts)


def _comes_in_bursts(stream: Stream) -> bool:
    """Return whether most messages follow others immediately, or there are several long pauses."""
    gaps = sorted(later - earlier for earlier, later in pairwise(stream.times))
    usual, average = median(gaps), sum(gaps) / len(gaps)
    return usual < _AT_ONCE or (average > _BURST * usual and gaps[-2] > gaps[-1] / 2)


def usual_interval(stream: Stream) -> float | None:
    """Return the median interval between the messages of a stream [s]; None for too few."""
    if len(stream.times) < 5 or is_hidden(stream.channel):  # noqa: PLR2004 - too few
        return None
    return median(later - earlier for earlier, later in pairwise(stream.times)) / 1e9 or None


def _paces(evidence: Evidence) -> Iterator[_Pace]:
    """Yield the publishers with a known usual rate, except simulators.

    Publishers of simulated time are left out too, because another rule judges their pace. A
    simulator sends the poses of resting bodies less often.
    """
    simulators, nodes = simulator_ids(evidence), evidence.graph.nodes
    excepted = {node.name for node in nodes if node.id in simulators or publishes_time(node)}
    yield from (pace for pace in _remembered(evidence) if pace.name not in excepted)
    ends = ((node, end) for node in evidence.before.nodes for end in node.having(Role.PUBLISHER))
    before = {(node.id, end.topic): (node, end) for node, end in ends}
    for node, endpoint, is_subscribed in _publications(evidence):
        was, earlier = before.get((node.id, endpoint.topic), (node, endpoint))
        is_known = is_subscribed and earlier.messages >= _ENOUGH
        usual = average_rate(was, earlier) if is_known else None
        span = _between(was, node, evidence.listened)
        if usual and span and was is not node and node.name not in excepted:
            sent, age = (
                endpoint.messages - earlier.messages,
                silence(node, endpoint, evidence.graph.time) / 1e9,
            )
            yield _Pace("slower", node, node.name, endpoint.topic, usual, sent, span, age)
    announced = {sender for node in nodes for sender in node.senders()}
    for one in evidence.senders:
        has_average = one.average_rate and one.process_age > _AGE and one.sender not in announced
        if has_average and not evidence.own_drops:
            counts = one.average_rate, one.messages + one.lost, evidence.listened
            yield _Pace("slower-program", one, one.name, "", *counts)


def _between(was: NodeInfo, node: NodeInfo, listened: float) -> float:
    """Return the time between two announcements by the node's clock [s]; 0 if there is none.

    One that a bus or a relay has kept lacks its time: it has counted a message just before.
    """
    earlier, later = map(_announced, (was, node))
    return max(0.0, (later - earlier) / 1e9) if earlier or later else listened


def _announced(node: NodeInfo) -> int:
    return node.sent or max((end.last_time for end in node.endpoints), default=0)


def _remembered(evidence: Evidence) -> Iterator[_Pace]:
    """Yield the publishers of earlier looks of --watch."""
    streams = {(stream.channel, stream.sender): stream for stream in evidence.streams}
    wanted, excused = _wanted_topics(evidence), {node.name for node in resting_simulators(evidence)}
    excused |= busy_nodes(evidence) | {node.name for node in evidence.graph.nodes if node.stale}
    stopped = {process.pid for process in evidence.processes if process.state in _STOPPED}
    for one in evidence.remembered:
        if one.name not in excused and one.pid not in stopped and wanted(one.topic):
            stream = streams.get((one.topic, one.sender))
            times = stream.times if stream else ()
            age = (evidence.graph.time - (times[-1] if times else one.last_time)) / 1e9
            gap = max(one.gap, (times[0] - one.last_time) / 1e9) if times else one.gap
            if not (stream and stream.is_cut) and not evidence.own_drops:
                seen = len(times), evidence.listened, age, gap
                yield _Pace("slower-stream", one, one.name, one.topic, one.rate, *seen)


def resting_simulators(evidence: Evidence) -> list[NodeInfo]:
    """Return the simulators that publish no time now, and so no measurements."""
    ticking = {s.name for s in evidence.streams if s.channel == CLOCK_TOPIC}
    clocks = filter(publishes_time, evidence.graph.nodes)
    return [node for node in clocks if node.name not in ticking]


def _publications(evidence: Evidence) -> Iterator[tuple[NodeInfo, Endpoint, bool]]:
    """Yield the publications of active nodes, and whether they have subscribers."""
    live = [node for node in evidence.graph.nodes if not node.stale]
    taken = {end.topic for node in live for end in node.having(Role.SUBSCRIBER)}
    resting = resting_simulators(evidence)
    missed = {e.topic for node in resting for e in node.having(Role.PUBLISHER)} - MEANT_FOR_MANY
    for node in live:
        waits = not missed.isdisjoint(e.topic for e in node.having(Role.SUBSCRIBER))
        if node in resting or waits or node.tool:  # silent on purpose
            continue
        for endpoint in node.having(Role.PUBLISHER):
            if not is_hidden(endpoint.topic) and endpoint.topic not in MEANT_FOR_MANY:
                yield node, endpoint, endpoint.topic in taken


def _wanted_topics(evidence: Evidence) -> Callable[[str], bool]:
    """Return a predicate for the topics whose publishers have a reason to publish.

    A publisher without subscribers may pause: a simulator, for example, sends its sensors while a
    command such as wtf listens to all topics.
    """
    ends = [(e, node) for node in evidence.graph.nodes if not node.stale for e in node.endpoints]
    published = {e.topic for e, _ in ends if e.role is Role.PUBLISHER}
    subscribed = {e.topic for e, node in ends if e.role is Role.SUBSCRIBER and not node.tool}
    return lambda topic: topic in subscribed or topic not in published


def _wanted_streams(evidence: Evidence) -> list[Stream]:
    wanted, busy = _wanted_topics(evidence), busy_nodes(evidence)  # reported by another rule
    return [s for s in evidence.streams if wanted(s.channel) and s.name not in busy]
