"""The services on a bus: who offers them, and which of them a word means."""

import os
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, UnknownType, UsageError
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import ServiceType, service_class
from lcmtools.names import did_you_mean, is_hidden, resolve, resolve_namespace
from lcmtools.settings import usual_namespace

UNKNOWN = "unknown type"


@dataclass(frozen=True, slots=True)
class Offered:
    """A service that is announced.

    Attributes:
        name: Its full name.
        servers: The nodes that answer it; more than one is a fault.
        clients: The nodes that call it.
    """

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
        return ", ".join(self.types) or UNKNOWN

    @property
    def is_alive(self) -> bool:
        """Whether any node is there to answer."""
        return any(not node.stale for node, _ in self.servers)


def offered(graph: Graph) -> list[Offered]:
    """All services that nodes announce, sorted by name."""
    names = {e.topic for node in graph.nodes for e in node.having(Role.SERVICE)}
    return [_offered(graph, name) for name in sorted(names)]


def shown(graph: Graph, namespace: str = "", *, show_all: bool = False) -> list[Offered]:
    """The services that lists show: those in a namespace, without the hidden ones."""
    prefix = f"/{namespace.strip('/')}" if namespace.strip("/") else ""
    return [
        service
        for service in offered(graph)
        if (show_all or not is_hidden(service.name))
        and (not prefix or service.name == prefix or service.name.startswith(f"{prefix}/"))
    ]


def full_name(name: str) -> str:
    """The service that a word means: resolved by the ROS rules.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
    """
    if not name.strip("/ "):
        raise UsageError("the service's name is empty", "lcmtools service list shows them")
    return resolve(name, resolve_namespace(usual_namespace(os.environ)))


def find_service(graph: Graph, name: str) -> Offered:
    """The service that a word means.

    Raises:
        UsageError: The name is empty or breaks the naming rules.
        LcmtoolsError: No node offers it; with what may have been meant.
    """
    service = _offered(graph, full_name(name))
    if not service.servers:
        raise LcmtoolsError(f"unknown service {service.name}", near_service(graph, service.name))
    return service


def near_service(graph: Graph, name: str) -> str:
    """A hint at the service that may have been meant instead."""
    known = [service.name for service in shown(graph)]
    by_base = [other for other in known if other.rpartition("/")[2] == name.rpartition("/")[2]]
    if by_base:
        return f"did you mean {by_base[0]}?"
    return did_you_mean(name, known) or (
        "lcmtools service list shows the services" if known else "no node offers a service"
    )


def class_of(service: Offered) -> type[ServiceType]:
    """The pair of messages of a service.

    Raises:
        LcmtoolsError: Its type is not announced, or not known here.
    """
    if not service.types:
        raise LcmtoolsError(f"the type of {service.name} is not known")
    try:
        return service_class(service.types[0])
    except UnknownType as error:
        raise LcmtoolsError(f"{service.name}: {error.what}", error.hint) from None


def arguments(service: Offered) -> list[str] | None:
    """The names of the request's fields; None where its type is not known here."""
    try:
        request = class_of(service).Request
    except LcmtoolsError:
        return None
    return [field.name for field in visible_fields(request)]


def _offered(graph: Graph, name: str) -> Offered:
    """What is announced of one service; nodes that are alive come first."""
    servers = [
        (node, endpoint)
        for node in graph.nodes
        for endpoint in node.having(Role.SERVICE)
        if endpoint.topic == name
    ]
    alive = [pair for pair in servers if not pair[0].stale]
    clients = (n for n in graph.nodes if any(e.topic == name for e in n.having(Role.CLIENT)))
    return Offered(name, tuple(alive or servers), tuple(clients))
