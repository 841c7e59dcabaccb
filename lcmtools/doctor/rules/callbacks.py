"""Rules about callbacks: nodes that are too slow for their messages, and the causes."""

from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Part, Statement, cases, rule, state
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.counters import busy_share, callback_time, counted_rate

_NEARLY_ALL = 0.9  # of the time between two messages: a callback that takes it cannot keep up
_ALWAYS = 0.95  # of the time in callbacks: everything else that waits comes late
_UNBROKEN = 0.999  # without a pause: no busy computer makes it so
_CROWDED = 0.25  # of the time that programs wait for a processor is a busy computer
_ENOUGH_CALLS = 5  # the first ones may load what the later ones need
_HANGS = 3_000_000_000  # [ns] in one call


@dataclass(frozen=True, slots=True)
class _Subscription:
    """A subscription between the start and the end of the look."""

    node: Node  # as it is now
    endpoint: Endpoint  # as it is now
    lost: int  # messages that its full queue pushed out meanwhile
    took: float | None  # [ns] a call of its callback; None where none ran
    interval: float | None  # [ns] between two messages
    share: float | None  # of the time that its node spent in any callback
    busiest: str  # the topic, or "timers", that took most of that time besides; "" for nothing

    @property
    def topic(self) -> str:
        return self.endpoint.topic

    def is_too_slow(self, crowd: float = 0.0) -> bool:
        """Return whether its callback takes longer than the time between two messages.

        ``crowd`` is the share of its time that it may have waited for a processor.
        """
        took, interval = self.took, self.interval
        return bool(took and interval and took * (1 - crowd) >= _NEARLY_ALL * interval)

    def pace(self) -> dict[str, Part]:
        """The time that its callback takes, and the time between two messages [s]."""
        return {"callback_time": (self.took or 0) / 1e9, "interval": (self.interval or 0) / 1e9}


@rule("queue-drops", "make the callback faster, or the queue's depth greater")
def queues_have_room(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks keep up with their messages.

    A subscription keeps the newest messages, as many as its depth; those that a slow callback
    leaves in the queue too long are lost. Depth 1 requests that. The callback itself may be slow,
    another one of the node may hold it up, or the messages come in bursts.
    """
    lossy = [one for one in _subscriptions(evidence) if one.lost > 0]
    found = list(map(_cause, lossy))
    return cases("queue-drops", (fact for fact, _ in found), *(remedy for _, remedy in found))


@rule(
    "slow-callbacks",
    "make the callback faster, or call it less often: lcmtools info TOPIC shows how long it takes",
)
def callbacks_are_quick(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks end before the next message comes, and leave time for the others.

    All callbacks of a node run one after another. One that takes as long as there is between two
    messages lets them wait ever longer; one that never ends lets timers, services and all other
    topics wait. A subscription of depth 1 is excepted: it requests the newest message only. So is
    what a busy computer may be to blame for.
    """
    _, slow, busy = _judged(evidence)
    facts = [state("slow-callback", node=x.node, topic=x.topic, **x.pace()) for x in slow]
    remedies = [state("callback-less", topic=one.topic) for one in slow]
    for node, share, busiest in busy:
        facts.append(state("busy-node", node=node, percent=100 * share, busiest=busiest))
        remedies.append(state("busiest-less", node=node, busiest=busiest))
    if slow:
        remedies.append(state("depth-1"))
    return cases("slow-callbacks", facts, *remedies)


def busy_nodes(evidence: Evidence) -> set[str]:
    """The names of the nodes that are slow, which explains what they do not send in time."""
    lossy, slow, busy = _judged(evidence)
    names = {node.name for node in evidence.graph.nodes if node.id in lossy}
    return names | {one.node.name for one in slow} | {node.name for node, _, _ in busy}


def _judged(
    evidence: Evidence,
) -> tuple[set[str], list[_Subscription], list[tuple[Node, float, str]]]:
    """The ids of nodes that lose messages, slow callbacks of others, and busy nodes with causes."""
    subscriptions, crowd = list(_subscriptions(evidence)), _crowd(evidence)
    lossy = {one.node.id for one in subscriptions if one.lost > 0}  # another rule's
    slow = [
        one
        for one in subscriptions
        if one.is_too_slow(crowd) and _is_at_work(one.endpoint) and one.node.id not in lossy
    ]
    reported = lossy | {one.node.id for one in slow}
    busy = [
        (node, share, busiest)
        for earlier, node in _pairs_of_nodes(evidence)
        if node.id not in reported and _has_other_work(node)
        if (share := _share_of_others(earlier, node)) is not None
        if share - crowd >= _ALWAYS or share >= _UNBROKEN
        if (busiest := _busiest(earlier, node))
    ]
    return lossy, slow, busy


def _crowd(evidence: Evidence) -> float:
    """The share of time that programs waited for a processor, where it is considerable."""
    share = min(1.0, evidence.processor_wait / evidence.listened) if evidence.listened else 0.0
    return share if share > _CROWDED else 0.0


def _cause(one: _Subscription) -> tuple[Statement, Statement]:
    """The fact that messages were lost, with the cause where it is known; and the remedy."""
    node, topic, endpoint = one.node, one.topic, one.endpoint

    def lost(cause: str, **parts: Part) -> Statement:
        known = {"lost": one.lost, "topic": topic, "depth": endpoint.depth, **parts}
        return state(f"dropped-{cause}", node=node, **known)

    if one.share is None:
        return lost("by-queue"), state("callback-less-or-depth", topic=topic)
    if one.is_too_slow():
        remedy = state("callback-less-or-rate", topic=topic, seconds=(one.took or 0) / 1e9)
        return lost("slow-callback", **one.pace()), remedy
    if not one.share:
        return lost("without-spin"), state("spin", node=node)
    if one.share >= _NEARLY_ALL and one.busiest:
        remedy = state("busiest-less", node=node, busiest=one.busiest)
        return lost("by-busy-node", busiest=one.busiest), remedy
    if endpoint.depth * (one.interval or 0) < endpoint.longest:
        fact = lost("long-call", seconds=endpoint.longest / 1e9)
        return fact, state("never-wait-or-depth", topic=topic)
    return lost("in-bursts"), state("depth", topic=topic)


def _subscriptions(evidence: Evidence) -> Iterator[_Subscription]:
    """The subscriptions that want every message, between the start and the end of the look."""
    for earlier, node in _pairs_of_nodes(evidence):
        share = busy_share(earlier, node)
        for before, endpoint in _pairs(earlier, node):
            if endpoint.role is Role.SUBSCRIBER and endpoint.depth > 1:
                rate = counted_rate(before, endpoint)
                yield _Subscription(
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
    """Return whether its callback has run for long enough to be judged."""
    return endpoint.calls >= _ENOUGH_CALLS or endpoint.longest >= _HANGS


def _has_other_work(node: Node) -> bool:
    """Return whether a node has subscriptions or services that would wait."""
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
    """The topic or service whose callback took most of the time, or "timers"; "" for none."""
    spent = {
        e.topic: e.busy - before.busy for before, e in _pairs(earlier, node) if e.busy > before.busy
    }
    timers = node.busy - earlier.busy - sum(spent.values())
    if but is not None:
        spent.pop(but.topic, None)
    if timers > 0:
        spent["timers"] = timers
    return max(spent, key=lambda name: spent[name], default="")
