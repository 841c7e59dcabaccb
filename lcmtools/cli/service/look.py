"""``lcmtools service list``, ``find``, ``type``, ``args`` and ``info``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import (
    all_option,
    in_names,
    json_option,
    looking_names,
    looking_options,
    open_monitor,
)
from lcmtools.cli.output import data, document, lines, show, talk
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Endpoint, Node
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import service_name
from lcmtools.observe.describe import listed_node, node_record
from lcmtools.observe.find import OfferedService, find_service, offered_services


@subcommand("list")
@argument("namespace", default="", completer="bus:namespaces")
@option("-t", "--show-types", is_flag=True, help="Show each service's type.")
@option("-n", "--nodes", "show_nodes", is_flag=True, help="Show the nodes that offer it.")
@all_option
@json_option
@looking_options
def list_services(
    namespace: str, *, show_types: bool, show_nodes: bool, show_all: bool, as_json: bool
) -> None:
    """List the services of nodes.

    NAMESPACE selects a service, those in a namespace, or those that match a pattern: '/husky*'.

    \b
    Examples:
      lcmtools service list
      lcmtools service list -t /husky0
    """
    with open_monitor("service_list") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    services = offered_services(graph, in_names(namespace), show_all=show_all)
    rows = (_row(s, show_types=show_types, show_nodes=show_nodes) for s in services)
    show(list(map(_listed_record, services)), rows, as_json=as_json)
    if not services:
        talk(f"no services{f' in {namespace}' if namespace else ''} on {url}")


def _row(service: OfferedService, *, show_types: bool, show_nodes: bool) -> str:
    words = [service.name]
    if show_types:
        words.append(f"[{service.type_text}]")
    if show_nodes:
        words += [node.name for node, _ in service.servers]
    if not service.is_alive:
        words.append(f"(stale: {service.servers[0][0].stale})")
    return " ".join(words)


def _listed_record(service: OfferedService) -> dict[str, object]:
    return {
        "service": service.name,
        "types": list(service.types),
        "nodes": [node.name for node, _ in service.servers],
        "stale": not service.is_alive,
    }


@subcommand("find")
@argument("type_", metavar="TYPE", completer="messages:service_types")
@all_option
@json_option
@looking_options
def find(type_: str, *, show_all: bool, as_json: bool) -> None:
    """List the services of a type.

    TYPE is std_srvs/Trigger, std_srvs/srv/Trigger, std_srvs.Trigger or Trigger.

    \b
    Examples:
      lcmtools service find std_srvs/Trigger
      lcmtools service find SetBool --json
    """
    name = service_name(type_)
    with open_monitor("service_find") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    found = [s.name for s in offered_services(graph, show_all=show_all) if name in s.types]
    show(found, found, as_json=as_json)
    if not found:
        talk(f"no services of type {name} on {url}")


@subcommand("type")
@argument("service", completer="bus:services")
@json_option
@looking_options
def type_(service: str, *, as_json: bool) -> None:
    """Print a service's type.

    \b
    Examples:
      lcmtools service type /reset
      lcmtools srv show $(lcmtools service type /reset)
    """
    with open_monitor("service_type") as monitor:
        graph = monitor.settle(foreign=False)
    found = find_service(graph, in_names(service), looking_names().namespace)
    if not (found.types or as_json):
        raise LcmtoolsError(f"the type of {found.name} is not known")
    record = {"service": found.name, "type": found.type_text if found.types else None}
    show(record, [found.type_text], as_json=as_json)


@subcommand("args")
@argument("service", completer="bus:services")
@json_option
@looking_options
def args(service: str, *, as_json: bool) -> None:
    """Print the names of a service's arguments: the fields of its request.

    \b
    Examples:
      lcmtools service args /switch
      lcmtools service args /switch --json
    """
    with open_monitor("service_args") as monitor:
        graph = monitor.settle(foreign=False)
    found = find_service(graph, in_names(service), looking_names().namespace)
    names = [field.name for field in visible_fields(found.type_class().Request)]
    document(names) if as_json else data(" ".join(names))


@subcommand("info")
@argument("services", metavar="SERVICE...", nargs=-1, required=True, completer="bus:services")
@json_option
@looking_options
def info(services: tuple[str, ...], *, as_json: bool) -> None:
    """Show a service's node, type, arguments and clients.

    \b
    Examples:
      lcmtools service info /reset
      lcmtools service info /reset --json
    """
    with open_monitor("service_info") as monitor:
        graph = monitor.settle(foreign=False)
    namespace = looking_names().namespace
    found = [find_service(graph, in_names(name), namespace) for name in services]
    if as_json:
        document([_record(service) for service in found])
        return
    rows = ([f"Service: {s.name}"] if len(found) > 1 else [] for s in found)
    lines(row for heading, s in zip(rows, found, strict=True) for row in [*heading, *_text(s)])


def _text(service: OfferedService) -> list[str]:
    rows = [row for node, endpoint in service.servers for row in _server(node, endpoint)]
    names = service.arguments()
    rows.append(f"Type: {service.type_text}")
    rows.append(f"Args: {'unknown' if names is None else ' '.join(names)}")
    if service.clients:
        rows += ["Clients:", *(f" * {listed_node(node)}" for node in service.clients)]
    return rows


def _server(node: Node, endpoint: Endpoint) -> list[str]:
    from lcmtools.observe.counters import callback_times  # the others do without

    took = callback_times(endpoint)
    return [
        f"Node: {listed_node(node)}",
        f"Host: {node.host}",
        f"Pid: {node.pid}",
        f"Calls: {endpoint.messages}{f', {took}' if took else ''}",
    ]


def _record(service: OfferedService) -> dict[str, object]:
    from lcmtools.observe.counters import callback_record

    return {
        "service": service.name,
        "types": list(service.types),
        "args": service.arguments(),
        "servers": [
            {**node_record(n), "calls": e.messages, **callback_record(e)}
            for n, e in service.servers
        ],
        "clients": [node.name for node in service.clients],
    }
