"""Unconnected publications and subscriptions, and remedies that connect them.

Pure: the graph in, remedies out. A remedy changes one argument of one node.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain, islice

from lcmtools.doctor.findings import Part, Statement, Subject, state, subject
from lcmtools.doctor.renaming import (
    PLAIN_CHANNEL,
    REMAPS,
    NearNames,
    expanded,
    give_reason,
    is_legal,
    is_plain,
    publish_on,
    remap_argument,
    start_with,
    unapplied_remap,
)
from lcmtools.graph.command_line import program_words
from lcmtools.graph.common_topics import OFTEN_UNCONNECTED
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Topic, Traffic
from lcmtools.names import base_name_of, is_hidden, namespace_of
from lcmtools.observe.reports.describe import seen_kinds
from lcmtools.observe.simulators import is_simulator
from lcmtools.packages.runnable_nodes import fixed_nodes

CONNECTIONS = {
    **REMAPS,
    **PLAIN_CHANNEL,
    "change-type": "{publisher} publishes {topic}, but as {type}, and {node} expects {expected}",
}
"""The sentences of remedies that connect a subscription."""

_PERIODS = 3  # average periods without a message after which a topic still counts as published
FEWEST = 4  # messages of a topic that is published repeatedly; pub -1 sends one
_FEWEST_OF_PLAIN = 1  # the same if a plain LCM program runs, which may be the publisher
_LONG_AGO = 180_000_000_000  # [ns]
_MOST_SUGGESTIONS = 20  # per subscription: among more publications, none is more likely

End = tuple[Node, Endpoint]  # an endpoint of a node


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A publication that an unconnected subscription may have meant."""

    remedy: Statement  # the change that connects them, with its reason
    listener: str  # the id of the node that subscribes
    channel: str  # the topic or channel that it may have meant
    publisher: str = ""  # the id of the node that publishes it; "" if it is not a node


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


def _recently_received(nodes: Iterable[Node], now: int, fewest: int) -> set[str]:
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


def _unconnected(node: Node, role: Role, connected: set[str]) -> Iterator[Endpoint]:
    """Yield a node's unconnected endpoints; only the first one of a group of alternatives."""
    ends = [end for end in node.endpoints if end.role is role]
    groups = {end.group for end in ends if end.group and end.topic in connected}
    for end in ends:
        is_apart = end.topic in connected or is_hidden(end.topic)
        if not is_apart and end.group not in groups:
            yield end
        if end.group:
            groups.add(end.group)


def _fit(one: Endpoint, other: Endpoint) -> bool:
    return not set(one.fingerprints).isdisjoint(other.fingerprints)


def _as_seen_by(node: Node, topic: str) -> str:
    """Return a topic's name relative to a node's namespace, if it is in that."""
    own = namespace_of(node.name)
    return base_name_of(topic) if own == namespace_of(topic) else topic


def _sent(topic: Topic) -> set[int]:
    """Return the fingerprints that are announced or sent on a topic."""
    return {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)


def _by(key: Callable[[str], str], ends: Iterable[End]) -> dict[str, list[End]]:
    """Group endpoints by a part of their topics' names."""
    found: dict[str, list[End]] = defaultdict(list)
    for node, endpoint in ends:
        found[key(endpoint.topic)].append((node, endpoint))
    return found


def _by_unapplied_remap(ends: Iterable[End]) -> dict[str, list[End]]:
    """Group endpoints by the topic to which a remap would lead them, but for a slash."""
    found: dict[str, list[End]] = defaultdict(list)
    for node, endpoint in ends:
        if target := unapplied_remap(node, endpoint.topic)[1]:
            found[target].append((node, endpoint))
    return found


def _remove_slash(node: Node, topic: str, argument: str) -> Statement:
    parts = {"topic": topic, "name": topic[1:], "argument": argument}
    return state("remove-slash-of-remap", node=node, **parts)


class ConnectionFinder:
    """Search for connections; ``names`` are the displayed names of the channels' senders."""

    def __init__(self, graph: Graph, names: Mapping[str, str]) -> None:
        self._graph, self._names = graph, names
        live = [(n, e) for n in graph.nodes if not n.stale for e in n.endpoints]
        published = [(n, e) for n, e in live if e.role is Role.PUBLISHER]
        self._by_base = _by(base_name_of, published)
        self._published = _by(str, published)
        taking = ((n, e) for n, e in live if e.role is Role.SUBSCRIBER and not n.tool)
        self._unapplied = _by_unapplied_remap(published)
        self._subscribed = _by(str, taking)  # not by commands: spy and gui subscribe to all
        self._near_names = NearNames(n for n in graph.topic_names() if not is_hidden(n))
        self._near_subscribed = NearNames(self._subscribed)
        outputs = unconnected_ends(graph, Role.PUBLISHER, of_tools=True)
        self._unconnected = {(node.id, end.topic) for node, end in outputs}
        self._simulators = {node.id for node in graph.nodes if is_simulator(node)}
        self._spare = self._by_type(published)
        self._foreign: dict[str, list[Traffic]] = defaultdict(list)  # by its channel's last part
        for seen in graph.foreign():
            self._foreign[base_name_of(seen.channel)].append(seen)
        sent = {seen.channel for seen in graph.traffic} | {e.topic for _, e in published}
        self._placed = {
            node.id
            for node, end in live
            if namespace_of(node.name) == namespace_of(end.topic) and not is_hidden(end.topic)
            if end.topic in (sent if end.role is Role.SUBSCRIBER else self._subscribed)
        }

    def _by_type(self, published: Iterable[End]) -> dict[tuple[str, int], dict[str, list[End]]]:
        """Group the publications that may lack a subscriber by namespace and type, then by node."""
        found: dict[tuple[str, int], dict[str, list[End]]] = defaultdict(lambda: defaultdict(list))
        for node, end in published:
            if node.id in self._simulators or (self._is_unconnected(node, end) and not node.tool):
                for number in dict.fromkeys(end.fingerprints):
                    found[namespace_of(end.topic), number][node.id].append((node, end))
        return found

    def suggestions(self, unconnected: Iterable[End]) -> list[Suggestion]:
        """Return suggestions for unconnected subscriptions.

        If one of them moves a node to another namespace, that also serves its topics there.
        """
        found = [
            (node, suggestion)
            for node, end in unconnected
            for suggestion in self._likeliest(node, end)
        ]
        moves = {
            suggestion.listener: suggestion.remedy
            for node, suggestion in found
            if suggestion.remedy.kind == "namespace"
            and suggestion.remedy.parts["node"] == subject(node)
        }

        def is_met(suggestion: Suggestion) -> bool:
            move = moves.get(suggestion.listener)
            return move is not None and namespace_of(suggestion.channel) == move.parts["namespace"]

        return [
            replace(suggestion, remedy=moves[suggestion.listener])
            if is_met(suggestion)
            else suggestion
            for _, suggestion in found
        ]

    def remedies_for_publication(self, node: Node, endpoint: Endpoint) -> Iterator[Statement]:
        """Yield remedies that remap an unconnected publication to a topic with subscribers."""
        for topic in self._near_subscribed.of(endpoint.topic):
            for listener, other in self._subscribed[topic]:
                if listener.id != node.id and _fit(endpoint, other):
                    remedy = publish_on(node, endpoint.topic, topic)
                    yield give_reason(remedy, "subscribes", listener=listener, channel=topic)

    def _likeliest(self, node: Node, end: Endpoint) -> list[Suggestion]:
        """Return the suggestions of the most likely kind of mistake."""
        kinds = (
            self._without_slash,
            self._in_other_namespace,
            self._of_similar_name,
            self._without_remap,
            self._of_same_type,
            self._of_other_type,
        )
        found = (list(islice(kind(node, end), _MOST_SUGGESTIONS)) for kind in kinds)
        return next(filter(None, found), [])

    def _is_unconnected(self, publisher: Node, publication: Endpoint) -> bool:
        return (publisher.id, publication.topic) in self._unconnected

    def _is_misplaced(self, node: Node, topic: str, *, command: bool = False) -> bool:
        """Return whether a node's namespace is the reason why a topic in it is unconnected.

        It is not if another topic of the node in the namespace is connected. If a command is at the
        other end, whose argument is the topic, only a node without a namespace is misplaced.
        """
        space = namespace_of(node.name)
        is_own = space == namespace_of(topic) and node.id not in self._placed
        return is_own and not (command and space != "/")

    def _use_channel(self, node: Node, topic: str, channel: str) -> Statement:
        """Return the remedy for a channel that no remap gives to a node's subscription.

        A node takes a plain channel by its own code. The sender changes if nobody edits that, as of
        a simulator.
        """
        if is_plain(channel) and node.id not in self._simulators and not _is_fixed(node):
            return state("plain-channel", node=node, channel=channel)
        return state("republish", topic=topic)

    def _sender(self, channel: str, fallback: object = "unknown sender") -> Subject:
        return Subject("sender", self._names.get(channel, str(fallback)))

    def _without_slash(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest to remove a slash that keeps a remap of either node from being applied."""
        argument, target = unapplied_remap(node, end.topic)
        for publisher, other in self._published.get(target, ()):
            if publisher.id != node.id and _fit(end, other):
                remedy = _remove_slash(node, end.topic, argument)
                yield _suggestion(node, remedy, target, publisher)
                return
        for publisher, other in self._unapplied.get(end.topic, ()):
            if publisher.id != node.id and _fit(end, other):
                argument, _ = unapplied_remap(publisher, other.topic)
                remedy = _remove_slash(publisher, other.topic, argument)
                named = {"publisher": subject(publisher)}
                yield _suggestion(node, remedy, other.topic, publisher, "publishes", **named)

    def _in_other_namespace(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest the same name in another namespace: one of the two nodes is in the wrong one."""
        announced = [
            (publisher, other)
            for publisher, other in self._by_base[base_name_of(end.topic)]
            if publisher.id != node.id and _fit(end, other)
        ]
        inside = expanded(end.topic.lstrip("/"), node)
        for publisher, other in announced:
            if other.topic == inside != end.topic:
                yield _suggestion(node, start_with(node, end.topic, inside), inside, publisher)
                return
            if is_plain(other.topic) and not publisher.tool:
                remedy = self._use_channel(node, end.topic, other.topic)
                yield _suggestion(node, remedy, other.topic, publisher)
                return
        misplaced = [pair for pair in announced if self._is_unconnected(*pair)]
        command = bool(misplaced) and misplaced[0][0].tool
        if announced and self._is_misplaced(node, end.topic, command=command):
            publisher, other = announced[0]
            first, *more = dict.fromkeys(namespace_of(one.topic) for _, one in announced)
            remedy = state("namespace", node=node, namespace=first)
            if more:
                parts = {**remedy.parts, "or": tuple(more)}
                sentence = f"{remedy.sentence} (or {{or:namespaces}})"
                remedy = replace(remedy, parts=parts, sentence=sentence)
            yield _suggestion(node, remedy, other.topic, publisher)
        elif misplaced:
            yield _rename_publisher(node, end, *misplaced[0])
        elif not announced:
            yield from self._sent_in_other_namespace(node, end)

    def _sent_in_other_namespace(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest the same name in another namespace, sent by a plain LCM program."""
        for seen in self._foreign[base_name_of(end.topic)]:
            channel = seen.channel
            if set(seen.fingerprints).isdisjoint(end.fingerprints):
                continue
            if self._is_misplaced(node, end.topic) and is_legal(channel):
                remedy = state("namespace", node=node, namespace=namespace_of(channel))
            elif not self._graph.topic(channel).subscribers:
                remedy = self._use_channel(node, end.topic, channel)
            else:
                continue
            yield _suggestion(node, remedy, channel, by=self._sender(channel, seen.sender))
            return

    def _of_similar_name(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest a similar name, unless its type differs."""
        for name in self._near_names.of(end.topic):
            topic = self._graph.topic(name)
            sent, taken = _sent(topic), set(end.fingerprints)
            others = [(n, e) for n, e in topic.publishers if n.id != node.id]
            if (taken and sent and not sent & taken) or not (others or topic.traffic):
                continue
            slip = next(((n, e) for n, e in others if self._is_unconnected(n, e)), None)
            if is_legal(name) and slip and _is_slip_of(slip[0], name, node, end):
                yield _rename_publisher(node, end, *slip)
                return
            known: dict[str, Part] = {} if others else {"by": self._sender(name)}
            if is_legal(name):
                remedy = start_with(node, end.topic, name)
                if not (others or topic.subscribers):
                    known["or_publish_on"] = end.topic
            else:
                remedy = self._use_channel(node, end.topic, name)
            yield _suggestion(node, remedy, name, slip and slip[0], "published", **known)
            return

    def _without_remap(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest to drop a remap of a topic that is published."""
        argument = remap_argument(node, end.topic)
        before = expanded(argument.partition(":=")[0], node)
        topic = self._graph.topic(before)
        others = any(one.id != node.id and not one.stale for one, _ in topic.publishers)
        if argument and (others or topic.foreign) and _sent(topic) & set(end.fingerprints):
            yield _suggestion(node, state("drop-remap", node=node, argument=argument), before)

    def _of_same_type(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest publications of the same type and namespace without subscribers.

        A simulator's topics have fixed names: other nodes are remapped to them. Otherwise the name
        that comes from a remap is the wrong one.
        """
        space = namespace_of(end.topic)
        fitting = (
            self._spare.get((space, number), {}) for number in dict.fromkeys(end.fingerprints)
        )
        others = (ends for by_node in fitting for id_, ends in by_node.items() if id_ != node.id)
        for publisher, publication in chain.from_iterable(others):
            topic = publication.topic
            if publisher.id in self._simulators:
                if node.id not in self._simulators:
                    remedy = start_with(node, end.topic, _as_seen_by(node, topic))
                    yield _suggestion(node, remedy, topic, publisher, "same-type")
                continue
            if remap_argument(node, end.topic) and not remap_argument(publisher, topic):
                remedy = start_with(node, end.topic, _as_seen_by(node, topic))
            else:
                remedy = publish_on(publisher, topic, _as_seen_by(publisher, end.topic))
            yield _suggestion(node, remedy, topic, publisher, "no-subscriber")

    def _of_other_type(self, node: Node, end: Endpoint) -> Iterator[Suggestion]:
        """Suggest another type for the same name in another namespace, or for a similar name."""
        if not end.fingerprints:
            return
        base, near = base_name_of(end.topic), list(self._near_names.of(end.topic))
        published = chain(self._by_base[base], *(self._published[name] for name in near))
        for publisher, other in published:
            if publisher.id != node.id:
                yield _change_type(
                    node, end, other.topic, subject(publisher), other.type, publisher.id
                )
                return
        meant = (seen for name in near for seen in self._graph.topic(name).foreign)
        for seen in chain(self._foreign[base], meant):
            known = seen_kinds(seen.fingerprints, seen.channel)
            if known:
                yield _change_type(node, end, seen.channel, self._sender(seen.channel), known[0][0])
                return


def _suggestion(
    node: Node,
    remedy: Statement,
    channel: str,
    by_node: Node | None = None,
    because: str = "published",
    **parts: Part,
) -> Suggestion:
    given = give_reason(remedy, because, channel=channel, **parts)
    return Suggestion(given, node.id, channel, by_node.id if by_node else "")


def _rename_publisher(
    node: Node, end: Endpoint, publisher: Node, publication: Endpoint
) -> Suggestion:
    """Suggest another topic for the publisher, because its name is the wrong one.

    A simulator's names are right: the subscriber changes its own.
    """
    topic = publication.topic
    if is_simulator(publisher) and not is_simulator(node):
        return _suggestion(node, start_with(node, end.topic, topic), topic, publisher)
    remedy = publish_on(publisher, topic, end.topic)
    return _suggestion(node, remedy, topic, publisher, "publishes", publisher=subject(publisher))


def _change_type(
    node: Node, end: Endpoint, topic: str, publisher: Subject, name: str, identity: str = ""
) -> Suggestion:
    types = {"type": name, "topic": topic, "expected": end.type}
    return Suggestion(
        state("change-type", publisher=publisher, node=node, **types), node.id, topic, identity
    )


def _is_fixed(node: Node) -> bool:
    """Return whether a node is one of lcmtools' own, whose code users do not edit."""
    words = program_words(node.command)
    return words[:2] == ["lcmtools", "run"] and not fixed_nodes().isdisjoint(words[2:])


def _is_slip_of(publisher: Node, name: str, node: Node, end: Endpoint) -> bool:
    """Return whether the publisher's topic has the wrong name, and not the subscriber's."""
    if remap_argument(publisher, name) or remap_argument(node, end.topic):
        return bool(remap_argument(publisher, name))
    return publisher.tool or namespace_of(node.name) != namespace_of(end.topic)
