"""Rules about callbacks: nodes that are too slow for their messages, and the causes."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from lcmtools.doctor.evidence import Evidence, derived
from lcmtools.doctor.findings import Finding, Part, Severity, Statement, finding, rule, state
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import busy_share, callback_time

_NEARLY_ALL = 0.9  # share of the time between two messages: a slower callback cannot keep up
_ALWAYS = 0.95  # share of time in callbacks: all other work is late
_START = 3.0  # [s] until a node must spin
_UNBROKEN = 0.999  # without a pause, which a busy computer does not cause
_ENOUGH_CALLS = 5  # the first calls may load what later ones need
_MANY = 0.05  # share of all messages: more than the first seconds lose
_QUICK = 0.5  # share of the time between two messages, or of all time
_FLOOD = 250_000  # [ns] between two messages that no node in Python takes for long
_MISSED = 0.25  # share of messages: more than the irregularity of a busy computer loses
_LONG_CALL, _HANGS = 20_000_000, 3_000_000_000  # [ns] in one call

_IRREGULAR = frozenset({"dropped-in-bursts", "dropped-held-up", "dropped-long-call"})
_LOST = "{node} lost {lost:messages} of {topic} (depth {depth})"
_PACE = "its callback takes {callback_time:time}, messages come every {interval:time}"
_NEVER_ENDS = "a call of its callback has not ended for {seconds:time}"
_BUSIEST_LESS = {"busiest-less": "let {busiest:work} of {node} do less, and never wait"}
_SPIN = {"spin": "let {node} call spin(node), or spin_once often"}


@dataclass(frozen=True, slots=True)
class _Work:  # a node's work between the start and the end of the look
    earlier: NodeInfo
    node: NodeInfo  # as it is now
    pairs: tuple[tuple[Endpoint, Endpoint], ...]  # each endpoint as it was and as it is

    def blocking_work(self, endpoint: Endpoint, least: float) -> tuple[str, float]:
        """Return the work that blocked a callback for over ``least`` [ns], and its time, or ""."""
        name = self.busiest(but=endpoint)
        longest = (min(e.longest, e.busy - was.busy) for was, e in self.pairs if e.topic == name)
        took = float(max(longest, default=self.in_timers()))
        return (name, took) if took > least else ("", 0.0)

    def in_timers(self) -> int:
        """Return the time in timers [ns]."""
        spent = sum(e.busy - was.busy for was, e in self.pairs if e.busy > was.busy)
        return self.node.busy - self.earlier.busy - spent

    def busiest(self, but: Endpoint | None = None) -> str:
        """Return the topic or service whose callback took most time, or "timers"; "" for none."""
        spent = {e.topic: e.busy - was.busy for was, e in self.pairs if e.busy > was.busy}
        if but is not None:
            spent.pop(but.topic, None)
        if (timers := self.in_timers()) > 0:
            spent["timers"] = timers
        return max(spent, key=lambda name: spent[name], default="")


@dataclass(frozen=True, slots=True)
class _Subscription:  # a subscription with a queue, between the start and the end of the look
    work: _Work
    endpoint: Endpoint  # as it is now
    came: int  # messages that came meanwhile
    lost: int  # those of them that its full queue dropped
    took: float  # [ns] a call of its callback; 0 if none ran
    interval: float  # [ns] between two messages; 0 if none came
    hangs: int  # [ns] that a call of its callback runs and does not end; 0 for none

    @property
    def node(self) -> NodeInfo:
        return self.work.node

    @property
    def topic(self) -> str:
        return self.endpoint.topic

    def is_too_slow(self, wait_share: float = 0.0) -> bool:
        """Return whether its callback takes longer than the time between two messages.

        ``wait_share`` is the share of its time that it may have waited for a processor.
        """
        return 0 < _NEARLY_ALL * self.interval <= self.took * (1 - wait_share)

    def has_run_enough(self) -> bool:
        """Return whether its callback has run often or long enough to be judged."""
        return self.endpoint.calls >= _ENOUGH_CALLS or self.endpoint.longest >= _HANGS

    def pace(self) -> dict[str, Part]:
        """Return the time of a call, and the time between two messages [s]."""
        return {"callback_time": self.took / 1e9, "interval": self.interval / 1e9}


@rule(
    "queue-drops",
    remedy="make the callback faster, or increase the queue depth",
    title="The following nodes are too slow for the messages they receive:",
    facts={
        "dropped-by-busy-node": f"{_LOST}: its node is in {{busiest:work}} most of the time",
        "dropped-by-queue": _LOST,
        "dropped-flood": f"{_LOST}: they come every {{interval:time}}, faster than it can take"
        " them",
        "dropped-hanging": f"{_LOST}: {_NEVER_ENDS}",
        "dropped-held-up": f"{_LOST}: its node was in {{busiest:work}} for {{seconds:time}}"
        " meanwhile",
        "dropped-in-bursts": f"{_LOST}: they come in bursts",
        "dropped-long-call": f"{_LOST}: a call of its callback took {{seconds:time}}",
        "dropped-slow-callback": f"{_LOST}: {_PACE}",
        "dropped-without-spin": f"{_LOST}: no callback has run",
    },
    remedies={
        **_BUSIEST_LESS,
        **_SPIN,
        "callback-less-or-depth": "let the callback of {topic} do less, or increase the queue"
        " depth",
        "callback-less-or-rate": "let the callback of {topic} do less, or publish it only every"
        " {seconds:time}",
        "depth": "increase the queue depth of the subscription of {topic}",
        "loop-waits": "let the loop that publishes {topic} wait between two messages: rate.sleep()",
        "never-wait-or-depth": "let the callback of {topic} never wait, or increase the queue"
        " depth",
    },
    evidence="the counters in two announcements of each node",
)
def queues_have_room(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks keep up with their messages.

    A subscription keeps the newest messages, as many as its depth; those that a slow callback
    leaves in the queue too long are lost. Depth 1 requests that; a note if a quick callback gets
    only the last one of messages that come at once. The callback itself may be slow, another one of
    the node may hold it up, or the messages come in bursts. What a busy computer may have caused is
    not reported.
    """
    lossy = _slow_work(evidence)[0]
    every = [x for work in _work_of_nodes(evidence) for x in _subscriptions(work)]
    hasty = [x for x in every if _is_hasty(x) and not _had_to_wait(x, evidence)]
    for found, severity in ((lossy, Severity.WARNING), (hasty, Severity.NOTE)):
        causes = list(map(_cause, found))
        facts, remedies = (fact for fact, _ in causes), (remedy for _, remedy in causes)
        yield from finding("queue-drops", facts, *remedies, severity=severity)


def _is_hasty(one: _Subscription) -> bool:
    """Return whether a subscription of depth 1 loses many messages although its callback is quick.

    The messages come in bursts.
    """
    share = busy_share(one.work.earlier, one.node)
    is_quick = one.took < _QUICK * one.interval and (share or 0.0) < _QUICK
    return one.endpoint.depth == 1 and one.lost > _MISSED * one.came and is_quick


def _had_to_wait(one: _Subscription, evidence: Evidence) -> bool:
    """Return whether a busy computer may have caused a subscription's losses.

    Its process waited for a processor for longer than the lost messages and its calls took.
    """
    wait = 0 if one.node.id in evidence.remote else 1e9 * evidence.waits.get(one.node.pid, 0.0)
    cause, _ = _cause(one)
    took = max(one.lost * one.interval, 1e9 * float(str(cause.parts.get("seconds", 0.0))))
    return cause.kind in _IRREGULAR and evidence.wait_share() > 0 and took <= wait


@rule(
    "slow-callbacks",
    remedy="make the callback faster, or call it less often: lcmtools info TOPIC shows how long it"
    " takes",
    title={
        "never-called": "The following nodes do not run their callbacks:",
        "slow-callbacks": "The following callbacks take too long:",
    },
    facts={
        "busy-node": "{node} is in its callbacks {percent:.0f} % of the time, mostly in"
        " {busiest:work}",
        "hanging-callback": f"{{node}}, {{topic}}: {_NEVER_ENDS}",
        "received": "{node} has received {messages} messages of {topic}",
        "slow-callback": f"{{node}}, {{topic}}: {_PACE}",
    },
    remedies={**_BUSIEST_LESS, **_SPIN, "callback-less": "let the callback of {topic} do less"},
    evidence="the counters in two announcements; the time that programs waited for a processor",
    root_only="the waiting of other users' programs",
)
def callbacks_are_quick(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks end before the next message comes, and leave time for the others.

    All callbacks of a node run one after another, and only while it spins. A callback that takes as
    long as the time between two messages makes them wait longer and longer; one that never ends
    makes timers, services and all other topics wait, whatever the depth of its queue. It is not a
    fault if a subscription of depth 1 skips messages: it requests only the newest. Delays that a
    busy computer may have caused are not reported either.
    """
    lossy, slow, busy = _slow_work(evidence)
    facts = [
        state("hanging-callback", node=x.node, topic=x.topic, seconds=x.hangs / 1e9)
        if x.hangs
        else state("slow-callback", node=x.node, topic=x.topic, **x.pace())
        for x in slow
    ]
    remedies = [
        _less(x.node, x.topic) if x.hangs else state("callback-less", topic=x.topic) for x in slow
    ]
    for node, share, busiest in busy:
        facts.append(state("busy-node", node=node, percent=100 * share, busiest=busiest))
        remedies.append(_less(node, busiest))
    yield from finding("slow-callbacks", facts, *remedies)
    reported = {one.node.id for one in lossy}
    waiting = [(node, end) for node, end in _never_called(evidence) if node.id not in reported]
    facts = [state("received", node=x, topic=e.topic, messages=e.messages) for x, e in waiting]
    yield from finding("never-called", facts, *(state("spin", node=node) for node, _ in waiting))


def _never_called(evidence: Evidence) -> Iterator[tuple[NodeInfo, Endpoint]]:
    """Yield subscriptions whose callbacks never ran, although the node had time for them."""
    for node in evidence.graph.nodes:
        age = (node.time_there(evidence.graph.time) - node.start_time) / 1e9
        for end in node.having(Role.SUBSCRIBER):
            is_fed = end.messages >= _ENOUGH_CALLS and not (end.calls or end.busy or node.busy)
            if is_fed and age > _START and not (node.tool or node.stale or is_hidden(end.topic)):
                yield node, end


def busy_nodes(evidence: Evidence) -> set[str]:
    """Return the names of slow nodes, which may send late for that reason."""
    lossy, slow, busy = _slow_work(evidence)
    return {one.node.name for one in lossy + slow} | {node.name for node, _, _ in busy}


@derived
def _slow_work(
    evidence: Evidence,
) -> tuple[list[_Subscription], list[_Subscription], list[tuple[NodeInfo, float, str]]]:
    """Return subscriptions that lose messages, slow ones of other nodes, and other busy nodes."""
    every, wait_share = list(_work_of_nodes(evidence)), evidence.wait_share()
    subscriptions = [one for work in every for one in _subscriptions(work)]
    subscriptions = [
        one for one in subscriptions if one.endpoint.depth > 1
    ]  # 1 asks for the newest
    lossy = [one for one in subscriptions if one.lost > 0 and not _had_to_wait(one, evidence)]
    reported = {one.node.id for one in lossy}
    others = [one for one in subscriptions if one.node.id not in reported]
    slow = [one for one in others if one.is_too_slow(wait_share) and one.has_run_enough()]
    reported |= {one.node.id for one in slow}
    busy = [
        (work.node, share, busiest)
        for work in every
        if work.node.id not in reported and _has_other_work(work.node)
        if (share := busy_share(work.earlier, work.node)) is not None
        if share - wait_share >= _ALWAYS or share >= _UNBROKEN
        if (busiest := work.busiest())
    ]
    return lossy, slow, busy


def _cause(one: _Subscription) -> tuple[Statement, Statement]:
    node, topic, endpoint = one.node, one.topic, one.endpoint

    def lost(cause: str, **parts: Part) -> Statement:
        known = {"lost": one.lost, "topic": topic, "depth": endpoint.depth, **parts}
        return state(f"dropped-{cause}", node=node, **known)

    share, busiest = busy_share(one.work.earlier, node), one.work.busiest(but=endpoint)
    if share is None:
        return lost("by-queue"), state("callback-less-or-depth", topic=topic)

    if one.is_too_slow():
        remedy = state("callback-less-or-rate", topic=topic, seconds=one.took / 1e9)
        slow = lost("slow-callback", **one.pace()), remedy
        return (lost("hanging", seconds=one.hangs / 1e9), _less(node, topic)) if one.hangs else slow
    if not share:
        return lost("without-spin"), state("spin", node=node)
    if 0 < one.interval < _FLOOD and one.lost > _MISSED * one.came:
        return lost("flood", interval=one.interval / 1e9), state("loop-waits", topic=topic)
    if share >= _NEARLY_ALL and busiest:
        return lost("by-busy-node", busiest=busiest), _less(node, busiest)
    return _irregular_cause(one, lost)


def _irregular_cause(
    one: _Subscription, lost: Callable[..., Statement]
) -> tuple[Statement, Statement]:
    """Return the cause of losses at times; ``lost`` returns a statement on the lost messages."""
    node, topic, endpoint = one.node, one.topic, one.endpoint
    least = max(endpoint.depth * one.interval, _LONG_CALL)  # [ns] that fill the queue
    held_up_by, took = one.work.blocking_work(endpoint, least)
    if endpoint.longest > least:
        cause = lost("long-call", seconds=endpoint.longest / 1e9)
        remedy = state("never-wait-or-depth", topic=topic)
    elif held_up_by:
        cause = lost("held-up", busiest=held_up_by, seconds=took / 1e9)
        remedy = _less(node, held_up_by)
    else:
        cause, remedy = lost("in-bursts"), state("depth", topic=topic)
    return cause, remedy


def _less(node: NodeInfo, busiest: str) -> Statement:
    return state("busiest-less", node=node, busiest=busiest)


def is_in_doubt(evidence: Evidence) -> bool:
    """Return whether occasional losses are suspected.

    A node that lost a large share of its messages may be blocked only every few seconds.
    """
    subscriptions = [one for work in _work_of_nodes(evidence) for one in _subscriptions(work)]
    lossy = (one.endpoint.drops > _MANY * one.endpoint.messages for one in subscriptions)
    return any(lossy) and not any(one.lost for one in subscriptions)


def _work_of_nodes(evidence: Evidence) -> Iterator[_Work]:
    """Yield the work of each node, except commands and nodes that do not answer."""
    before = {node.id: node for node in evidence.before.nodes}
    for node in evidence.graph.nodes:
        if node.id in before and not (node.tool or node.stale):
            yield _Work(before[node.id], node, tuple(_pairs(before[node.id], node)))


def _pairs(earlier: NodeInfo, later: NodeInfo) -> Iterator[tuple[Endpoint, Endpoint]]:
    """Yield each endpoint at the start and at the end; several may have the same key."""
    known: dict[object, list[Endpoint]] = defaultdict(list)
    for endpoint in earlier.endpoints:
        known[_key(endpoint)].append(endpoint)
    for endpoint in later.endpoints:
        if same := known[_key(endpoint)]:
            yield same.pop(0), endpoint


def _key(endpoint: Endpoint) -> tuple[object, ...]:
    return endpoint.topic, endpoint.role, endpoint.types, endpoint.depth


def _subscriptions(work: _Work) -> Iterator[_Subscription]:
    for was, now in work.pairs:
        if now.role is Role.SUBSCRIBER and now.depth:
            rate = now.rate_since(was)
            interval, took = 1e9 / rate if rate else 0.0, callback_time(was, now) or 0.0
            is_hanging = now.calls == was.calls and now.longest > max(was.longest, _HANGS)
            hangs = now.longest if is_hanging else 0
            came, lost = now.messages - was.messages, now.drops - was.drops
            yield _Subscription(work, now, came, lost, took, interval, hangs)


def _has_other_work(node: NodeInfo) -> bool:
    waiting = Role.SUBSCRIBER, Role.SERVICE
    return any(e.role in waiting and not is_hidden(e.topic) for e in node.endpoints)
