"""Loose ends of the graph, and what to type so that two of them meet.

Pure: the graph in, sentences out. Each names one flag, and the node to start with it.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from lcmtools.doctor.flags import advice, expanded, is_legal, remapped, start_with
from lcmtools.doctor.near_names import are_near
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.messages.registry import candidates
from lcmtools.names import base_name_of, is_hidden, namespace_of

# Topics that nodes offer or take as a matter of course; as roswtf excepts /clock and /rosout.
_EVERYBODYS = frozenset({"/clock", "/rosout", "/tf", "/tf_static"})

Loose = dict[Node, list[Endpoint]]
"""The endpoints of nodes that nobody is at the other end of."""


@dataclass(frozen=True, slots=True)
class Way:
    """A way to connect a loose end.

    Attributes:
        text: What is there, and what to do.
        listener: The id of the node whose loose end it is.
        channel: What is published that it may have meant.
        publisher: The id of the node that publishes that; "" where it is no node.
    """

    text: str
    listener: str
    channel: str
    publisher: str = ""


def is_simulator(node: Node) -> bool:
    """Whether a node makes the time, and so has sensors for whoever wants them."""
    return any(endpoint.topic == "/clock" for endpoint in node.having(Role.PUBLISHER))


def loose_ends(graph: Graph, role: Role, *, of_tools: bool = False) -> Loose:
    """The publications, or subscriptions, of live nodes that nobody is at the other end of.

    Args:
        graph: What there is.
        role: Which of the two.
        of_tools: Those of commands of lcmtools as well.
    """
    other = Role.PUBLISHER if role is Role.SUBSCRIBER else Role.SUBSCRIBER
    connected = _topics_having(graph, other)
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
                and endpoint.topic not in connected | _EVERYBODYS
                and not is_hidden(endpoint.topic)
                and not (endpoint.group and endpoint.group in fed_groups)
            ):
                loose[node].append(endpoint)
    return loose


def ways(graph: Graph, loose: Loose, names: Mapping[str, str]) -> Iterator[Way]:
    """How loose subscriptions may be connected, where that can be told; each way once.

    Args:
        graph: What there is.
        loose: The subscriptions.
        names: Who sends on a channel, for people.
    """
    outputs = loose_ends(graph, Role.PUBLISHER, of_tools=True)
    told = set()
    for node, endpoints in loose.items():
        for endpoint in endpoints:
            for way in (
                list(_elsewhere(graph, node, endpoint, outputs, names))
                or list(_near(graph, node, endpoint, outputs, names))
                or list(_unmapped(graph, node, endpoint))
                or list(_beside(graph, node, endpoint, outputs))
                or list(_of_another_type(graph, node, endpoint, names))
            ):
                if way.text not in told:
                    told.add(way.text)
                    yield way


def ways_out(graph: Graph, node: Node, endpoint: Endpoint) -> Iterator[str]:
    """How a loose publication may be heard by a subscription that others feed already."""
    for listener in graph.nodes:
        for other in listener.having(Role.SUBSCRIBER):
            if listener.id == node.id or listener.tool or not _fit(endpoint, other):
                continue
            if are_near(endpoint.topic, other.topic):
                start = start_with(node, endpoint.topic, other.topic)
                yield f"{listener.name} hears {other.topic}: start {start}"


def _topics_having(graph: Graph, role: Role) -> set[str]:
    return {
        endpoint.topic
        for node in graph.nodes
        if not node.stale
        for endpoint in node.endpoints
        if endpoint.role is role
    }


def _first_of_each_group(endpoints: Iterable[Endpoint]) -> Iterator[Endpoint]:
    """Alternatives of each other count as one, under the name of the first."""
    groups = set()
    for endpoint in endpoints:
        if endpoint.group not in groups:
            yield endpoint
        if endpoint.group:
            groups.add(endpoint.group)


def _fit(one: Endpoint, other: Endpoint) -> bool:
    return bool(set(one.fingerprints) & set(other.fingerprints))


def _publications(graph: Graph, listener: Node) -> Iterator[tuple[Node, Endpoint]]:
    """What other live nodes publish."""
    for node in graph.nodes:
        if not node.stale and node.id != listener.id:
            for endpoint in node.having(Role.PUBLISHER):
                yield node, endpoint


# --- the same name in another namespace ------------------------------------------------------


def _elsewhere(
    graph: Graph, node: Node, endpoint: Endpoint, outputs: Loose, names: Mapping[str, str]
) -> Iterator[Way]:
    """The topic is published in another namespace: one of the two nodes is in the wrong one."""
    base = base_name_of(endpoint.topic)
    announced = [
        (publisher, other)
        for publisher, other in _publications(graph, node)
        if base_name_of(other.topic) == base and _fit(endpoint, other)
    ]
    is_own = namespace_of(node.name) == namespace_of(endpoint.topic)
    if announced and is_own:
        publisher, other = announced[0]
        flags = list(dict.fromkeys(f"__ns:={namespace_of(o.topic)}" for _, o in announced))
        more = f" (or {', '.join(flags[1:])})" if flags[1:] else ""
        text = f"{other.topic} is published: start {node.name} with {flags[0]}{more}"
        yield Way(text, node.id, other.topic, publisher.id)
        return
    for publisher, other in announced:
        if other in outputs.get(publisher, ()):  # who is heard already is where it should be
            text = f"{publisher.name} publishes {other.topic}: "
            text += advice(publisher, other.topic, endpoint.topic)
            yield Way(text, node.id, other.topic, publisher.id)
            return
    if not announced:
        yield from _sent_elsewhere(graph, node, endpoint, names)


def _sent_elsewhere(
    graph: Graph, node: Node, endpoint: Endpoint, names: Mapping[str, str]
) -> Iterator[Way]:
    """The same for what programs send that are no nodes."""
    base = base_name_of(endpoint.topic)
    is_own = namespace_of(node.name) == namespace_of(endpoint.topic)
    for seen in graph.foreign():
        sent = set(seen.fingerprints) & set(endpoint.fingerprints)
        if base_name_of(seen.channel) != base or not sent:
            continue
        by = f"is published, by {names.get(seen.channel, str(seen.sender))}"
        if is_own and is_legal(seen.channel):
            text = f"{seen.channel} {by}: start {node.name} with __ns:={namespace_of(seen.channel)}"
        elif not graph.topic(seen.channel).subscribers:
            text = f"'{seen.channel}' {by}: let it publish on '{endpoint.topic}'"
        else:
            continue
        yield Way(text, node.id, seen.channel)
        return


# --- nearly the same name ----------------------------------------------------------------------


def _near(
    graph: Graph, node: Node, endpoint: Endpoint, outputs: Loose, names: Mapping[str, str]
) -> Iterator[Way]:
    """A topic that is published under nearly the same name, and not of a wrong type."""
    for name in graph.topic_names():
        if name == endpoint.topic or is_hidden(name) or not are_near(name, endpoint.topic):
            continue
        topic = graph.topic(name)
        sent = {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)
        others = [(n, e) for n, e in topic.publishers if n.id != node.id]
        fits = not endpoint.fingerprints or not sent or sent & set(endpoint.fingerprints)
        if not fits or not (others or topic.traffic):
            continue
        publisher = next((n for n, e in others if e in outputs.get(n, ())), None)
        by = "" if others else f", by {names.get(name, 'somebody')}"
        if not is_legal(name):
            text = f"'{name}' is published{by}: let it publish on '{endpoint.topic}'"
        elif publisher and _has_the_slip(publisher, name, node, endpoint):
            text = f"{publisher.name} publishes {name}: {advice(publisher, name, endpoint.topic)}"
        else:
            start = f"start {start_with(node, endpoint.topic, name)}"
            if not (others or topic.subscribers):
                start = f"let it publish on '{endpoint.topic}', or {start}"
            text = f"{name} is published{by}: {start}"
        yield Way(text, node.id, name, publisher.id if publisher else "")
        return


def _has_the_slip(publisher: Node, name: str, listener: Node, endpoint: Endpoint) -> bool:
    """Whether the publisher, and not the listener, has the name that is to be changed."""
    if remapped(publisher, name) or remapped(listener, endpoint.topic):
        return bool(remapped(publisher, name))
    if publisher.tool:
        return True
    return namespace_of(listener.name) != namespace_of(endpoint.topic)


# --- another name, or another type ---------------------------------------------------------------


def _unmapped(graph: Graph, node: Node, endpoint: Endpoint) -> Iterator[Way]:
    """A remap leads away from a topic that is published."""
    word = remapped(node, endpoint.topic)
    before = expanded(word.partition(":=")[0], node)
    topic = graph.topic(before)
    others = any(one.id != node.id and not one.stale for one, _ in topic.publishers)
    sent = {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)
    if word and (others or topic.foreign) and sent & set(endpoint.fingerprints):
        yield Way(f"{before} is published: start {node.name} without {word}", node.id, before)


def _beside(graph: Graph, node: Node, endpoint: Endpoint, outputs: Loose) -> Iterator[Way]:
    """Publications of the right type beside it that nobody hears: a remap may be missing.

    What simulators publish has its names, and others go by them.
    """
    for publisher, publication in _publications(graph, node):
        topic = publication.topic
        if namespace_of(topic) != namespace_of(endpoint.topic) or not _fit(endpoint, publication):
            continue
        if is_simulator(publisher):
            if not is_simulator(node):
                text = f"{topic} is of the same type: start "
                text += start_with(node, endpoint.topic, _as_seen_by(node, topic))
                yield Way(text, node.id, topic, publisher.id)
        elif publication in outputs.get(publisher, ()) and not publisher.tool:
            text = f"nobody hears {topic} of the same type: "
            text += advice(publisher, topic, _as_seen_by(publisher, endpoint.topic))
            yield Way(text, node.id, topic, publisher.id)


def _as_seen_by(node: Node, topic: str) -> str:
    """A topic's name for a node: short in its own namespace."""
    own = namespace_of(node.name)
    return base_name_of(topic) if own == namespace_of(topic) else topic


def _of_another_type(
    graph: Graph, node: Node, endpoint: Endpoint, names: Mapping[str, str]
) -> Iterator[Way]:
    """The same base name, or nearly the same name, but the type differs too."""
    if not endpoint.fingerprints:
        return
    wants = f"and {node.name} wants {endpoint.type}"
    for publisher, other in _publications(graph, node):
        if _is_alike(other.topic, endpoint.topic):
            text = f"{publisher.name} publishes {other.topic}, but as {other.type}, {wants}"
            yield Way(text, node.id, other.topic, publisher.id)
            return
    for seen in graph.foreign():
        known = [name for number in seen.fingerprints for name in candidates(number)]
        if known and _is_alike(seen.channel, endpoint.topic):
            who = names.get(seen.channel, "somebody")
            text = f"{who} publishes {seen.channel}, but as {known[0]}, {wants}"
            yield Way(text, node.id, seen.channel)
            return


def _is_alike(one: str, other: str) -> bool:
    return base_name_of(one) == base_name_of(other) or are_near(one, other)
