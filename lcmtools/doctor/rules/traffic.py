"""Rules about messages: lost, duplicated, from too many publishers, and of a slow simulator."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence

from lcmtools.bus.url import another_domain
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Finding, Severity, Statement, finding, rule, state
from lcmtools.doctor.renaming import remap_argument
from lcmtools.doctor.rules.connections import quiet_programs
from lcmtools.doctor.rules.pace import resting_simulators
from lcmtools.doctor.rules.shared import END_OR_REMAP, PROGRAM
from lcmtools.graph.common_topics import MEANT_FOR_MANY
from lcmtools.graph.model import NodeInfo, Role
from lcmtools.names import base_name_of, is_hidden
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.simulators import is_paused, silence

_SENT = "{lost} of {sent} ({percent:.1f} %)"
_RECENT = 10_000_000_000  # [ns] since a publisher's last message
_SOME = 3  # equal messages are not a coincidence
_SLOWER = 0.9  # of the target rate
_BUSY = 0.85


@rule(
    "loss",
    remedy="less data, a wired network, or recv_buf_size=N in the URL",
    title="Messages of the following senders were lost:",
    facts={
        "lost-in-sender": f"{{sender:called}}: {_SENT} before they left it",
        "lost-on-network": f"{{sender:called}}: {_SENT} on the network",
    },
    remedies={
        "send-less": "send less or smaller messages; a large one is lost with any of its parts",
    },
    evidence="LCM's sequence numbers, the drops of wtf's own socket",
)
def nothing_is_lost(evidence: Evidence) -> Iterator[Finding]:
    """Every message that is sent arrives at this computer.

    Each sender numbers its messages, so a gap is a loss: in the network for other computers, in the
    sender itself on this one. Messages that wtf itself was too slow to receive do not count.
    """
    lossy = [s for s in evidence.senders if s.lost > evidence.own_drops]
    facts = []
    for s in sorted(lossy, key=lambda one: -one.lost):
        kind, sent = "lost-in-sender" if s.is_local else "lost-on-network", s.lost + s.messages
        percent = 100 * Loss(s.lost, sent).share
        facts.append(state(kind, sender=s, lost=s.lost, sent=sent, percent=percent))
    return finding("loss", facts, "send-less")


@rule(
    "doubled",
    remedy="remove the second path, or let the sender send once",
    title="Messages of the following come more than once, with the same sequence number:",
    facts={"doubled": "{sender}: {count:messages}"},
    remedies={
        "find-second-way": "look for a second path to this computer: a loop of cables or bridges,"
        " two interfaces on one network, a mirroring port; or a sender that sends everything twice",
    },
    evidence="LCM's sequence numbers, the content of messages",
)
def messages_come_once(evidence: Evidence) -> Iterator[Finding]:
    """No message arrives twice with the same sequence number.

    A network with a loop delivers messages twice, as does one that joins two interfaces of a
    computer. Receivers do not notice: their rates are twice as high, and commands are executed
    twice.
    """
    counts: Counter[str] = Counter()
    for stream in evidence.streams:
        if stream.programs == 1:  # numbers of several programs may be the same
            counts[stream.name] += stream.doubled
    doubled = ((name, count) for name, count in counts.items() if count >= _SOME)
    facts = [state("doubled", sender=name, count=count) for name, count in doubled]
    return finding("doubled", facts, "find-second-way")


@rule(
    "competing-publishers",
    remedy="end one of them, or remap it: OLD:=NEW",
    title="{count} programs publish on {topics:and} at the same time:",
    facts={
        "publisher": "{sender}: {topic}",
        "repeats": "{sender}: {topic}, {count:messages} that another sender had sent before",
    },
    remedies={
        **END_OR_REMAP,
        "end-one-or-part": "end one of them{pids:kills}, or start {other} on another bus, with"
        " --domain {domain}",
        "end-one-or-rename": "end one of them{pids:kills}, or let it publish on another channel",
        "open-circle": "a program that forwards what it receives creates a loop if that comes back"
        " to it: let it publish on another channel",
    },
    unless={"type-mismatch": "topic"},
    evidence="channels, senders and times of messages; announcements of commands",
    root_only="the names of other users' programs",
)
def topics_have_one_publisher(evidence: Evidence) -> Iterator[Finding]:
    """No two programs send on the same topic at the same time, or on alternatives of one input.

    Two programs that steer the same robot fight over it. So do a program and a pub that still runs,
    however seldom it sends, or that has latched its message. A program that repeats the messages of
    another one creates a loop, if it forwards what it receives. Topics meant for many publishers,
    such as /tf, are excepted, and topics with different types, which another rule reports; so is a
    program that is started again and again, because one that has ended does not compete.
    """
    rivals: dict[frozenset[str], list[Stream]] = defaultdict(list)
    for known in _by_input(evidence):
        several = [one for one in known if len(one.times) > 1 and not one.has_ended]
        streams = {one.name: one for one in several if one.programs > 1 or _has_rival(one, several)}
        if sum(one.programs for one in streams.values()) > 1:
            rivals[frozenset(streams)] += streams.values()
    for several in rivals.values():
        names = sorted({stream.channel for stream in several})
        count = sum({one.name: one.programs for one in several}.values())
        title = state("competing-publishers", count=count, topics=names)
        # two simulators send the same without passing it on
        repeat = [one for one in several if one.repeated >= _SOME and CLOCK_TOPIC not in names]
        facts = (
            state("repeats", sender=one, topic=one.channel, count=one.repeated)
            if one in repeat
            else state("publisher", sender=one, topic=one.channel)
            for one in several
        )
        circle = ("open-circle",) if repeat else ()
        yield from finding(title, facts, *circle, _separation(evidence, several, names))


def is_in_doubt(evidence: Evidence) -> bool:
    """Return whether something needs several messages to be judged.

    Those are publishers that compete, and the rate of simulated time.
    """
    several = ([one for one in streams if not one.has_ended] for streams in _by_input(evidence))
    is_unsure = any(len(s) > 1 and min(len(one.times) for one in s) == 1 for s in several)
    is_slow_clock = not evidence.clock and any(s.channel == CLOCK_TOPIC for s in evidence.streams)
    return is_unsure or is_slow_clock or _has_late_rival(evidence)


def _has_late_rival(evidence: Evidence) -> bool:
    """Return whether one of several publishers of a topic was not seen to send, but may be late.

    On a busy computer a plain program may get no turn in a brief look.
    """
    seen: dict[str, set[str]] = defaultdict(set)
    for stream in evidence.streams:
        seen[stream.channel].add(stream.name)
    sending: dict[str, set[str]] = defaultdict(set)
    for node in (one for one in evidence.graph.nodes if not (one.stale or one.tool)):
        for end in node.having(Role.PUBLISHER):
            is_private = end.topic not in MEANT_FOR_MANY and not is_hidden(end.topic)
            is_recent = silence(node, end, evidence.graph.time) < _RECENT
            if is_private and end.messages > 1 and is_recent:
                sending[end.topic].add(node.name)
    late = any(len(of) > 1 and not of <= seen[topic] for topic, of in sending.items())
    return late or bool(evidence.wait_share() and quiet_programs(evidence))


def _by_input(evidence: Evidence) -> list[list[Stream]]:
    """Return the streams on each topic for one publisher; alternatives count as one topic.

    Each sender is included once, because a node may send large messages from a separate port.
    """
    ends = ((node, end) for node in evidence.graph.nodes for end in node.having(Role.SUBSCRIBER))
    groups = {end.topic: f"{node.id}{end.group}" for node, end in ends if end.group}
    senders: dict[str, dict[str, Stream]] = defaultdict(dict)
    for stream in (*evidence.streams, *_lasting_commands(evidence)):
        is_private = stream.channel not in MEANT_FOR_MANY and not is_hidden(stream.channel)
        if is_private and stream.times and stream.sender:
            key = groups.get(stream.channel, stream.channel)
            known = senders[key].setdefault(stream.name, stream)
            if len(known.times) < len(stream.times):
                senders[key][stream.name] = stream
    return [list(streams.values()) for streams in senders.values()]


def _has_rival(one: Stream, streams: Iterable[Stream]) -> bool:
    """Return whether another stream overlaps this one in time."""
    first, last = one.times[0], one.times[-1]
    others = (other.times for other in streams if other is not one)
    return any(times[0] <= last and first <= times[-1] for times in others)


def _lasting_commands(evidence: Evidence) -> Iterator[Stream]:
    """Yield streams for commands that have sent and still run, over their whole lifetime."""
    for node in (one for one in evidence.graph.nodes if one.tool and not one.stale):
        pid = None if node.id in evidence.remote else node.pid
        lasting = node.start_time, evidence.graph.time
        for end in (one for one in node.having(Role.PUBLISHER) if one.messages):
            yield Stream(end.topic, node.sender, node.name, lasting, pid=pid)


def _separation(evidence: Evidence, streams: Sequence[Stream], topics: Sequence[str]) -> Statement:
    pids = tuple(str(pid) for pid in dict.fromkeys(one.pid for one in streams) if pid)
    nodes = {s: node for node in evidence.graph.nodes if not node.tool for s in node.senders()}
    known = {"pids": pids if len(pids) > 1 else ()}
    node = next((nodes[one.sender] for one in streams if one.sender in nodes), None)
    if node is None:
        return state("end-one-or-rename", **known)
    if len(topics) > 1 or CLOCK_TOPIC in topics:  # two simulators, for example
        domain = another_domain(evidence.url)
        return state("end-one-or-part", other=node, domain=domain, **known)
    (topic,) = topics
    old = remap_argument(node, topic).partition(":=")[0] or topic
    return state("end-one-or-remap", other=node, old=old, new=f"{topic}_2", **known)


@rule(
    "slow-simulator",
    remedy="subscribe to fewer sensors, or simulate fewer robots",
    title={
        "jumping-simulator": "Simulated time jumps back:",
        "paused-simulator": "Simulated time stands still:",
        "overloaded-simulator": "Simulated time passes at {ratio:.2f} of real time{target:not}:"
        " the simulator is overloaded",
        "slow-simulator": "Simulated time passes at {ratio:.2f} of real time{target:not}",
    },
    facts={**PROGRAM, "jumps-back": "{program}: {count:times}"},
    remedies={
        "resume": "if that was not intended: `lcmtools sim resume`",
        "set-rate": "if that was not intended: `lcmtools sim set-rate {rate:g}`",
        "simulate-less": "end programs that subscribe to cameras, or give it fewer robots",
        "time-rises": "unless it was a reset, or a log that is played again: publish on /clock a"
        " time that only rises",
    },
    evidence="messages on /clock, the processor time of their publisher",
    root_only="that processor time, if it is another user's program",
)
def simulated_time_passes(evidence: Evidence) -> Iterator[Finding]:
    """A simulator keeps up with real time, or with the rate that it was started with.

    A simulator that computes all the time and is still slower is overloaded. One that is idle at
    times was slowed down, or paused, on purpose. Its time
    only rises, except after a reset or when a log is played again.
    """
    # by its own counter, for wtf may have missed what came
    resting = (node for node in resting_simulators(evidence) if not node.stale)
    paused = [node for node in resting if is_paused(node, evidence.graph.time)]
    clock = evidence.clock
    facts = [state("program", program=node) for node in paused]
    if clock and clock.ratio == 0 and not paused:
        facts.append(state("program", program=clock.name))
    remedies = [state("resume")] if any(map(_is_ours, paused)) else []
    yield from finding("paused-simulator", facts, *remedies, severity=Severity.NOTE)
    if clock and clock.jumps:
        jumps = state("jumps-back", program=clock.name, count=clock.jumps)
        severity = Severity.WARNING if clock.jumps > 1 else Severity.NOTE
        yield from finding("jumping-simulator", [jumps], "time-rises", severity=severity)
    if not (clock and clock.target and clock.ratio and clock.ratio <= _SLOWER * clock.target):
        return
    known = {"ratio": clock.ratio, "target": clock.target}
    facts = [state("program", program=clock.name)]
    if clock.busy is not None and clock.busy > _BUSY:
        yield from finding(state("overloaded-simulator", **known), facts, "simulate-less")
    else:
        is_ours = any(_is_ours(node) for node in evidence.graph.nodes if node.name == clock.name)
        remedies = [state("set-rate", rate=clock.target)] if is_ours else []
        title = state("slow-simulator", **known)
        yield from finding(title, facts, *remedies, severity=Severity.NOTE)


def _is_ours(node: NodeInfo) -> bool:  # the simulator of lcmtools, which commands can control
    services = (base_name_of(end.topic) for end in node.having(Role.SERVICE))
    return "set_rate" in services
