"""Endpoints of the graph with nothing at the other end, and what connects two of them.

Pure: the graph in, remedies out. Each changes one argument, and names the node to start with it.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from lcmtools.doctor.findings import Part, Statement, Subject, state, subject
from lcmtools.doctor.renaming import (
    are_near,
    because,
    expanded,
    is_legal,
    publish_on,
    remap_argument,
    start_with,
)
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.messages.registry import candidates
from lcmtools.names import base_name_of, is_hidden, namespace_of

# Topics that nodes publish or subscribe to as a matter of course; roswtf excepts /clock, /rosout.
_COMMON = frozenset({"/clock", "/rosout", "/tf", "/tf_static"})

Loose = dict[Node, list[Endpoint]]
"""The endpoints of nodes that have nothing at the other end."""


@dataclass(frozen=True, slots=True)
class Way:
    """A way to connect a loose subscription.

    Attributes:
        remedy: What to do, and why.
        listener: The id of the node that subscribes.
        channel: The channel that it may have meant.
        publisher: The id of the node that publishes that; "" where it is no node.
    """

    remedy: Statement
    listener: str
    channel: str
    publisher: str = ""


def is_simulator(node: Node) -> bool:
    """Return whether a node publishes the time, and so has sensors for any subscriber."""
    return any(endpoint.topic == "/clock" for endpoint in node.having(Role.PUBLISHER))


def loose_ends(graph: Graph, role: Role, *, of_tools: bool = False) -> Loose:
    """The publications, or subscriptions, of live nodes that have nothing at the other end.

    Args:
        graph: All nodes.
        role: Which of the two.
        of_tools: Include those of commands of lcmtools.
    """
    other = Role.PUBLISHER if role is Role.SUBSCRIBER else Role.SUBSCRIBER
    connected = {e.topic for node in graph.nodes if not node.stale for e in node.having(other)}
    if role is Role.SUBSCRIBER:
        connected |= {seen.channel for seen in graph.traffic}
    loose: Loose = defaultdict(list)
    for node in graph.nodes:
        if node.stale or (node.tool and not of_tools):
            continue
        fed_groups = {e.group for e in node.endpoints if e.role is role and e.topic in connected}
        for endpoint in _first_of_each_group(node.endpoints):
            if (
                endpoint.role is role
                and endpoint.topic not in connected | _COMMON
                and not is_hidden(endpoint.topic)
                and not (endpoint.group and endpoint.group in fed_groups)
            ):
                loose[node].append(endpoint)
    return loose


def _first_of_each_group(endpoints: Iterable[Endpoint]) -> Iterator[Endpoint]:
    """Alternatives of each other count as one, under the name of the first."""
    groups = set()
    for endpoint in endpoints:
        if endpoint.group not in groups:
            yield endpoint
        if endpoint.group:
            groups.add(endpoint.group)


def ways(graph: Graph, loose: Loose, names: Mapping[str, str]) -> list[Way]:
    """The ways to connect loose subscriptions, where any is known; each way once.

    Args:
        graph: All nodes and traffic.
        loose: The subscriptions.
        names: The senders on the channels, for people.
    """
    search = _Search(graph, loose_ends(graph, Role.PUBLISHER, of_tools=True), names)
    found: dict[str, Way] = {}
    for node, endpoints in loose.items():
        for endpoint in endpoints:
            for way in search.ways(node, endpoint):
                found.setdefault(repr(way.remedy), way)
    return list(found.values())


def ways_out(graph: Graph, node: Node, endpoint: Endpoint) -> Iterator[Statement]:
    """The remedies that lead a loose publication to a subscription that has another publisher."""
    for listener in graph.nodes:
        for other in listener.having(Role.SUBSCRIBER):
            if listener.id == node.id or listener.tool or not _fit(endpoint, other):
                continue
            if are_near(endpoint.topic, other.topic):
                remedy = start_with(node, endpoint.topic, other.topic)
                yield because(remedy, "subscribes", listener=listener, channel=other.topic)


def _fit(one: Endpoint, other: Endpoint) -> bool:
    return bool(set(one.fingerprints) & set(other.fingerprints))


def _is_alike(one: str, other: str) -> bool:
    return base_name_of(one) == base_name_of(other) or are_near(one, other)


def _as_seen_by(node: Node, topic: str) -> str:
    """A topic's name for a node: short in its own namespace."""
    own = namespace_of(node.name)
    return base_name_of(topic) if own == namespace_of(topic) else topic


@dataclass(frozen=True, slots=True)
class _Search:
    """The ways to connect one subscription, from the likeliest kind of slip to the least likely."""

    graph: Graph
    outputs: Loose
    names: Mapping[str, str]

    def ways(self, node: Node, endpoint: Endpoint) -> list[Way]:
        kinds = (self._elsewhere, self._near, self._unmapped, self._beside, self._of_another_type)
        return next((found for kind in kinds if (found := list(kind(node, endpoint)))), [])

    def _publications(self, listener: Node) -> Iterator[tuple[Node, Endpoint]]:
        """The publications of other live nodes."""
        for node in self.graph.nodes:
            if not node.stale and node.id != listener.id:
                for endpoint in node.having(Role.PUBLISHER):
                    yield node, endpoint

    def _is_loose(self, publisher: Node, publication: Endpoint) -> bool:
        return publication in self.outputs.get(publisher, ())

    def _sender(self, channel: str, fallback: object = "unknown sender") -> Subject:
        return Subject("sender", self.names.get(channel, str(fallback)))

    def _elsewhere(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """The same name in another namespace: one of the two nodes is in the wrong one."""
        base = base_name_of(endpoint.topic)
        announced = [
            (publisher, other)
            for publisher, other in self._publications(node)
            if base_name_of(other.topic) == base and _fit(endpoint, other)
        ]
        if announced and namespace_of(node.name) == namespace_of(endpoint.topic):
            publisher, other = announced[0]
            first, *more = dict.fromkeys(namespace_of(o.topic) for _, o in announced)
            parts = {"or": tuple(more)} if more else {}
            remedy = state("namespace", node=node, namespace=first, **parts)
            remedy = because(remedy, "published", channel=other.topic)
            yield Way(remedy, node.id, other.topic, publisher.id)
            return
        for publisher, other in announced:
            if self._is_loose(publisher, other):  # else it is where it should be
                yield self._moved(publisher, other.topic, node, endpoint)
                return
        if not announced:
            yield from self._sent_elsewhere(node, endpoint)

    def _moved(self, publisher: Node, topic: str, node: Node, endpoint: Endpoint) -> Way:
        """The publisher has the wrong name, not the subscription."""
        remedy = publish_on(publisher, topic, endpoint.topic)
        remedy = because(remedy, "publishes", publisher=publisher, channel=topic)
        return Way(remedy, node.id, topic, publisher.id)

    def _sent_elsewhere(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """The same for senders that are no nodes."""
        base = base_name_of(endpoint.topic)
        is_own = namespace_of(node.name) == namespace_of(endpoint.topic)
        for seen in self.graph.foreign():
            channel = seen.channel
            sent = set(seen.fingerprints) & set(endpoint.fingerprints)
            if base_name_of(channel) != base or not sent:
                continue
            if is_own and is_legal(channel):
                remedy = state("namespace", node=node, namespace=namespace_of(channel))
            elif not self.graph.topic(channel).subscribers:
                remedy = state("republish", topic=endpoint.topic)
            else:
                continue
            by = self._sender(channel, seen.sender)
            yield Way(because(remedy, "published", by=by, channel=channel), node.id, channel)
            return

    def _near(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """Nearly the same name, and not of a wrong type."""
        for name in self.graph.topic_names():
            if name == endpoint.topic or is_hidden(name) or not are_near(name, endpoint.topic):
                continue
            topic = self.graph.topic(name)
            sent = {f for _, e in topic.publishers for f in e.fingerprints}
            sent |= set(topic.fingerprints)
            others = [(n, e) for n, e in topic.publishers if n.id != node.id]
            fits = not endpoint.fingerprints or not sent or sent & set(endpoint.fingerprints)
            if not fits or not (others or topic.traffic):
                continue
            publisher = next((n for n, e in others if self._is_loose(n, e)), None)
            if is_legal(name) and publisher and _has_the_slip(publisher, name, node, endpoint):
                yield self._moved(publisher, name, node, endpoint)
                return
            known: dict[str, Part] = {} if others else {"by": self._sender(name)}
            if is_legal(name):
                remedy = start_with(node, endpoint.topic, name)
                if not (others or topic.subscribers):
                    known["or_publish_on"] = endpoint.topic
            else:
                remedy = state("republish", topic=endpoint.topic)
            remedy = because(remedy, "published", channel=name, **known)
            yield Way(remedy, node.id, name, publisher.id if publisher else "")
            return

    def _unmapped(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """A remap that leads away from a topic that is published."""
        argument = remap_argument(node, endpoint.topic)
        before = expanded(argument.partition(":=")[0], node)
        topic = self.graph.topic(before)
        others = any(one.id != node.id and not one.stale for one, _ in topic.publishers)
        sent = {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)
        if argument and (others or topic.foreign) and sent & set(endpoint.fingerprints):
            remedy = state("drop-remap", node=node, argument=argument)
            yield Way(because(remedy, "published", channel=before), node.id, before)

    def _beside(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """Publications of the same type and namespace without subscribers: a remap is missing.

        The names of a simulator's topics are fixed; others are remapped to them.
        """
        for publisher, publication in self._publications(node):
            topic = publication.topic
            is_beside = namespace_of(topic) == namespace_of(endpoint.topic)
            if not is_beside or not _fit(endpoint, publication):
                continue
            if is_simulator(publisher):
                if not is_simulator(node):
                    remedy = start_with(node, endpoint.topic, _as_seen_by(node, topic))
                    remedy = because(remedy, "same-type", channel=topic)
                    yield Way(remedy, node.id, topic, publisher.id)
            elif self._is_loose(publisher, publication) and not publisher.tool:
                remedy = publish_on(publisher, topic, _as_seen_by(publisher, endpoint.topic))
                remedy = because(remedy, "no-subscriber", channel=topic)
                yield Way(remedy, node.id, topic, publisher.id)

    def _of_another_type(self, node: Node, endpoint: Endpoint) -> Iterator[Way]:
        """The same name in another namespace, or nearly the same name, but of another type."""
        if not endpoint.fingerprints:
            return
        sent = [
            (subject(publisher), other.topic, other.type, publisher.id)
            for publisher, other in self._publications(node)
        ]
        for seen in self.graph.foreign():
            known = [name for number in seen.fingerprints for name in candidates(number)]
            sent += [(self._sender(seen.channel), seen.channel, name, "") for name in known[:1]]
        for publisher, topic, name, identity in sent:
            if _is_alike(topic, endpoint.topic):
                types = {"type": name, "expected": endpoint.type}
                remedy = state("change-type", publisher=publisher, topic=topic, node=node, **types)
                yield Way(remedy, node.id, topic, identity)
                return


def _has_the_slip(publisher: Node, name: str, listener: Node, endpoint: Endpoint) -> bool:
    """Return whether the publisher, and not the listener, has the name that is to be changed."""
    if remap_argument(publisher, name) or remap_argument(listener, endpoint.topic):
        return bool(remap_argument(publisher, name))
    return publisher.tool or namespace_of(listener.name) != namespace_of(endpoint.topic)
