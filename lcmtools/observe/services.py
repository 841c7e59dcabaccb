"""The services on a bus: their types, servers and clients, and the one that a word means."""

import os
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, UnknownType, UsageError
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import ServiceType, service_class
from lcmtools.names import Pattern, did_you_mean, resolve, resolve_namespace
from lcmtools.settings import usual_namespace


@dataclass(frozen=True, slots=True)
class OfferedService:
    """A service that nodes announce; more than one server is a fault."""

    name: str
    servers: tuple[tuple[Node, Endpoint], ...]
    clients: tuple[Node, ...] = ()

    @property
    def types(self) -> tuple[str, ...]:
        """The announced types, each once."""
        return tuple(dict.fromkeys(endpoint.type for _, endpoint in self.servers if endpoint.type))

    @property
    def type_text(self) -> str:
        """The announced types, for people."""
        return ", ".join(self.types) or "unknown type"

    @property
    def is_alive(self) -> bool:
        """True if a node is there to answer."""
        return any(not node.stale for node, _ in self.servers)

    def type_class(self) -> type[ServiceType]:
        """Return the pair of messages of the service.

        Raises:
            LcmtoolsError: Its type is not announced, or not known here.
        """
        if not self.types:
            raise LcmtoolsError(f"the type of {self.name} is not known")
        try:
            return service_class(self.types[0])
        except UnknownType as error:
            raise LcmtoolsError(f"{self.name}: {error.what}", error.hint) from None

    def arguments(self) -> list[str] | None:
        """Return the names of the request's fields; None where its type is not known here."""
        try:
            return [field.name for field in visible_fields(self.type_class().Request)]
        except LcmtoolsError:
            return None


def offered_services(
    graph: Graph, namespace: str = "", *, show_all: bool = True
) -> list[OfferedService]:
    """Return the services that nodes announce, sorted by name.

    Args:
        graph: The graph.
        namespace: A namespace or a pattern of those that are meant; "" for all.
        show_all: With hidden names.
    """
    pattern = Pattern(namespace, hidden=show_all)
    names = {e.topic for node in graph.nodes for e in node.having(Role.SERVICE)}
    return [_offered(graph, name) for name in sorted(names) if pattern.covers(name)]


def full_service_name(name: str) -> str:
    """Return the service that a word means, resolved by the ROS rules.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
    """
    if not name.strip("/ "):
        raise UsageError("the service's name is empty", "lcmtools service list shows them")
    return resolve(name, resolve_namespace(usual_namespace(os.environ)))


def find_service(graph: Graph, name: str) -> OfferedService:
    """Return the service that a word means.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
        LcmtoolsError: No node offers it; with a hint at what may have been meant.
    """
    service = _offered(graph, full_service_name(name))
    if not service.servers:
        raise LcmtoolsError(f"unknown service {service.name}", near_service(graph, service.name))
    return service


def near_service(graph: Graph, name: str) -> str:
    """Return a hint at the service that may have been meant instead."""
    known = [service.name for service in offered_services(graph, show_all=False)]
    by_base = [other for other in known if other.rpartition("/")[2] == name.rpartition("/")[2]]
    if by_base:
        return f"did you mean {by_base[0]}?"
    return did_you_mean(name, known) or (
        "lcmtools service list shows the services" if known else "no node offers a service"
    )


def _offered(graph: Graph, name: str) -> OfferedService:
    """A service; servers that are stale count only where there is no other."""
    servers = [
        (node, endpoint)
        for node in graph.nodes
        for endpoint in node.having(Role.SERVICE)
        if endpoint.topic == name
    ]
    alive = [pair for pair in servers if not pair[0].stale]
    clients = (n for n in graph.nodes if any(e.topic == name for e in n.having(Role.CLIENT)))
    return OfferedService(name, tuple(alive or servers), tuple(clients))
