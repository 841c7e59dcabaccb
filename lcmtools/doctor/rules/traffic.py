"""Rules about the messages that come: lost, silent, irregular, too many, from too many."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import pairwise
from statistics import median

from lcmtools.doctor.model import Evidence, Finding, SenderFacts, Severity, Stream, rule
from lcmtools.doctor.rules.callbacks import busy_nodes
from lcmtools.doctor.rules.types import disagree
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.callbacks import duration_text
from lcmtools.observe.rates import average_rate, counted_rate

_SHARED = frozenset({"/rosout", "/tf", "/tf_static", "/diagnostics"})
_SILENCE = 3.0  # [s]
_PERIODS = 10  # without a message are silence
_ENOUGH = 20  # messages to speak of a rate
_FALLEN = 0.5
_UNEVEN = 8  # times the usual interval
_BLAME = 0.6  # of a gap: who waited so long for a processor is not to blame for it
_SHORTEST = 0.1  # [s] an interval that is worth a word
_SHARE = 0.5  # of what an interface can carry
_WIRELESS = 1e6  # [byte/s] of multicast


@rule("loss", Severity.WARNING, "less data, a wired network, or recv_buf_size=N in the URL")
def nothing_is_lost(evidence: Evidence) -> Iterator[Finding]:
    """Every message that is sent arrives at this computer.

    Each sender numbers its messages, so a gap is a loss: of the network for other computers, of the
    sender itself for this one's. What wtf was too slow for does not count.
    """
    lossy = [s for s in evidence.senders if s.lost > evidence.own_drops]
    if not lossy:
        return
    rows = []
    for s in sorted(lossy, key=lambda one: -one.lost):
        where = "before they left it" if s.is_local else "on the network"
        share = 100 * s.lost / (s.lost + s.messages)
        rows.append(f" * {_called(s)}: {s.lost} of {s.lost + s.messages} ({share:.1f} %) {where}")
    yield Finding(
        "loss",
        Severity.WARNING,
        "Messages of the following senders were lost:",
        tuple(rows),
        ("send less or smaller messages; a large one is lost with any of its parts",),
    )


def _called(sender: SenderFacts) -> str:
    """A sender with its address, once where nothing else is known of it."""
    address = str(sender.sender)
    return address if sender.name == address else f"{sender.name} ({address})"


@rule(
    "silent", Severity.WARNING, "look at the node's log, and whether what it waits for still comes"
)
def publishers_publish(evidence: Evidence) -> Iterator[Finding]:
    """Publishers that published often still do.

    By their own counters, and by what came while wtf listened. Many have a reason: nobody steers,
    or nobody listens.
    """
    rows = []
    for node, endpoint in _heard_publications(evidence):
        rate = average_rate(node, endpoint)
        age = (evidence.graph.time - endpoint.last_time) / 1e9
        if endpoint.messages >= _ENOUGH and rate and age > max(_SILENCE, _PERIODS / rate):
            rows.append(f" * {node.name}: {endpoint.topic}, {age:.0f} s ago, {rate:.3g} Hz before")
    for stream in _wanted_streams(evidence):
        interval = _usual_interval(stream)
        end = evidence.graph.time
        age = (end - stream.times[-1]) / 1e9
        # of what wtf itself was too slow for, or had to leave out, the last time is not known
        is_known = not stream.is_cut and not evidence.own_drops
        is_late = is_known and age * _BLAME > evidence.waited
        if interval and is_late and age > max(_PERIODS * interval, 0.5):
            rows.append(
                f" * {stream.name}: {stream.channel}, {age:.1f} s ago, {1 / interval:.3g} Hz before"
            )
    if rows:
        text = "The following have stopped publishing:"
        yield Finding("silent", Severity.NOTE, text, tuple(rows))
    # of these other rules say it
    nodes = {node.pid for node in evidence.own_nodes()} | {x.pid for x in evidence.listeners}
    stopped = [
        process
        for process in evidence.processes
        if process.state in ("T", "t") and not (process.bus or process.pid in nodes)
    ]
    if stopped:
        yield Finding(
            "silent",
            Severity.WARNING,
            "The following programs are stopped, and send nothing:",
            tuple(f" * {process.command} (pid {process.pid})" for process in stopped),
            tuple(f"wake it (kill -CONT {p.pid}) or end it (kill {p.pid})" for p in stopped),
        )


@rule(
    "slow-rate",
    Severity.NOTE,
    "see what the node or its computer is busy with: lcmtools node info, top",
)
def rates_do_not_fall(evidence: Evidence) -> Iterator[Finding]:
    """Publishers are as fast as they were on average since they started."""
    before = {
        (node.id, endpoint.topic): endpoint
        for node in evidence.before.nodes
        for endpoint in node.having(Role.PUBLISHER)
    }
    rows = []
    for node, endpoint in _heard_publications(evidence):
        earlier = before.get((node.id, endpoint.topic))
        usual = average_rate(node, earlier) if earlier else None
        now = counted_rate(earlier, endpoint) if earlier else None
        if earlier and usual and now and earlier.messages >= 5 * _ENOUGH:
            expected = usual * evidence.listened
            if expected >= _ENOUGH and now < _FALLEN * usual:
                rows.append(
                    f" * {node.name}: {endpoint.topic}, {now:.3g} Hz in place of {usual:.3g} Hz"
                )
    if rows:
        yield Finding("slow-rate", Severity.NOTE, "The following have become slower:", tuple(rows))


@rule(
    "irregular",
    Severity.NOTE,
    "lcmtools hz TOPIC shows the intervals; look for what blocks the node",
)
def rates_are_even(evidence: Evidence) -> Iterator[Finding]:
    """What comes often comes evenly: a gap may be a callback that blocks, or a busy computer."""
    rows = []
    for stream in _wanted_streams(evidence):
        interval = _usual_interval(stream)
        if interval and len(stream.times) >= _ENOUGH and not is_hidden(stream.channel):
            longest = max(later - earlier for earlier, later in pairwise(stream.times)) / 1e9
            # who had to wait for a processor is not to blame
            is_late = longest * _BLAME > evidence.waited
            if is_late and longest > max(_SHORTEST, _UNEVEN * interval):
                rows.append(
                    f" * {stream.name}: {stream.channel}, {longest:.2f} s without a message,"
                    f" usually {duration_text(1e9 * interval)}"
                )
    if rows:
        yield Finding("irregular", Severity.NOTE, "The following come unevenly:", tuple(rows))


@rule("competing-publishers", Severity.WARNING, "end one of them, or remap it: OLD:=NEW")
def topics_have_one_publisher(evidence: Evidence) -> Iterator[Finding]:
    """No two programs send on the same topic at the same time, or on alternatives of one input.

    Two that steer the same robot fight over it. Topics meant for many, as /tf, are excepted, and
    those on which different types are sent, which another rule says.
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
        yield Finding(
            "competing-publishers",
            Severity.WARNING,
            f"{count} programs publish on {' and '.join(names)} at the same time:",
            tuple(f" * {stream.name}: {stream.channel}" for stream in found),
            (_parting(evidence, found, names[0]),),
        )


def _parting(evidence: Evidence, streams: Sequence[Stream], topic: str) -> str:
    """What ends the fight of several over a topic."""
    kills = [f"(kill {pid})" for pid in dict.fromkeys(one.pid for one in streams) if pid]
    end = f"end one of them {' or '.join(kills)}" if len(kills) > 1 else "end one of them"
    nodes = {sender for node in evidence.graph.nodes for sender in node.senders()}
    if any(one.sender in nodes for one in streams):
        return f"{end}, or start it with {topic}:={topic}_2"
    return f"{end}, or let it publish on another channel"


@rule("bandwidth", Severity.WARNING, "send smaller messages, or less often: lcmtools bw TOPIC")
def the_network_has_room(evidence: Evidence) -> Iterator[Finding]:
    """The bus does not fill the network.

    Wi-Fi sends multicast at its slowest rate, so that a few images a second can fill it.
    """
    host = evidence.host
    if not evidence.listened or not evidence.ttl or host.interface in ("", "lo"):
        return
    rate = sum(stream.bytes for stream in evidence.streams) / evidence.listened
    limit = _WIRELESS if host.is_wireless else _SHARE * host.speed_mbit * 1e6 / 8
    if limit and rate > limit:
        heaviest = sorted(evidence.streams, key=lambda stream: -stream.bytes)[:3]
        yield Finding(
            "bandwidth",
            Severity.WARNING,
            f"{host.interface} is too slow for the bus, which carries {rate / 1e6:.1f} MB/s:",
            tuple(
                f" * {s.channel} from {s.name}: {s.bytes / evidence.listened / 1e6:.2f} MB/s"
                for s in heaviest
            ),
            ("keep what only this computer needs on a bus with ttl=0",),
        )


@rule(
    "slow-simulator",
    Severity.WARNING,
    "let fewer sensors be listened to, or slow it: lcmtools sim set-rate",
)
def simulated_time_passes(evidence: Evidence) -> Iterator[Finding]:
    """A simulator keeps up with real time, or with the rate that it was started with.

    One that computes all the time, and is slower nevertheless, has too much to do. One that rests
    was told to be slow.
    """
    clock = evidence.clock
    if (
        clock is None
        or clock.wanted is None
        or clock.ratio <= 0
        or clock.ratio > 0.9 * clock.wanted
    ):
        return
    overloaded = clock.busy is not None and clock.busy > _BUSY
    yield Finding(
        "slow-simulator",
        Severity.WARNING if overloaded else Severity.NOTE,
        f"Simulated time passes at {clock.ratio:.2f} of real time"
        f"{f', not {clock.wanted:g}' if clock.wanted != 1 else ''}"
        + (": the simulator has too much to do" if overloaded else ""),
        (f" * {clock.name}",),
        ("end what listens to cameras, or give it fewer robots",)
        if overloaded
        else (f"if nobody wanted that: lcmtools sim set-rate {clock.wanted:g}",),
    )


_BUSY = 0.85


def _heard_publications(evidence: Evidence) -> Iterator[tuple[Node, Endpoint]]:
    """What nodes publish that is listened to, but by simulators that rest."""
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
    """The streams but those of nodes that nobody has subscribed to: these may rest as they like.

    A simulator measures them while somebody listens to everything, as wtf does.
    """
    ends = [(e, node) for node in evidence.graph.nodes if not node.stale for e in node.endpoints]
    published = {e.topic for e, _ in ends if e.role is Role.PUBLISHER}
    heard = {e.topic for e, node in ends if e.role is Role.SUBSCRIBER and not node.tool}
    busy = busy_nodes(evidence)  # of these another rule says why
    return [
        s
        for s in evidence.streams
        if (s.channel in heard or s.channel not in published) and s.name not in busy
    ]


def _usual_interval(stream: Stream) -> float | None:
    """The median interval between the messages of a stream [s]; None where there are few."""
    if len(stream.times) < 5 or is_hidden(stream.channel):  # noqa: PLR2004 - too few to tell
        return None
    return median(later - earlier for earlier, later in pairwise(stream.times)) / 1e9 or None
