"""Rules about callbacks: whether nodes keep up with what they hear, and if not, why."""

from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.callbacks import busy_share, callback_time, duration_text
from lcmtools.observe.rates import counted_rate

_NEARLY_ALL = 0.9  # of the time between two messages: a callback that takes it cannot keep up
_ALWAYS = 0.95  # of the time in callbacks: whatever else waits comes late
_UNBROKEN = 0.999  # without a pause: no busy computer makes it so
_CROWDED = 0.25  # of the time that programs wait for a processor is a busy computer
_ENOUGH_CALLS = 5  # the first ones may load what the later ones need
_HANGS = 3_000_000_000  # [ns] in one call


@dataclass(frozen=True, slots=True)
class _Ear:
    """A subscription between two looks.

    Attributes:
        node: Its node, as it is now.
        endpoint: Itself, as it is now.
        lost: Messages that its full queue pushed out meanwhile.
        took: What a call of its callback took [ns]; None where none ran.
        interval: The time between two messages [ns]; None where that is not known.
        share: Which part of the time its node was in any callback; None where not known.
        busiest: What took most of that time, but for this ("the timers"); "" for nothing.
    """

    node: Node
    endpoint: Endpoint
    lost: int
    took: float | None
    interval: float | None
    share: float | None
    busiest: str

    def is_too_slow(self, crowd: float = 0.0) -> bool:
        """Whether its callback takes longer than there is between two messages.

        Args:
            crowd: Which part of its time it may have waited for a processor.
        """
        if self.took is None or self.interval is None:
            return False
        return self.took * (1 - crowd) >= _NEARLY_ALL * self.interval

    def pace(self) -> str:
        """How long the callback takes, and how often messages come."""
        return (
            f"its callback takes {duration_text(self.took or 0)},"
            f" messages come every {duration_text(self.interval or 0)}"
        )


@rule("queue-drops", Severity.WARNING, "make the callback faster, or the queue's depth greater")
def queues_have_room(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks keep up with their messages.

    A subscription keeps the newest messages, as many as its depth; what a slow callback leaves in
    there too long is lost. Depth 1 asks for that. The callback itself may be slow, another one of
    the node may hold it up, or the messages come in bursts.
    """
    lossy = [ear for ear in _ears(evidence) if ear.lost > 0]
    if lossy:
        reasons = [_reason(ear) for ear in lossy]
        yield Finding(
            "queue-drops",
            Severity.WARNING,
            "The following nodes are too slow for what they hear:",
            tuple(
                f" * {ear.node.name} lost {ear.lost} messages of {ear.endpoint.topic}"
                f" (depth {ear.endpoint.depth}){f': {why}' if why else ''}"
                for ear, (why, _) in zip(lossy, reasons, strict=True)
            ),
            tuple(dict.fromkeys(remedy for _, remedy in reasons)),
        )


@rule(
    "slow-callbacks",
    Severity.WARNING,
    "let the callback do less, or less often: lcmtools info TOPIC shows how long it takes",
)
def callbacks_are_quick(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks are done before the next message comes, and leave time for the others.

    All callbacks of a node run one after another. One that takes as long as there is between two
    messages lets them wait ever longer; one that never ends lets timers, services and all other
    topics wait. A subscription of depth 1 is excepted: it asks for the newest message only. So is
    what a busy computer may be to blame for.
    """
    _, slow, busy = _judged(evidence)
    if slow or busy:
        rows = [f" * {ear.node.name}, {ear.endpoint.topic}: {ear.pace()}" for ear in slow]
        rows += [
            f" * {node.name} is in its callbacks {100 * share:.0f} % of the time, most in {name}"
            for node, share, name in busy
        ]
        remedies = [f"let the callback of {ear.endpoint.topic} do less" for ear in slow]
        remedies += [f"let {name} of {node.name} do less, and never wait" for node, _, name in busy]
        if slow:
            remedies.append("where only the newest message counts, subscribe with depth=1")
        yield Finding(
            "slow-callbacks",
            Severity.WARNING,
            "The following callbacks take too long:",
            tuple(rows),
            tuple(dict.fromkeys(remedies)),
        )


def busy_nodes(evidence: Evidence) -> set[str]:
    """The names of the nodes that are slow: what they do not send in time has its reason."""
    lossy, slow, busy = _judged(evidence)
    names = {node.name for node in evidence.graph.nodes if node.id in lossy}
    return names | {ear.node.name for ear in slow} | {node.name for node, _, _ in busy}


def _judged(evidence: Evidence) -> tuple[set[str], list[_Ear], list[tuple[Node, float, str]]]:
    """The ids of nodes that lose messages, slow callbacks of others, and what keeps a node busy."""
    ears, crowd = list(_ears(evidence)), _crowd(evidence)
    lossy = {ear.node.id for ear in ears if ear.lost > 0}  # of these another rule says why
    slow = [
        ear
        for ear in ears
        if ear.is_too_slow(crowd) and _is_at_work(ear.endpoint) and ear.node.id not in lossy
    ]
    told = lossy | {ear.node.id for ear in slow}
    busy = [
        (node, share, names)
        for earlier, node in _pairs_of_nodes(evidence)
        if node.id not in told and _is_waited_for(node)
        if (share := _share_of_others(earlier, node)) is not None
        if share - crowd >= _ALWAYS or share >= _UNBROKEN
        if (names := _busiest(earlier, node))
    ]
    return lossy, slow, busy


def _crowd(evidence: Evidence) -> float:
    """Which part of the time programs waited for a processor, where it is worth a thought."""
    share = min(1.0, evidence.waited / evidence.listened) if evidence.listened else 0.0
    return share if share > _CROWDED else 0.0


def _reason(ear: _Ear) -> tuple[str, str]:
    """Why messages were lost, and what helps; "" where it does not show."""
    topic = ear.endpoint.topic
    if ear.share is None:
        return "", f"let the callback of {topic} do less, or give a greater queue depth"
    if ear.is_too_slow():
        least = duration_text(ear.took or 0)
        return ear.pace(), f"let the callback of {topic} do less, or publish it every {least} only"
    if not ear.share:
        name = ear.node.name
        return "no callback has run", f"let {name} spin: lcmtools.spin(node), or often spin_once"
    if ear.share >= _NEARLY_ALL and ear.busiest:
        why = f"its node is in {ear.busiest} most of the time"
        return why, f"let {ear.busiest} of {ear.node.name} do less, and never wait"
    if ear.endpoint.depth * (ear.interval or 0) < ear.endpoint.longest:
        why = f"a call of its callback took {duration_text(ear.endpoint.longest)}"
        return why, f"let the callback of {topic} never wait, or give a greater queue depth"
    return "they come in bursts", f"give the subscription of {topic} a greater queue depth"


def _ears(evidence: Evidence) -> Iterator[_Ear]:
    """The subscriptions that want every message, between the two looks."""
    for earlier, node in _pairs_of_nodes(evidence):
        share = busy_share(earlier, node)
        for before, endpoint in _pairs(earlier, node):
            if endpoint.role is Role.SUBSCRIBER and endpoint.depth > 1:
                rate = counted_rate(before, endpoint)
                yield _Ear(
                    node,
                    endpoint,
                    endpoint.drops - before.drops,
                    callback_time(before, endpoint),
                    1e9 / rate if rate else None,
                    share,
                    _busiest(earlier, node, but=endpoint),
                )


def _pairs_of_nodes(evidence: Evidence) -> Iterator[tuple[Node, Node]]:
    """Each node that is part of the system, as it was and as it is."""
    before = {node.id: node for node in evidence.before.nodes}
    for node in evidence.graph.nodes:
        if node.id in before and not (node.tool or node.stale):
            yield before[node.id], node


def _pairs(earlier: Node, later: Node) -> Iterator[tuple[Endpoint, Endpoint]]:
    """Each endpoint as it was and as it is; a node may have several that are alike."""
    known: dict[object, list[Endpoint]] = {}
    for endpoint in earlier.endpoints:
        known.setdefault(_key(endpoint), []).append(endpoint)
    for endpoint in later.endpoints:
        same = known.get(_key(endpoint))
        if same:
            yield same.pop(0), endpoint


def _key(endpoint: Endpoint) -> tuple[object, ...]:
    return endpoint.topic, endpoint.role, endpoint.types, endpoint.depth


def _is_at_work(endpoint: Endpoint) -> bool:
    """Whether its callback has run for long enough to be judged."""
    return endpoint.calls >= _ENOUGH_CALLS or endpoint.longest >= _HANGS


def _is_waited_for(node: Node) -> bool:
    """Whether a node has anything else to do than what it is busy with."""
    return any(
        (e.role is Role.SUBSCRIBER and e.depth > 1)
        or (e.role is Role.SERVICE and not is_hidden(e.topic))
        for e in node.endpoints
    )


def _share_of_others(earlier: Node, node: Node) -> float | None:
    """The share of the time in callbacks, but for those of depth 1, which may take all of it."""
    spent = node.busy - earlier.busy
    for before, endpoint in _pairs(earlier, node):
        if endpoint.role is Role.SUBSCRIBER and endpoint.depth == 1:
            spent -= endpoint.busy - before.busy
    return busy_share(earlier, node, spent)


def _busiest(earlier: Node, node: Node, but: Endpoint | None = None) -> str:
    """What took most of the time in callbacks: a topic's or service's, or the timers."""
    spent = {
        f"the callback of {e.topic}": e.busy - before.busy
        for before, e in _pairs(earlier, node)
        if e.busy > before.busy
    }
    timers = node.busy - earlier.busy - sum(spent.values())
    if but is not None:
        spent.pop(f"the callback of {but.topic}", None)
    if timers > 0:
        spent["the timers"] = timers
    return max(spent, key=lambda name: spent[name], default="")
