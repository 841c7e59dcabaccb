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
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Topic
from lcmtools.messages.registry import candidates
from lcmtools.names import base_name_of, is_hidden, namespace_of

# Topics that nodes publish or subscribe to as a matter of course; roswtf excepts /clock, /rosout.
_COMMON = frozenset({"/clock", "/rosout", "/tf", "/tf_static"})

Loose = dict[Node, list[Endpoint]]
"""The endpoints of nodes that have nothing at the other end."""


@dataclass(frozen=True, slots=True)
class Way:
    """A way to connect a loose subscription."""

    remedy: Statement  # what to do, and why
    listener: str  # the id of the node that subscribes
    channel: str  # that it may have meant
    publisher: str = ""  # the id of the node that publishes that; "" where it is no node


def is_simulator(node: Node) -> bool:
    """Return whether a node publishes the time, and so has sensors for any subscriber."""
    return any(endpoint.topic == "/clock" for endpoint in node.having(Role.PUBLISHER))


def loose_ends(graph: Graph, role: Role, *, of_tools: bool = False) -> Loose:
    """The publications, or subscriptions, of live nodes that have nothing at the other end."""
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
    """The known ways to connect loose subscriptions; ``names`` are the senders'."""
    outputs = loose_ends(graph, Role.PUBLISHER, of_tools=True)
    return [
        way
        for node, endpoints in loose.items()
        for endpoint in endpoints
        for way in _Search(graph, outputs, names, node, endpoint).ways()
    ]


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


def _as_seen_by(node: Node, topic: str) -> str:
    """A topic's name for a node: short in its own namespace."""
    own = namespace_of(node.name)
    return base_name_of(topic) if own == namespace_of(topic) else topic


@dataclass(frozen=True, slots=True)
class _Search:
    """The ways to connect one subscription, from the likeliest kind of slip to the least likely."""

    graph: Graph
    outputs: Loose
    names: Mapping[str, str]  # of the senders on the channels, for people
    node: Node
    endpoint: Endpoint

    def ways(self) -> list[Way]:
        kinds = (self._elsewhere, self._near, self._unmapped, self._beside, self._of_another_type)
        return next((found for kind in kinds if (found := list(kind()))), [])

    def _way(
        self,
        remedy: Statement,
        reason: str,
        channel: str,
        by_node: Node | None = None,
        **parts: Part,
    ) -> Way:
        remedy = because(remedy, reason, channel=channel, **parts)
        return Way(remedy, self.node.id, channel, by_node.id if by_node else "")

    def _publications(self) -> Iterator[tuple[Node, Endpoint]]:
        """The publications of other live nodes."""
        for node in self.graph.nodes:
            if not node.stale and node.id != self.node.id:
                for endpoint in node.having(Role.PUBLISHER):
                    yield node, endpoint

    def _is_loose(self, publisher: Node, publication: Endpoint) -> bool:
        return publication in self.outputs.get(publisher, ())

    def _sender(self, channel: str, fallback: object = "unknown sender") -> Subject:
        return Subject("sender", self.names.get(channel, str(fallback)))

    def _elsewhere(self) -> Iterator[Way]:
        """The same name in another namespace: one of the two nodes is in the wrong one."""
        base, space = base_name_of(self.endpoint.topic), namespace_of(self.endpoint.topic)
        announced = [
            (publisher, other)
            for publisher, other in self._publications()
            if base_name_of(other.topic) == base and _fit(self.endpoint, other)
        ]
        misplaced = [pair for pair in announced if self._is_loose(*pair)]
        if announced and namespace_of(self.node.name) == space:
            publisher, other = announced[0]
            first, *more = dict.fromkeys(namespace_of(one.topic) for _, one in announced)
            parts = {"or": tuple(more)} if more else {}
            remedy = state("namespace", node=self.node, namespace=first, **parts)
            yield self._way(remedy, "published", other.topic, publisher)
        elif misplaced:
            yield self._moved(misplaced[0][0], misplaced[0][1].topic)
        elif not announced:
            yield from self._sent_elsewhere()

    def _moved(self, publisher: Node, topic: str) -> Way:
        """The publisher has the wrong name, not the subscription."""
        remedy = publish_on(publisher, topic, self.endpoint.topic)
        return self._way(remedy, "publishes", topic, publisher, publisher=subject(publisher))

    def _sent_elsewhere(self) -> Iterator[Way]:
        """The same for senders that are no nodes."""
        wanted = self.endpoint.topic
        is_own = namespace_of(self.node.name) == namespace_of(wanted)
        for seen in self.graph.foreign():
            channel, sent = seen.channel, set(seen.fingerprints) & set(self.endpoint.fingerprints)
            if base_name_of(channel) != base_name_of(wanted) or not sent:
                continue
            if is_own and is_legal(channel):
                remedy = state("namespace", node=self.node, namespace=namespace_of(channel))
            elif not self.graph.topic(channel).subscribers:
                remedy = state("republish", topic=wanted)
            else:
                continue
            yield self._way(remedy, "published", channel, by=self._sender(channel, seen.sender))
            return

    def _near(self) -> Iterator[Way]:
        """Nearly the same name, and not of a wrong type."""
        wanted = self.endpoint.topic
        for name in self.graph.topic_names():
            if name == wanted or is_hidden(name) or not are_near(name, wanted):
                continue
            topic = self.graph.topic(name)
            sent, taken = _sent(topic), set(self.endpoint.fingerprints)
            others = [(n, e) for n, e in topic.publishers if n.id != self.node.id]
            if (taken and sent and not sent & taken) or not (others or topic.traffic):
                continue
            publisher = next((n for n, e in others if self._is_loose(n, e)), None)
            if is_legal(name) and publisher and self._is_slip_of(publisher, name):
                yield self._moved(publisher, name)
                return
            known: dict[str, Part] = {} if others else {"by": self._sender(name)}
            if is_legal(name):
                remedy = start_with(self.node, wanted, name)
                if not (others or topic.subscribers):
                    known["or_publish_on"] = wanted
            else:
                remedy = state("republish", topic=wanted)
            yield self._way(remedy, "published", name, publisher, **known)
            return

    def _is_slip_of(self, publisher: Node, name: str) -> bool:
        """Return whether the publisher, not the subscriber, has the name that is to be changed."""
        if remap_argument(publisher, name) or remap_argument(self.node, self.endpoint.topic):
            return bool(remap_argument(publisher, name))
        is_foreign = namespace_of(self.node.name) != namespace_of(self.endpoint.topic)
        return publisher.tool or is_foreign

    def _unmapped(self) -> Iterator[Way]:
        """A remap that leads away from a topic that is published."""
        argument = remap_argument(self.node, self.endpoint.topic)
        before = expanded(argument.partition(":=")[0], self.node)
        topic = self.graph.topic(before)
        others = any(one.id != self.node.id and not one.stale for one, _ in topic.publishers)
        is_fed = (others or topic.foreign) and _sent(topic) & set(self.endpoint.fingerprints)
        if argument and is_fed:
            remedy = state("drop-remap", node=self.node, argument=argument)
            yield self._way(remedy, "published", before)

    def _beside(self) -> Iterator[Way]:
        """Publications of the same type and namespace without subscribers: a remap is missing.

        The names of a simulator's topics are fixed; others are remapped to them.
        """
        wanted = self.endpoint.topic
        for publisher, publication in self._publications():
            topic = publication.topic
            is_beside = namespace_of(topic) == namespace_of(wanted)
            if not is_beside or not _fit(self.endpoint, publication):
                continue
            if is_simulator(publisher):
                if not is_simulator(self.node):
                    remedy = start_with(self.node, wanted, _as_seen_by(self.node, topic))
                    yield self._way(remedy, "same-type", topic, publisher)
            elif self._is_loose(publisher, publication) and not publisher.tool:
                remedy = publish_on(publisher, topic, _as_seen_by(publisher, wanted))
                yield self._way(remedy, "no-subscriber", topic, publisher)

    def _of_another_type(self) -> Iterator[Way]:
        """The same name in another namespace, or nearly the same name, but of another type."""
        wanted = self.endpoint.topic
        sent = [(subject(n), other.topic, other.type, n.id) for n, other in self._publications()]
        for seen in self.graph.foreign():
            known = [name for number in seen.fingerprints for name in candidates(number)]
            sent += [(self._sender(seen.channel), seen.channel, name, "") for name in known[:1]]
        for publisher, topic, name, identity in sent if self.endpoint.fingerprints else ():
            if base_name_of(topic) == base_name_of(wanted) or are_near(topic, wanted):
                types = {"type": name, "topic": topic, "expected": self.endpoint.type}
                remedy = state("change-type", publisher=publisher, node=self.node, **types)
                yield Way(remedy, self.node.id, topic, identity)
                return


def _sent(topic: Topic) -> set[int]:
    """The types that are announced or sent on a topic."""
    return {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)
