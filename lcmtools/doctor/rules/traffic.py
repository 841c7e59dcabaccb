"""Rules about the messages that come: lost, silent, irregular, too many, from too many."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from statistics import median

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import (
    Finding,
    Observed,
    Severity,
    Statement,
    cases,
    finding,
    rule,
    state,
)
from lcmtools.doctor.rules.callbacks import busy_nodes
from lcmtools.doctor.rules.types import disagree
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.counters import average_rate, counted_rate
from lcmtools.observe.losses import Loss

_SHARED = frozenset({"/rosout", "/tf", "/tf_static", "/diagnostics"})
_SILENCE = 3.0  # [s]
_PERIODS = 10  # without a message are silence
_ENOUGH = 20  # messages to speak of a rate
_FALLEN = 0.5
_UNEVEN = 8  # times the usual interval
_BLAME = 0.6  # of a gap: a program that waited so long for a processor is not to blame for it
_SHORTEST = 0.1  # [s] an interval that is worth reporting
_SLOWER = 0.9  # of the target rate
_BUSY = 0.85


@rule("loss", "less data, a wired network, or recv_buf_size=N in the URL")
def nothing_is_lost(evidence: Evidence) -> Iterator[Finding]:
    """Every message that is sent arrives at this computer.

    Each sender numbers its messages, so a gap is a loss: of the network for other computers, of the
    sender itself for this one's. What wtf was too slow for does not count.
    """
    lossy = [s for s in evidence.senders if s.lost > evidence.own_drops]
    facts = []
    for s in sorted(lossy, key=lambda one: -one.lost):
        kind, sent = "lost-in-sender" if s.is_local else "lost-on-network", s.lost + s.messages
        percent = 100 * Loss(s.lost, sent).share
        facts.append(state(kind, sender=s, lost=s.lost, sent=sent, percent=percent))
    return cases("loss", facts, "send-less")


@rule("silent", "check the node's log, and that its inputs still arrive")
def publishers_publish(evidence: Evidence) -> Iterator[Finding]:
    """Publishers that published often still do.

    By their own counters, and by the traffic during the look. Many have a reason: no commands, or
    no subscribers.
    """
    facts = []
    for node, endpoint in _subscribed_publications(evidence):
        rate = average_rate(node, endpoint)
        age = (evidence.graph.time - endpoint.last_time) / 1e9
        if endpoint.messages >= _ENOUGH and rate and age > max(_SILENCE, _PERIODS / rate):
            facts.append(_silence("silent-node", node, endpoint.topic, age, rate))
    for stream in _wanted_streams(evidence):
        interval = _usual_interval(stream)
        # of what wtf itself was too slow for, or had to leave out, the last time is not known
        if not interval or stream.is_cut or evidence.own_drops:
            continue
        age = (evidence.graph.time - stream.times[-1]) / 1e9
        is_late = age * _BLAME > evidence.processor_wait
        if is_late and age > max(_PERIODS * interval, 0.5):
            facts.append(_silence("silent-stream", stream, stream.channel, age, 1 / interval))
    yield from cases("silent", facts, severity=Severity.NOTE)
    # of these other rules report it
    nodes = {node.pid for node in evidence.own_nodes()} | {x.pid for x in evidence.listeners}
    stopped = [
        process
        for process in evidence.processes
        if process.state in ("T", "t") and not (process.bus or process.pid in nodes)
    ]
    remedies = (state("wake-or-end", pid=one.pid) for one in stopped)
    yield from cases(
        "stopped-programs", (state("process", process=one) for one in stopped), *remedies
    )


def _silence(kind: str, publisher: Observed, topic: str, age: float, rate: float) -> Statement:
    return state(kind, publisher=publisher, topic=topic, seconds=age, rate=rate)


@rule(
    "slow-rate",
    "see what the node or its computer is busy with: lcmtools node info, top",
    Severity.NOTE,
)
def rates_do_not_fall(evidence: Evidence) -> Iterator[Finding]:
    """Publishers are as fast as they were on average since they started."""
    before = {
        (node.id, endpoint.topic): endpoint
        for node in evidence.before.nodes
        for endpoint in node.having(Role.PUBLISHER)
    }
    facts = []
    for node, endpoint in _subscribed_publications(evidence):
        earlier = before.get((node.id, endpoint.topic))
        usual = average_rate(node, earlier) if earlier else None
        now = counted_rate(earlier, endpoint) if earlier else None
        if earlier and usual and now and earlier.messages >= 5 * _ENOUGH:
            expected = usual * evidence.listened
            if expected >= _ENOUGH and now < _FALLEN * usual:
                topic = endpoint.topic
                facts.append(state("slower", node=node, topic=topic, rate=now, usual=usual))
    return cases("slow-rate", facts, severity=Severity.NOTE)


@rule(
    "irregular",
    "lcmtools hz TOPIC shows the intervals; find the call that blocks the node",
    Severity.NOTE,
)
def rates_are_even(evidence: Evidence) -> Iterator[Finding]:
    """Frequent messages come evenly: a gap may be a callback that blocks, or a busy computer."""
    facts = []
    for stream in _wanted_streams(evidence):
        interval = _usual_interval(stream)
        if interval and len(stream.times) >= _ENOUGH and not is_hidden(stream.channel):
            longest = max(later - earlier for earlier, later in pairwise(stream.times)) / 1e9
            # a program that had to wait for a processor is not to blame
            is_late = longest * _BLAME > evidence.processor_wait
            if is_late and longest > max(_SHORTEST, _UNEVEN * interval):
                times = {"longest": longest, "usual": interval}
                facts.append(state("gap", sender=stream, topic=stream.channel, **times))
    return cases("irregular", facts, severity=Severity.NOTE)


@rule("competing-publishers", "end one of them, or remap it: OLD:=NEW")
def topics_have_one_publisher(evidence: Evidence) -> Iterator[Finding]:
    """No two programs send on the same topic at the same time, or on alternatives of one input.

    Two that steer the same robot fight over it. Topics meant for many, as /tf, are excepted, and
    those on which different types are sent, which another rule reports.
    """
    groups = {
        endpoint.topic: f"{node.id}{endpoint.group}"
        for node in evidence.graph.nodes
        for endpoint in node.having(Role.SUBSCRIBER)
        if endpoint.group
    }
    senders: dict[str, dict[str, Stream]] = defaultdict(dict)
    for stream in evidence.streams:
        is_private = stream.channel not in _SHARED and not is_hidden(stream.channel)
        if is_private and len(stream.times) > 1 and stream.sender:
            key = groups.get(stream.channel, stream.channel)
            # one node may send large messages from a port of its own: the name counts
            senders[key].setdefault(stream.name, stream)
    rivals: dict[frozenset[str], list[Stream]] = defaultdict(list)
    for streams in senders.values():
        topics = {stream.channel for stream in streams.values()}
        if len(streams) > 1 and not any(disagree(evidence.graph.topic(name)) for name in topics):
            rivals[frozenset(streams)] += streams.values()
    for found in rivals.values():
        names = sorted({stream.channel for stream in found})
        count = len({one.name for one in found})
        title = state("competing-publishers", count=count, topics=names)
        facts = (state("publisher", sender=one, topic=one.channel) for one in found)
        yield finding(title, facts, _parting(evidence, found, names[0]))


def _parting(evidence: Evidence, streams: Sequence[Stream], topic: str) -> Statement:
    """The remedy for several that compete for a topic."""
    pids = tuple(str(pid) for pid in dict.fromkeys(one.pid for one in streams) if pid)
    nodes = {sender for node in evidence.graph.nodes for sender in node.senders()}
    is_node = any(one.sender in nodes for one in streams)
    kind = "end-one-or-remap" if is_node else "end-one-or-rename"
    return state(kind, pids=pids if len(pids) > 1 else (), topic=topic)


@rule("slow-simulator", "subscribe to fewer sensors, or slow it: lcmtools sim set-rate")
def simulated_time_passes(evidence: Evidence) -> Iterator[Finding]:
    """A simulator keeps up with real time, or with the rate that it was started with.

    One that computes all the time, and is slower nevertheless, has too much to do. One that rests
    was slowed on purpose.
    """
    clock = evidence.clock
    if not (clock and clock.target and 0 < clock.ratio <= _SLOWER * clock.target):
        return
    known = {"ratio": clock.ratio, "target": clock.target}
    facts = [state("program", program=clock.name)]
    if clock.busy is not None and clock.busy > _BUSY:
        yield finding(state("overloaded-simulator", **known), facts, "simulate-less")
    else:
        remedy = state("set-rate", rate=clock.target)
        yield finding(state("slow-simulator", **known), facts, remedy, severity=Severity.NOTE)


def _subscribed_publications(evidence: Evidence) -> Iterator[tuple[Node, Endpoint]]:
    """The publications of nodes that have subscribers, but for simulators that rest."""
    taken = {
        endpoint.topic
        for node in evidence.graph.nodes
        if not node.stale
        for endpoint in node.having(Role.SUBSCRIBER)
    }
    ticking = {s.name for s in evidence.streams if s.channel == "/clock"}
    for node in evidence.graph.nodes:
        publications = node.having(Role.PUBLISHER)
        rests = any(e.topic == "/clock" for e in publications) and node.name not in ticking
        for endpoint in publications:
            usual = not is_hidden(endpoint.topic) and endpoint.topic not in _SHARED
            if usual and endpoint.topic in taken and not (rests or node.stale or node.tool):
                yield node, endpoint


def _wanted_streams(evidence: Evidence) -> list[Stream]:
    """The streams but those of nodes that have no subscribers: these may rest as they like.

    A simulator measures them while anything listens to all topics, as wtf does.
    """
    ends = [(e, node) for node in evidence.graph.nodes if not node.stale for e in node.endpoints]
    published = {e.topic for e, _ in ends if e.role is Role.PUBLISHER}
    subscribed = {e.topic for e, node in ends if e.role is Role.SUBSCRIBER and not node.tool}
    busy = busy_nodes(evidence)  # of these another rule reports the cause
    return [
        s
        for s in evidence.streams
        if (s.channel in subscribed or s.channel not in published) and s.name not in busy
    ]


def _usual_interval(stream: Stream) -> float | None:
    """The median interval between the messages of a stream [s]; None where there are few."""
    if len(stream.times) < 5 or is_hidden(stream.channel):  # noqa: PLR2004 - too few
        return None
    return median(later - earlier for earlier, later in pairwise(stream.times)) / 1e9 or None
