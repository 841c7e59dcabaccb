"""Finding the topic, the node or the service that a command line argument means."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from lcmtools.errors import LcmtoolsError, UnknownType, UsageError
from lcmtools.graph.model import Endpoint, Ends, Graph, NodeInfo, Role, Topic
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.path import Path, parse_path, splits
from lcmtools.messages.registry import ServiceType, candidates, service_class
from lcmtools.names import (
    Pattern,
    Resolver,
    base_name_of,
    closest,
    did_you_mean,
    is_hidden,
    resolve,
)

_OF_SERVICES = (Role.SERVICE, Role.CLIENT)
GLOBAL = Resolver()  # relative names are in "/", and none is remapped


def known_spelling(graph: Graph, name: str, names: Resolver = GLOBAL) -> str | None:
    """Return the channel on the bus that a topic's name refers to; None if there is none."""
    known = set(graph.topic_names())
    return next((spelling for spelling in names.spellings(name) if spelling in known), None)


def find_topic(graph: Graph, name: str, names: Resolver = GLOBAL) -> Topic:
    """Return the topic that a name means.

    Raises:
        LcmtoolsError: It is not on the bus; the hint has the topic that was probably meant.
    """
    spelling = known_spelling(graph, name, names)
    if spelling is None:
        raise LcmtoolsError(
            f"unknown topic {names.spellings(name)[-1]}",
            near_topic(graph.topic_names(), name, names),
        )
    return graph.topic(spelling)


def find_topic_and_path(
    graph: Graph, argument: str, names: Resolver = GLOBAL
) -> tuple[Topic, Path]:
    """Return the longest topic that an argument begins with, and the path after it."""
    for topic, rest in splits(argument):
        if known_spelling(graph, topic, names) is not None:
            try:
                return find_topic(graph, topic, names), parse_path(rest)
            except UsageError as error:
                raise LcmtoolsError(error.what, error.hint) from error
    return find_topic(graph, argument, names), Path()


def is_of_type(topic: Topic, name: str) -> bool:
    """Return whether a topic has a type: announced, or possibly sent by a plain program.

    A fingerprint that an announced type shares is taken for the announced type's.
    """
    seen = map(candidates, topic.fingerprints)
    return name in topic.types or any(
        name in names and not set(names) & set(topic.types) for names in seen
    )


def near_topic(known: Iterable[str], name: str, names: Resolver = GLOBAL) -> str:
    """Return a hint at the topic that was probably meant."""
    visible = [topic for topic in known if not is_hidden(topic)]
    return _near(name, names.spellings(name)[-1], visible) or "lcmtools list shows the topics"


def find_node(graph: Graph, name: str) -> NodeInfo:
    """Return the first of the nodes that a name means; see ``find_nodes``."""
    return find_nodes(graph, name)[0]


def find_nodes(graph: Graph, name: str) -> list[NodeInfo]:
    """Return the nodes that a name means: several if they share a name or pid.

    The name is a full name, the last part of one if unique, or a pid, alone or as HOST:PID. If a
    node was killed and started again, the living one is meant.

    Raises:
        UsageError: The name is empty.
        LcmtoolsError: There is none, or nodes of different names match.
    """
    if not name:
        raise UsageError("the node's name is empty", "lcmtools node list shows them")
    by_pid = [node for node in graph.nodes if name in _numbers(node)]
    named = graph.named(name) or by_pid
    found = [node for node in named if not node.stale] or named
    names = sorted({node.name for node in found})
    if not found:
        raise LcmtoolsError(f"unknown node {name}", near_node(graph, name))
    if len(names) > 1 and not by_pid:
        raise LcmtoolsError(f"several nodes are named {name}", f"write one of {', '.join(names)}")
    return found


class OfferedService(NamedTuple):
    """A service that nodes announce; more than one server is a fault."""

    name: str
    servers: Ends
    clients: tuple[NodeInfo, ...] = ()

    @property
    def types(self) -> tuple[str, ...]:
        """The announced types, each once."""
        return tuple(dict.fromkeys(endpoint.type for _, endpoint in self.servers if endpoint.type))

    @property
    def type_text(self) -> str:
        """The announced types, as text."""
        return ", ".join(self.types) or "unknown type"

    @property
    def is_alive(self) -> bool:
        """True if a node is there to answer."""
        return any(not node.stale for node, _ in self.servers)

    def type_class(self) -> type[ServiceType]:
        """Return the service's pair of message classes.

        Raises:
            LcmtoolsError: Its type is not announced or not known here.
        """
        if not self.types:
            raise LcmtoolsError(f"the type of {self.name} is not known")
        try:
            return service_class(self.types[0])
        except UnknownType as error:
            raise LcmtoolsError(f"{self.name}: {error.what}", error.hint) from None

    def to_json(self) -> dict[str, object]:
        """Return the service for JSON, as lists show it."""
        return {
            "service": self.name,
            "types": list(self.types),
            "nodes": [node.name for node, _ in self.servers],
            "stale": not self.is_alive,
        }

    def arguments(self) -> list[str] | None:
        """Return the names of the request's fields; None if its type is not known here."""
        try:
            return [field.name for field in visible_fields(self.type_class().Request)]
        except LcmtoolsError:
            return None


def offered_services(
    graph: Graph, namespace: str = "", *, show_all: bool = True
) -> list[OfferedService]:
    """Return the services that nodes announce, sorted by name.

    ``namespace`` is a namespace or a pattern that selects services, "" for all; ``show_all``
    includes hidden names.
    """
    pattern = Pattern(namespace, hidden=show_all)
    found: dict[str, list[tuple[NodeInfo, Endpoint]]] = defaultdict(list)
    for node in graph.nodes:
        for end in node.endpoints:
            if end.role in _OF_SERVICES:
                found[end.topic].append((node, end))
    services = (_service(name, found[name]) for name in sorted(found) if pattern.covers(name))
    return [service for service in services if service.servers]


def full_service_name(name: str, namespace: str = "/") -> str:
    """Return the service that an argument means, resolved by the ROS rules.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
    """
    if not name.strip("/ "):
        raise UsageError("the service's name is empty", "lcmtools service list shows them")
    return resolve(name, namespace)


def find_service(graph: Graph, name: str, namespace: str = "/") -> OfferedService:
    """Return the service that an argument means.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
        LcmtoolsError: No node offers it; with a hint at the one that was probably meant.
    """
    service = _offered(graph, full_service_name(name, namespace))
    if not service.servers:
        raise LcmtoolsError(f"unknown service {service.name}", near_service(graph, service.name))
    return service


def near_service(graph: Graph, name: str) -> str:
    """Return a hint at the service that was probably meant."""
    known = [service.name for service in offered_services(graph, show_all=False)]
    usual = "lcmtools service list shows the services" if known else "no node offers a service"
    return _near(name, name, known) or usual


def _offered(graph: Graph, name: str) -> OfferedService:
    ends = [(node, end) for node in graph.nodes for end in node.endpoints if end.topic == name]
    return _service(name, ends)


def _service(name: str, ends: Sequence[tuple[NodeInfo, Endpoint]]) -> OfferedService:
    """A service; stale servers count only if there is no other."""
    servers = [pair for pair in ends if pair[1].role is Role.SERVICE]
    alive = [pair for pair in servers if not pair[0].stale]
    clients = dict.fromkeys(node for node, end in ends if end.role is Role.CLIENT)
    return OfferedService(name, tuple(alive or servers), tuple(clients))


def _near(name: str, full: str, known: Iterable[str]) -> str:
    by_base = [other for other in known if other.rpartition("/")[2] == name.rpartition("/")[2]]
    return f"did you mean {by_base[0]}?" if by_base else did_you_mean(full, known)


def near_node(graph: Graph, name: str) -> str:
    """Return a hint at the node that may have been meant instead."""
    known = [node.name for node in graph.nodes if not node.is_hidden]
    by_base = {base_name_of(full): full for full in known}
    near = closest(base_name_of(name), by_base)
    if base_name_of(name) in by_base:
        return f"did you mean {by_base[base_name_of(name)]}?"
    full = name if name.startswith("/") else f"/{name}"
    if hint := did_you_mean(full, known):
        return hint
    return f"did you mean {by_base[near[0]]}?" if near else "lcmtools node list shows them"


def _numbers(node: NodeInfo) -> list[str]:
    """The ways to write a node's process: its pid, alone or with the computer: "ada:1234"."""
    if node.path:  # behind a relay: the pid is another bus's
        return []
    computers = [node.host, *([node.sender.address] if node.sender else [])]
    return [str(node.pid), *(f"{computer}:{node.pid}" for computer in computers)]
