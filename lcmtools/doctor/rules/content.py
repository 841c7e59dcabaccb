"""Rules about the content of messages, and the coordinate frames in transforms."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace
from shlex import quote

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.doctor.evidence import Evidence, FrameParent, Oddity
from lcmtools.doctor.findings import Finding, Severity, Statement, finding, rule, state
from lcmtools.doctor.rules.shared import DECODED, SET_CLOCKS
from lcmtools.observe.actuators import JOINTS, unattended_commands
from lcmtools.observe.simulators import publishes_time, silence

_LOG = "file://"
_FRESH = 1_000_000_000  # [ns] since a command: a robot with a timeout may still roll
_ODDITY = {"oddity": "{topic} from {sender}: {text}{messages:count}"}


@rule(
    "not-finite",
    remedy="find where it divides by zero, and do not publish it",
    title="Numbers that are published are not finite:",
    facts=_ODDITY,
    remedies={"print-values": "print the values where the node computes them"},
    evidence=DECODED,
)
def numbers_are_finite(evidence: Evidence) -> Iterator[Finding]:
    """Published numbers are finite.

    A NaN spreads through every later computation, and a robot that gets NaN m/s as its velocity may
    do anything. Ranges of lasers may be infinite.
    """
    return _odd(evidence, "not-finite", "print-values")


@rule(
    "quaternions",
    remedy="set w to 1 for no rotation, and normalise what is computed",
    title={"quaternion": "Rotations that are published are invalid:"},
    facts=_ODDITY,
    remedies={"normalise": "for no rotation use x=0, y=0, z=0, w=1; divide others by their length"},
    evidence=DECODED,
)
def quaternions_are_rotations(evidence: Evidence) -> Iterator[Finding]:
    """Quaternions are rotations: their length is 1.

    All zeros, as in a field that was never set, is not a rotation.
    """
    return _odd(evidence, "quaternion", "normalise")


@rule(
    "covariances",
    remedy="fill both halves, and no negative number on the diagonal",
    title={"covariance": "Covariances that are published are invalid:"},
    facts=_ODDITY,
    remedies={
        "symmetric": "set [row, column] and [column, row] to the same value, and no [row, row]"
        " below 0",
        "unknown-covariance": "if nothing is known, set the first number to -1",
    },
    evidence=DECODED,
)
def covariances_are_covariances(evidence: Evidence) -> Iterator[Finding]:
    """Covariance matrices are symmetric, and variances not negative.

    A filter that gets any other matrix diverges. -1 as the first number means: unknown.
    """
    return _odd(evidence, "covariance", "symmetric", "unknown-covariance")


@rule(
    "stamps",
    remedy="set the clocks (chrony, ntp), or _use_sim_time:=true as the others",
    title={
        "boot": "Messages are stamped with the time since a start, and nothing publishes /clock:",
        "future": "Messages are stamped with a time in the future:",
        "nsec": "Times that are published are invalid:",
        "old": "Messages are stamped with a time long ago:",
        "replayed": "Stamps are old but advance at the clock's rate, as if a log were played:",
        "unit": "Times that are published are in the wrong unit:",
    },
    facts=_ODDITY,
    remedies={
        **SET_CLOCKS,
        "if-no-log": "if it is not a log, its computer's clock is wrong:"
        " `sudo timedatectl set-ntp true`",
        "microseconds": "message.utime = time.time_ns() // 1000",
        "split-time": "sec, nsec = divmod(time.time_ns(), 1_000_000_000)",
        "stamp-if-no-log": "if it is not a log, stamp with the time at which it is sent",
        "stamp-utc": "stamp with the time since 1970: time.time(), node.get_clock().now()",
        "use-sim-time": "if a simulator runs, start the node with _use_sim_time:=true",
    },
    unless={"clocks": "far", "stale-nodes": "published"},
    evidence=DECODED,
)
def stamps_are_current(evidence: Evidence) -> Iterator[Finding]:
    """Messages are stamped with the time at which they are sent.

    Stamps in the future or long ago come from a wrong clock, or from a node that does not use the
    simulator's time as the others do. A computer whose clock differs is reported by another rule.
    A utime, in messages without a header, is microseconds since 1970, or the time of another clock;
    a timestamp, t, time_ms or the like is in the unit that makes it a time of this century.
    Old stamps that advance at the clock's rate are a note: a log may be played.
    """
    # a single old message may be a latched one
    mine = [odd for odd in evidence.oddities if odd.kind != "old" or odd.count > 1]
    evidence = replace(evidence, oddities=mine)
    yield from _odd(evidence, "future", *_clocks(evidence, "future"), "use-sim-time")
    if not any(map(publishes_time, evidence.graph.nodes)):
        yield from _odd(evidence, state("boot").of("topic", CLOCK_TOPIC), "stamp-utc")
    yield from _odd(evidence, "nsec", "split-time")
    yield from _odd(evidence, "unit", "microseconds")
    yield from _odd(evidence, "old", *_clocks(evidence, "old"), "use-sim-time")
    yield from _odd(evidence, "replayed", *_clocks(evidence, "replayed"), severity=Severity.NOTE)


@rule(
    "undecodable",
    remedy="generate the sender's types again from the same .lcm files",
    title="Messages cannot be decoded:",
    facts=_ODDITY,
    remedies={"use-lcm-gen": "let the sender use lcm-gen's code, unchanged"},
    evidence=DECODED,
)
def messages_can_be_decoded(evidence: Evidence) -> Iterator[Finding]:
    """Messages can be decoded as the type that their fingerprint names."""
    return _odd(evidence, "undecodable", "use-lcm-gen")


@rule(
    "damaged-log",
    remedy="lcmtools bag fix writes the log without them",
    title="{bytes} bytes of {log} do not belong to any message",
    remedies={"fix-log": "`lcmtools bag fix {log} fixed.lcmlog` leaves them out"},
    evidence="the log (`--bag`)",
)
def logs_are_whole(evidence: Evidence) -> Iterator[Finding]:
    """All bytes of a log belong to messages.

    A recorder that is killed, a full disk or a broken transfer cuts a message off or leaves bytes
    between messages; the messages that were there are lost.
    """
    if evidence.damaged_bytes:
        log = evidence.url.removeprefix(_LOG)
        title = state("damaged-log", log=log, bytes=evidence.damaged_bytes)
        yield from finding(title, None, state("fix-log", log=quote(log)))


@rule(
    "driven-by-nobody",
    remedy="stop it: lcmtools pub -1 TOPIC TYPE",
    title="Robots drive by a command of a program that has ended:",
    facts={
        "drives-on": "{node} {text}, by {topic}, which nobody publishes any more; the last"
        " command came {seconds:time} ago"
    },
    remedies={
        "send-zeros": "publish zeros: `lcmtools pub -1 {topic} {type}`",
        "zero-joints": "publish zeros for all joints on {topic}, or start its controller again",
    },
    evidence="announcements; " + DECODED,
)
def robots_are_commanded(evidence: Evidence) -> Iterator[Finding]:
    """A robot that drives is commanded by a program that runs.

    A robot without a timeout obeys the last velocity or effort until another one comes, also if the
    program that sent it was killed or has ended. Only robots that are nodes and publish their
    odometry beside the command are found.
    """
    sent = {stream.channel for stream in evidence.streams if not stream.has_ended}
    drives = {odd.topic: odd.text for odd in evidence.oddities if odd.kind == "drives"}
    facts, remedies = {}, {}
    for node, end, odometry in unattended_commands(evidence.graph):
        age = silence(node, end, evidence.graph.time)
        if odometry in drives and end.topic not in sent and age > _FRESH:
            text, seconds = drives[odometry], age / 1e9
            facts[end.topic] = state(
                "drives-on", node=node, text=text, topic=end.topic, seconds=seconds
            )
            kind = "zero-joints" if end.type == JOINTS else "send-zeros"
            remedies[end.topic] = state(kind, topic=quote(end.topic), type=end.type)
    yield from finding("driven-by-nobody", facts.values(), *remedies.values())


def _clocks(evidence: Evidence, kind: str) -> list[Statement]:
    """Return the remedies for stamps: senders on this computer have the same clock."""
    is_log = evidence.url.startswith(_LOG)
    own = {sender.name for sender in evidence.senders if sender.is_local and not is_log}
    is_replayed = kind == "replayed"

    def remedy(odd: Oddity) -> str:
        if odd.name not in own:
            return "if-no-log" if is_replayed else "set-clocks"
        usual = "microseconds" if odd.text.startswith("utime") else "stamp-utc"
        return "stamp-if-no-log" if is_replayed else usual

    odd_ones = [odd for odd in evidence.oddities if odd.kind == kind]
    return [state(remedy(odd)).of("who", odd.name) for odd in odd_ones]


def _odd(
    evidence: Evidence,
    title: str | Statement,
    *remedies: str | Statement,
    severity: Severity = Severity.WARNING,
) -> Iterator[Finding]:
    kind = title.kind if isinstance(title, Statement) else title
    facts = (
        state("oddity", topic=odd.topic, sender=odd.name, text=odd.text, messages=odd.count)
        for odd in evidence.oddities
        if odd.kind == kind
    )
    return finding(title, facts, *remedies, severity=severity)


@rule(
    "frames",
    remedy="send each child_frame_id from one program, below one header.frame_id",
    title={
        "frame-loop": "The following frames form a loop:",
        "frame-parents": "The following frames have several parents:",
    },
    facts={
        "frame-loop": "{frames}, from {senders:and}",
        "frame-parents": "{frame} is in {parents:and}",
    },
    remedies={
        "exchange-frames": "header.frame_id is the parent, child_frame_id the child: swap them in"
        " one of the transforms",
        "one-parent": "let one program publish the pose of a frame, in one header.frame_id, or"
        " give the frames of different things different names",
    },
    evidence=DECODED,
)
def frames_are_trees(evidence: Evidence) -> Iterator[Finding]:
    """Frames form trees: each has one parent at most, and none is below itself.

    With two parents, who looks a transform up gets now the one, now the other; in a circle nothing
    can be looked up.
    """
    trees: dict[str, dict[str, list[FrameParent]]] = defaultdict(lambda: defaultdict(list))
    for one in sorted(evidence.frames, key=repr):  # the same in each look
        trees[one.tree][one.child].append(one)
    several, loops = [], []
    for tree in trees.values():
        for child, links in tree.items():
            if len({one.parent for one in links}) > 1:
                parents = [f"{one.parent} (by {one.name})" for one in links]
                several.append(state("frame-parents", frame=child, parents=tuple(parents)))
        for loop in _loops({child: links[0].parent for child, links in tree.items()}):
            senders = dict.fromkeys(tree[child][0].name for child in loop)
            way = " -> ".join((*loop, loop[0]))
            loops.append(state("frame-loop", frames=way, senders=senders))
    yield from finding("frame-parents", several, "one-parent")
    yield from finding("frame-loop", loops, "exchange-frames")


def _loops(parents: Mapping[str, str]) -> list[tuple[str, ...]]:
    """Return each loop once, each frame before its parent."""
    circles: dict[frozenset[str], tuple[str, ...]] = {}
    for start in parents:
        path, frame = [], start
        while frame in parents and frame not in path:
            path.append(frame)
            frame = parents[frame]
        if frame in path:
            circle = tuple(path[path.index(frame) :])
            circles.setdefault(frozenset(circle), circle)
    return list(circles.values())
