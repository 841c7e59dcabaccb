"""Unconnected publications and subscriptions, and the publication that each may have meant.

Pure: the graph in, remedies out. A remedy changes one argument of one node. A new kind of mistake
is a row of ``_ROWS``.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain, islice
from typing import NamedTuple, TypeAlias

from lcmtools.doctor.findings import Part, Statement, Subject, state, subject
from lcmtools.doctor.renaming import (
    REMAPS,
    comparable,
    expanded,
    give_reason,
    inside,
    is_legal,
    is_plain,
    near_names,
    publish_on,
    remap_argument,
    remove_slash,
    start_with,
    unapplied_remap,
)
from lcmtools.graph.command_line import program_words
from lcmtools.graph.common_topics import OFTEN_UNCONNECTED
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.names import base_name_of, is_hidden, namespace_of
from lcmtools.observe.reports.describe import seen_kinds
from lcmtools.observe.simulators import is_simulator

CONNECTIONS = {
    **REMAPS,
    "plain-channel": "in {node}, subscribe to {channel} with plain_channel=True,"
    " in C++ to plain_channel({channel})",
    "subscribe": "let {node} subscribe to {channel}",
    "change-type": "{publisher} publishes {topic}, but as {type}, and {node} expects {expected}",
}
"""The sentences of remedies that connect a subscription."""

_PERIODS = 3  # average periods without a message after which a topic still counts as published
FEWEST = 4  # messages of a topic that is published repeatedly; pub -1 sends one
_FEWEST_OF_PLAIN = 1  # the same if a plain LCM program runs, which may be the publisher
_LONG_AGO = 180_000_000_000  # [ns]
_MOST_SUGGESTIONS = 20  # per subscription: among more publications, none is more likely

End = tuple[NodeInfo, Endpoint]  # an endpoint of a node


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A publication that an unconnected subscription may have meant."""

    remedy: Statement  # the change that connects them, with its reason
    listener: str  # the id of the node that subscribes
    channel: str  # the topic or channel that it may have meant
    publisher: str = ""  # the id of the node that publishes it; "" if it is not a node
    topic: str = ""  # of the subscription


def unconnected_ends(
    graph: Graph, role: Role, *, of_tools: bool = False, beside_plain: bool = False
) -> list[End]:
    """Return the publications or subscriptions of live nodes without a node at the other end.

    ``of_tools`` includes those of commands. ``beside_plain`` means that plain LCM programs run,
    which may publish what is missing.
    """
    live = [node for node in graph.nodes if not node.stale]
    other = Role.PUBLISHER if role is Role.SUBSCRIBER else Role.SUBSCRIBER
    connected = {e.topic for node in live for e in node.endpoints if e.role is other}
    connected |= OFTEN_UNCONNECTED
    if role is Role.SUBSCRIBER:
        connected |= {seen.channel for seen in graph.traffic} | _recently_received(
            live, graph.time, _FEWEST_OF_PLAIN if beside_plain else FEWEST
        )
    nodes = (node for node in live if of_tools or not node.tool)
    return [(node, end) for node in nodes for end in _unconnected(node, role, connected)]


def _recently_received(nodes: Iterable[NodeInfo], now: int, fewest: int) -> set[str]:
    """Return the topics with recent messages, by the counters of their subscribers.

    A plain LCM program may publish too rarely to be seen in one look.
    """
    received = set()
    for node in nodes:
        for end in node.endpoints:
            lived, age = end.last_time - node.start_time, node.time_there(now) - end.last_time
            is_fed = end.role is Role.SUBSCRIBER and end.messages >= fewest
            if is_fed and age < min(_PERIODS * lived / end.messages, _LONG_AGO):
                received.add(end.topic)
    return received


def _unconnected(node: NodeInfo, role: Role, connected: set[str]) -> Iterator[Endpoint]:
    """Yield a node's unconnected endpoints; only the first one of a group of alternatives."""
    ends = [end for end in node.endpoints if end.role is role]
    groups = {end.group for end in ends if end.group and end.topic in connected}
    for end in ends:
        is_apart = end.topic in connected or is_hidden(end.topic)
        if not is_apart and end.group not in groups:
            yield end
        if end.group:
            groups.add(end.group)


class _Publication(NamedTuple):
    topic: str
    node: NodeInfo  # ``_NO_NODE`` for a plain LCM program
    sender: Subject  # the node, or the program
    fingerprints: tuple[int, ...]
    types: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A publication that a subscription may have meant, and what speaks for it."""

    node: NodeInfo  # that subscribes
    wanted: str  # its topic
    expected: str  # its type
    topic: str  # that is published
    publisher: NodeInfo  # ``_NO_NODE`` for a plain LCM program
    sender: Subject  # the publisher, or the program
    types: tuple[str, ...]
    fits: bool  # both have the same type
    differs: bool  # both have a type, and not the same
    is_same_base: bool
    is_near: bool
    is_misplaced: bool  # the subscriber's namespace is the reason why they are not connected
    is_in_vain: bool  # the publication has no subscriber
    is_spare: bool  # a node's output of the type and namespace, which may lack a subscriber
    of_simulator: bool
    for_simulator: bool

    @property
    def is_meant(self) -> bool:
        """True for a similar name, and for the same one elsewhere that nobody subscribes to."""
        is_twin = self.is_same_base and self.fits and self.is_in_vain
        return is_twin or (self.is_near and not self.differs)

    @property
    def is_of_node(self) -> bool:
        return self.publisher is not _NO_NODE

    def is_slip(self) -> bool:
        """Return whether the published topic has the wrong name, and not the subscription."""
        is_free = self.is_of_node and not (self.of_simulator and not self.for_simulator)
        if not (is_free and self.is_in_vain and is_legal(self.topic)):
            return False
        is_elsewhere = namespace_of(self.node.name) != namespace_of(self.wanted)
        if self.is_same_base and self.fits:
            return True
        if remap_argument(self.publisher, self.topic) or remap_argument(self.node, self.wanted):
            return bool(remap_argument(self.publisher, self.topic))
        return self.publisher.tool or is_elsewhere

    def is_before_remap(self) -> bool:
        """Return whether the subscriber would be connected but for a remap."""
        source, sign, _ = remap_argument(self.node, self.wanted).partition(":=")
        return bool(sign) and expanded(source, self.node) == self.topic

    def is_of_own_code(self) -> bool:
        """Return whether somebody edits the subscriber's code, and may name a plain channel."""
        from lcmtools.packages.runnable_nodes import fixed_nodes  # seldom needed

        words = program_words(self.node.command)
        is_fixed = words[:2] == ["lcmtools", "run"] and not fixed_nodes().isdisjoint(words[2:])
        return not (self.for_simulator or is_fixed)

    def published(self, remedy: Statement, **parts: Part) -> Statement:
        known = parts if self.is_of_node else {"by": self.sender, **parts}
        return give_reason(remedy, "published", channel=self.topic, **known)

    def publishes(self, remedy: Statement) -> Statement:
        return give_reason(remedy, "publishes", channel=self.topic, publisher=self.sender)

    def take_it(self) -> Statement:
        return start_with(self.node, self.wanted, self.topic)

    def connect(self) -> Statement:
        """Return the remedy for two names that have only their type and namespace in common.

        The one that comes from a remap is the wrong one.
        """
        arguments = (
            remap_argument(self.node, self.wanted),
            remap_argument(self.publisher, self.topic),
        )
        if self.of_simulator or (arguments[0] and not arguments[1]):
            return start_with(self.node, self.wanted, _as_seen_by(self.node, self.topic))
        target = _as_seen_by(self.publisher, self.wanted)
        return publish_on(self.publisher, self.topic, target)

    def of_one_type(self, remedy: Statement) -> Statement:
        reason = "same-type" if self.of_simulator else "no-subscriber"
        return give_reason(remedy, reason, channel=self.topic)

    def change_type(self) -> Statement:
        types = {"type": self.types[0], "topic": self.topic, "expected": self.expected}
        return state("change-type", publisher=self.sender, node=self.node, **types)


def _as_seen_by(node: NodeInfo, topic: str) -> str:
    """Return a topic's name relative to a node's namespace, if it is in that."""
    own = namespace_of(node.name)
    return base_name_of(topic) if own == namespace_of(topic) else topic


_Test: TypeAlias = Callable[[_Candidate], object]
_Remedy: TypeAlias = Callable[[_Candidate], Statement]
_Reason: TypeAlias = Callable[[_Candidate, Statement], Statement]

_NO_NODE = NodeInfo("", "", "", 0)
_OTHER_END = NodeInfo("/_meant/node", "", "", 0)  # which is right


def _would_be_applied(c: _Candidate) -> bool:
    return c.fits and c.topic == unapplied_remap(c.node, c.wanted)[1]


def _would_be_applied_there(c: _Candidate) -> bool:
    return c.fits and c.wanted == unapplied_remap(c.publisher, c.topic)[1]


def _is_inside(c: _Candidate) -> bool:
    return c.is_same_base and c.fits and c.is_of_node and c.topic == inside(c.node, c.wanted)


def _is_elsewhere(c: _Candidate) -> bool:
    """Return whether the subscriber is in another namespace by mistake.

    A command's argument is the topic: only a node without a namespace is misplaced beside it.
    """
    is_of_command = c.publisher.tool and c.is_in_vain and namespace_of(c.node.name) != "/"
    return c.is_same_base and c.fits and c.is_misplaced and is_legal(c.topic) and not is_of_command


def _is_foreign_slip(c: _Candidate) -> bool:
    return c.is_near and c.is_in_vain and is_legal(c.topic) and not c.is_of_node


_ROWS: tuple[tuple[_Test, _Remedy, _Reason], ...] = (
    (
        # a plain channel is not remapped
        lambda c: c.is_meant and is_legal(c.topic) and not is_legal(c.wanted),
        lambda c: state("subscribe", node=c.node, channel=c.topic),
        _Candidate.published,
    ),
    (_would_be_applied, lambda c: remove_slash(c.node, c.wanted), _Candidate.published),
    (_would_be_applied_there, lambda c: remove_slash(c.publisher, c.topic), _Candidate.publishes),
    (_is_inside, _Candidate.take_it, _Candidate.published),
    (
        _is_elsewhere,
        lambda c: state("namespace", node=c.node, namespace=namespace_of(c.topic)),
        _Candidate.published,
    ),
    (
        lambda c: c.is_meant and c.is_slip(),
        lambda c: publish_on(c.publisher, c.topic, c.wanted),
        _Candidate.publishes,
    ),
    (
        lambda c: c.is_meant and _is_foreign_slip(c),
        _Candidate.take_it,
        lambda c, remedy: c.published(remedy, or_publish_on=c.wanted),
    ),
    (
        lambda c: c.is_meant and is_legal(c.topic) and (c.is_near or c.of_simulator),
        _Candidate.take_it,
        _Candidate.published,
    ),
    (
        lambda c: c.is_meant and is_plain(c.topic) and c.is_of_own_code(),
        lambda c: state("plain-channel", node=c.node, channel=c.topic),
        _Candidate.published,
    ),
    (lambda c: c.is_meant, lambda c: state("republish", topic=c.wanted), _Candidate.published),
    (
        lambda c: c.fits and c.is_before_remap(),
        lambda c: state("drop-remap", node=c.node, argument=remap_argument(c.node, c.wanted)),
        _Candidate.published,
    ),
    (
        lambda c: c.is_spare and not (c.of_simulator and c.for_simulator),
        _Candidate.connect,
        _Candidate.of_one_type,
    ),
    (
        lambda c: c.differs and c.types and (c.is_same_base or c.is_near),
        _Candidate.change_type,
        lambda _, remedy: remedy,  # says it itself
    ),
)
"""The kinds of mistakes, the likeliest first, with remedy and reason: the first match decides."""


def renaming(
    node: NodeInfo, topic: str, target: str, *, publishes: bool, is_misplaced: bool
) -> Statement:
    """Return what gives a node's topic the name that is known to be meant, without a reason.

    ``is_misplaced`` means that the node ought to be in another namespace.
    """
    publisher = node if publishes else _OTHER_END
    c = _Candidate(
        _OTHER_END if publishes else node,
        wanted=target if publishes else topic,
        expected="",
        topic=topic if publishes else target,
        publisher=publisher,
        sender=subject(publisher),
        types=(),
        fits=True,
        differs=False,
        is_same_base=base_name_of(topic) == base_name_of(target),
        is_near=True,
        is_misplaced=is_misplaced and not publishes,
        is_in_vain=True,
        is_spare=False,
        of_simulator=not publishes,
        for_simulator=publishes,
    )
    return next(remedy(c) for condition, remedy, _ in _ROWS if condition(c))


class ConnectionFinder:
    """Search for connections; ``names`` are the displayed names of the channels' senders."""

    def __init__(self, graph: Graph, names: Mapping[str, str]) -> None:
        self._graph, self._names = graph, names
        self._simulators = {node.id for node in graph.nodes if is_simulator(node)}
        live = [(n, e) for n in graph.nodes if not n.stale for e in n.endpoints]
        taking = [(n, e) for n, e in live if e.role is Role.SUBSCRIBER and not n.tool]
        self._subscribed: dict[str, list[End]] = defaultdict(list)  # not by commands: spy takes all
        for node, end in taking:
            self._subscribed[end.topic].append((node, end))
        outputs = unconnected_ends(graph, Role.PUBLISHER, of_tools=True)
        self._in_vain = {(node.id, end.topic) for node, end in outputs}
        self._by_topic: dict[str, list[_Publication]] = defaultdict(list)
        self._by_base: dict[str, list[_Publication]] = defaultdict(list)
        self._by_unapplied: dict[str, list[_Publication]] = defaultdict(list)
        self._spare: dict[tuple[str, int], list[_Publication]] = defaultdict(list)
        for one in chain(_announced(live), self._foreign()):
            self._by_topic[one.topic].append(one)
            self._by_base[base_name_of(one.topic)].append(one)
            if target := unapplied_remap(one.node, one.topic)[1]:
                self._by_unapplied[target].append(one)
            for number in dict.fromkeys(one.fingerprints) if self._is_spare(one) else ():
                self._spare[namespace_of(one.topic), number].append(one)
        self._comparable = comparable(name for name in self._by_topic if not is_hidden(name))
        self._taken = comparable(self._subscribed)
        self._placed = {
            node.id
            for node, end in live
            if namespace_of(node.name) == namespace_of(end.topic) and not is_hidden(end.topic)
            if end.topic in (self._by_topic if end.role is Role.SUBSCRIBER else self._subscribed)
        }

    def _foreign(self) -> Iterator[_Publication]:
        for seen in self._graph.foreign():
            name = self._names.get(seen.channel, str(seen.sender or "unknown sender"))
            kinds = seen_kinds(seen.fingerprints, seen.channel)
            sender = Subject("sender", name)
            known = seen.channel, _NO_NODE, sender, seen.fingerprints, kinds[0] if kinds else ()
            yield _Publication(*known)

    def _is_in_vain(self, one: _Publication) -> bool:
        if one.node is _NO_NODE:
            return not self._graph.topic(one.topic).subscribers
        return (one.node.id, one.topic) in self._in_vain

    def _is_spare(self, one: _Publication) -> bool:
        is_of_node = one.node is not _NO_NODE and not one.node.tool
        return one.node.id in self._simulators or (is_of_node and self._is_in_vain(one))

    def _likely_spare(self, node: NodeInfo, space: str, number: int) -> list[_Publication]:
        """Return outputs of a namespace and type; no simulator is connected with another one."""
        of = self._simulators if node.id in self._simulators else ()
        others = (one for one in self._spare.get((space, number), ()) if one.node.id not in of)
        return list(islice(others, _MOST_SUGGESTIONS + 1))  # one may be its own

    def suggestions(self, unconnected: Iterable[End]) -> list[Suggestion]:
        """Return suggestions for unconnected subscriptions.

        If one of them moves a node to another namespace, that also serves its topics there.
        """
        found = [one for node, end in unconnected for one in self._likeliest(node, end)]
        names = {node.id: subject(node) for node in self._graph.nodes}
        moves = {
            one.listener: one.remedy
            for one in found
            if one.remedy.kind == "namespace" and one.remedy.parts["node"] == names[one.listener]
        }

        def is_met(one: Suggestion) -> bool:
            move = moves.get(one.listener)
            return move is not None and namespace_of(one.channel) == move.parts["namespace"]

        return [replace(x, remedy=moves[x.listener]) if is_met(x) else x for x in found]

    def remedies_for_publication(self, node: NodeInfo, endpoint: Endpoint) -> Iterator[Statement]:
        """Yield remedies that remap an unconnected publication to a topic with subscribers."""
        for topic in near_names(endpoint.topic, self._taken):
            for listener, other in self._subscribed[topic]:
                fits = not set(endpoint.fingerprints).isdisjoint(other.fingerprints)
                if listener.id != node.id and fits:
                    remedy = publish_on(node, endpoint.topic, topic)
                    yield give_reason(remedy, "subscribes", listener=listener, channel=topic)

    def _likeliest(self, node: NodeInfo, end: Endpoint) -> list[Suggestion]:
        """Return the suggestions of the most likely kind of mistake."""
        candidates = list(self._candidates(node, end))
        for condition, remedy, reason in _ROWS:
            if found := list(islice(filter(condition, candidates), _MOST_SUGGESTIONS)):
                # of outputs that have only the type in common, none is more likely
                chosen = found if remedy is _Candidate.connect else found[:1]
                return [
                    Suggestion(
                        _with_alternatives(reason(c, remedy(c)), found),
                        *(node.id, c.topic, c.publisher.id, end.topic),
                    )
                    for c in chosen
                ]
        return []

    def _candidates(self, node: NodeInfo, end: Endpoint) -> Iterator[_Candidate]:
        """Yield the publications that may be meant; announced ones come first."""
        base, space = base_name_of(end.topic), namespace_of(end.topic)
        near = near_names(end.topic, self._comparable)
        target = unapplied_remap(node, end.topic)[1]
        before = expanded(remap_argument(node, end.topic).partition(":=")[0], node)
        groups = [self._by_topic.get(name, []) for name in (target, *near, before)]
        groups += [self._by_base.get(base, []), self._by_unapplied.get(end.topic, [])]
        groups += [self._likely_spare(node, space, number) for number in end.fingerprints]
        likely = {id(one): one for one in chain.from_iterable(groups)}
        taken, is_own = set(end.fingerprints), namespace_of(node.name) == space
        for one in sorted(likely.values(), key=lambda one: one.node is _NO_NODE):
            sent = set(one.fingerprints)
            fits = not sent.isdisjoint(taken)
            if one.node.id != node.id:
                yield _Candidate(
                    *(node, end.topic, end.type, one.topic, one.node, one.sender, one.types),
                    fits=fits,
                    differs=bool(sent and taken) and not fits,
                    is_same_base=base_name_of(one.topic) == base,
                    is_near=one.topic in near,
                    is_misplaced=is_own and node.id not in self._placed,
                    is_in_vain=self._is_in_vain(one),
                    is_spare=fits and namespace_of(one.topic) == space and self._is_spare(one),
                    of_simulator=one.node.id in self._simulators,
                    for_simulator=node.id in self._simulators,
                )


def _announced(live: Iterable[End]) -> Iterator[_Publication]:
    for node, end in live:
        if end.role is Role.PUBLISHER:
            yield _Publication(end.topic, node, subject(node), end.fingerprints, end.types)


def _with_alternatives(remedy: Statement, found: Iterable[_Candidate]) -> Statement:
    """Return the move of a subscriber to a namespace with the others that are as likely."""
    spaces = dict.fromkeys(namespace_of(c.topic) for c in found if _is_elsewhere(c))
    more = tuple(space for space in spaces if space != remedy.parts.get("namespace"))
    if remedy.kind != "namespace" or not more:
        return remedy
    sentence = f"{remedy.sentence} (or {{or:namespaces}})"
    return replace(remedy, parts={**remedy.parts, "or": more}, sentence=sentence)
