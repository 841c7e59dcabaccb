"""Loose ends of the graph, and what to type so that two of them meet.

Pure: the graph in, sentences out. Each names one flag, and the node to start with it.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

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


def loose_ends(graph: Graph, role: Role) -> Loose:
    """The publications, or subscriptions, of live nodes that nobody is at the other end of."""
    other = Role.PUBLISHER if role is Role.SUBSCRIBER else Role.SUBSCRIBER
    connected = _topics_having(graph, other)
    if role is Role.SUBSCRIBER:
        connected |= {seen.channel for seen in graph.traffic}
    loose: Loose = defaultdict(list)
    for node in graph.nodes:
        if node.tool or node.stale:
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
    outputs = loose_ends(graph, Role.PUBLISHER)
    told = set()
    for node, endpoints in loose.items():
        for endpoint in endpoints:
            for way in (
                list(_elsewhere(graph, node, endpoint, outputs, names))
                or list(_near(graph, node, endpoint, outputs, names))
                or list(_beside(node, endpoint, outputs))
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
                start = _start_with(node, endpoint.topic, other.topic)
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
            text = _move(publisher, other, endpoint.topic)
            yield Way(text, node.id, other.topic, publisher.id)
            return
    if announced or not is_own:
        return
    for seen in graph.foreign():
        sent = set(seen.fingerprints) & set(endpoint.fingerprints)
        if base_name_of(seen.channel) == base and sent and _is_legal(seen.channel):
            who = names.get(seen.channel, str(seen.sender))
            flag = f"__ns:={namespace_of(seen.channel)}"
            text = f"{seen.channel} is published, by {who}: start {node.name} with {flag}"
            yield Way(text, node.id, seen.channel)
            return


def _move(publisher: Node, other: Endpoint, topic: str) -> str:
    """What lets a node publish on a topic whose name differs in the namespace."""
    start = f"{publisher.name} publishes {other.topic}: start"
    if namespace_of(publisher.name) == namespace_of(other.topic):
        return f"{start} {publisher.name} with __ns:={namespace_of(topic)}"
    return f"{start} {_start_with(publisher, other.topic, topic)}"


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
        if not _is_legal(name):
            text = f"'{name}' is published{by}: let it publish on '{endpoint.topic}'"
        elif publisher and _has_the_slip(publisher, name, node, endpoint):
            start = _start_with(publisher, name, endpoint.topic)
            text = f"{publisher.name} publishes {name}: start {start}"
        else:
            text = f"{name} is published{by}: start {_start_with(node, endpoint.topic, name)}"
        yield Way(text, node.id, name, publisher.id if publisher else "")
        return


def _has_the_slip(publisher: Node, name: str, listener: Node, endpoint: Endpoint) -> bool:
    """Whether the publisher, and not the listener, has the name that is to be changed."""
    if _remapped(publisher, name) or _remapped(listener, endpoint.topic):
        return bool(_remapped(publisher, name))
    return namespace_of(listener.name) != namespace_of(endpoint.topic)


def _is_legal(channel: str) -> bool:
    """Whether a node can have this channel: names begin with a slash."""
    return re.fullmatch(r"/[A-Za-z0-9_/]*", channel) is not None


def _start_with(node: Node, topic: str, target: str) -> str:
    """How to start a node so that it uses another topic in place of one that it uses now."""
    name = base_name_of(topic) if namespace_of(node.name) == namespace_of(topic) else topic
    word = _remapped(node, topic)
    if not word:
        return f"{node.name} with {name}:={target}"
    source = word.partition(":=")[0]
    wanted = _expanded(target, node)
    if _expanded(source, node) != wanted:
        return f"{node.name} with {source}:={target} in place of {word}"
    if are_near(topic, wanted):
        return f"{node.name} without {word}"
    # the other way round was meant
    return f"{node.name} with {name}:={target} in place of {word}"


def _remapped(node: Node, topic: str) -> str:
    """The argument of a node's command line that gave it this topic; "" without."""
    for word in node.command.split():
        source, sign, said = word.partition(":=")
        if sign and said and not source.startswith("_") and _expanded(said, node) == topic:
            return word
    return ""


def _expanded(name: str, node: Node) -> str:
    return name if name.startswith("/") else f"{namespace_of(node.name).rstrip('/')}/{name}"


# --- another name, or another type ---------------------------------------------------------------


def _beside(node: Node, endpoint: Endpoint, outputs: Loose) -> Iterator[Way]:
    """Publications of the right type beside it that nobody hears: a remap may be missing."""
    for publisher, publications in outputs.items():
        for publication in publications:
            if (
                namespace_of(publication.topic) == namespace_of(endpoint.topic)
                and _fit(endpoint, publication)
                and publisher.id != node.id
            ):
                own = namespace_of(publisher.name) == namespace_of(endpoint.topic)
                target = base_name_of(endpoint.topic) if own else endpoint.topic
                start = _start_with(publisher, publication.topic, target)
                text = f"nobody hears {publication.topic} of the same type: start {start}"
                yield Way(text, node.id, publication.topic, publisher.id)


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
