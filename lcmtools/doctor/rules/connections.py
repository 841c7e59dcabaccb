"""Rules about who is connected to whom."""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.names import base_name_of, is_hidden, namespace_of

# Topics that nodes offer or take as a matter of course; as roswtf excepts /clock and /rosout.
_EVERYBODYS = frozenset({"/clock", "/rosout", "/tf", "/tf_static"})

_Loose = dict[Node, list[Endpoint]]


def subscriptions_are_fed(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher."""
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


def publications_are_heard(evidence: Evidence) -> Iterator[Finding]:
    """Every publication has a subscriber; one that has none is seldom a fault."""
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
            namespace = _other_namespace(graph, endpoint)
            if namespace is not None:
                yield (
                    f"{namespace.rstrip('/')}/{base_name_of(endpoint.topic)} is published: start"
                    f" {node.name} with __ns:={namespace}"
                )
                continue
            yield from _remaps(node, endpoint, outputs)


def _other_namespace(graph: Graph, endpoint: Endpoint) -> str | None:
    """The namespace in which a topic of the same base name and type is published."""
    for node in graph.nodes:
        for other in node.having(Role.PUBLISHER):
            if (
                base_name_of(other.topic) == base_name_of(endpoint.topic)
                and other.topic != endpoint.topic
                and set(other.fingerprints) & set(endpoint.fingerprints)
            ):
                return namespace_of(other.topic)
    return None


def _remaps(listener: Node, endpoint: Endpoint, outputs: _Loose) -> Iterator[str]:
    """Publications of the right type beside it that nobody hears: a remap may be missing."""
    for node, publications in outputs.items():
        for publication in publications:
            if (
                namespace_of(publication.topic) == namespace_of(endpoint.topic)
                and set(publication.fingerprints) & set(endpoint.fingerprints)
                and node.id != listener.id
            ):
                source, target = base_name_of(publication.topic), base_name_of(endpoint.topic)
                yield (
                    f"nobody hears {publication.topic} of the same type: start {node.name} with"
                    f" {source}:={target}"
                )
