"""Rules about who is connected to whom."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.names import base_name_of, is_hidden, namespace_of

# Topics that nodes offer or take as a matter of course; as roswtf excepts /clock and /rosout.
_EVERYBODYS = frozenset({"/clock", "/rosout", "/tf", "/tf_static"})

_SHORT = 4  # characters: names this short are near each other by chance

_Loose = dict[Node, list[Endpoint]]


@rule(
    "unconnected-subscriptions",
    Severity.WARNING,
    "start the node with __ns:=/NAMESPACE or with OLD:=NEW",
)
def subscriptions_are_fed(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started.
    """
    graph = evidence.graph
    loose = _loose(graph, Role.SUBSCRIBER)
    if loose:
        yield Finding(
            "unconnected-subscriptions",
            Severity.WARNING,
            "The following node subscriptions are unconnected:",
            tuple(_tree(loose)),
            tuple(_remedies(graph, loose)),
        )


@rule(
    "unconnected-publications",
    Severity.NOTE,
    "start the node with OLD:=NEW, where somebody should hear it",
)
def publications_are_heard(evidence: Evidence) -> Iterator[Finding]:
    """Every publication has a subscriber.

    One that has none is seldom a fault; programs that are no nodes do not announce what they hear.
    """
    loose = _loose(evidence.graph, Role.PUBLISHER)
    if loose:
        yield Finding(
            "unconnected-publications",
            Severity.NOTE,
            "The following node publications have no announced subscriber:",
            tuple(_tree(loose)),
        )


def _loose(graph: Graph, role: Role) -> _Loose:
    """The endpoints of live nodes that nobody is at the other end of."""
    other = Role.PUBLISHER if role is Role.SUBSCRIBER else Role.SUBSCRIBER
    connected = _topics_having(graph, other)
    if role is Role.SUBSCRIBER:
        connected |= {seen.channel for seen in graph.traffic}
    loose: _Loose = defaultdict(list)
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


def _tree(loose: _Loose) -> Iterator[str]:
    """As roswtf lists them: a node, and its topics below it."""
    for node, endpoints in loose.items():
        yield f" * {node.name}:"
        for endpoint in endpoints:
            yield f"   * {endpoint.topic}"


def _remedies(graph: Graph, loose: _Loose) -> Iterator[str]:
    """How an unconnected subscription may be connected, where that can be told."""
    outputs = _loose(graph, Role.PUBLISHER)
    for node, endpoints in loose.items():
        for endpoint in endpoints:
            elsewhere = _elsewhere(graph, endpoint)
            near = None if elsewhere else _near_name(graph, node, endpoint)
            if elsewhere:
                yield _move(node, endpoint, *elsewhere)
            elif near:
                remap = _remap(node, endpoint.topic, near)
                yield f"{near} is published: start {node.name} with {remap}"
            else:
                yield from _remaps(node, endpoint, outputs)


def _elsewhere(graph: Graph, endpoint: Endpoint) -> tuple[Node, Endpoint] | None:
    """Who publishes a topic of the same base name and type in another namespace."""
    for node in graph.nodes:
        for other in node.having(Role.PUBLISHER):
            if (
                base_name_of(other.topic) == base_name_of(endpoint.topic)
                and other.topic != endpoint.topic
                and set(other.fingerprints) & set(endpoint.fingerprints)
            ):
                return node, other
    return None


def _move(listener: Node, endpoint: Endpoint, publisher: Node, other: Endpoint) -> str:
    """What brings both into one namespace: move whichever has its topic in its own."""
    wanted, offered = namespace_of(endpoint.topic), namespace_of(other.topic)
    if namespace_of(listener.name) == wanted:
        return f"{other.topic} is published: start {listener.name} with __ns:={offered}"
    if namespace_of(publisher.name) == offered:
        return f"{publisher.name} publishes {other.topic}: start it with __ns:={wanted}"
    remap = _remap(publisher, other.topic, endpoint.topic)
    return f"{publisher.name} publishes {other.topic}: start it with {remap}"


def _remap(node: Node, topic: str, target: str) -> str:
    """The argument that makes a node use another topic in place of one that it uses now."""
    for word in node.command.split():
        source, sign, said = word.partition(":=")
        if sign and not source.startswith("_") and said and topic.endswith(said):
            return f"{source}:={target}"  # in place of the one it was started with
    own = namespace_of(node.name) == namespace_of(topic)
    return f"{base_name_of(topic) if own else topic}:={target}"


def _near_name(graph: Graph, listener: Node, endpoint: Endpoint) -> str | None:
    """A topic that is published under nearly the same name, and not of a wrong type."""
    for name in graph.topic_names():
        if name == endpoint.topic or is_hidden(name) or not are_near(name, endpoint.topic):
            continue
        topic = graph.topic(name)
        sent = {f for _, e in topic.publishers for f in e.fingerprints} | set(topic.fingerprints)
        others = [n for n, _ in topic.publishers if n.id != listener.id]
        fits = not endpoint.fingerprints or not sent or sent & set(endpoint.fingerprints)
        if fits and (others or topic.traffic):
            return name
    return None


def are_near(one: str, other: str) -> bool:
    """Whether two names look like the same: but for case, slashes, spaces or one character.

    Names that differ in their numbers only are of different things (/husky0, /husky1).
    """
    if re.sub(r"[0-9]+", "0", one) == re.sub(r"[0-9]+", "0", other):
        return False
    first, second = (re.sub(r"[\s/_]", "", name).casefold() for name in (one, other))
    if first == second:
        return True
    return min(len(first), len(second)) > _SHORT and _is_one_change(first, second)


def _is_one_change(one: str, other: str) -> bool:
    """Whether a character more, less, changed, or swapped with the next makes one the other."""
    if len(one) > len(other):
        one, other = other, one
    start = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), len(one))
    if len(one) == len(other):
        swapped = one[start : start + 2][::-1] + one[start + 2 :]
        return one[start + 1 :] == other[start + 1 :] or swapped == other[start:]
    return one[start:] == other[start + 1 :]


def _remaps(listener: Node, endpoint: Endpoint, outputs: _Loose) -> Iterator[str]:
    """Publications of the right type beside it that nobody hears: a remap may be missing."""
    for node, publications in outputs.items():
        for publication in publications:
            if (
                namespace_of(publication.topic) == namespace_of(endpoint.topic)
                and set(publication.fingerprints) & set(endpoint.fingerprints)
                and node.id != listener.id
            ):
                own = namespace_of(node.name) == namespace_of(endpoint.topic)
                target = base_name_of(endpoint.topic) if own else endpoint.topic
                yield (
                    f"nobody hears {publication.topic} of the same type: start {node.name} with"
                    f" {_remap(node, publication.topic, target)}"
                )
