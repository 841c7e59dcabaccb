"""``lcmtools service info``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import in_names, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import document, lines
from lcmtools.graph.model import Endpoint, Node
from lcmtools.observe.counters import callback_record, callback_times
from lcmtools.observe.describe import listed_node, node_record
from lcmtools.observe.find import OfferedService, find_service


@subcommand("info")
@argument("services", metavar="SERVICE...", nargs=-1, required=True, completer="bus:services")
@json_option
@looking_options
def command(services: tuple[str, ...], *, as_json: bool) -> None:
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
    """As rosservice info prints it, with the process beside the node."""
    rows = [row for node, endpoint in service.servers for row in _server(node, endpoint)]
    names = service.arguments()
    rows.append(f"Type: {service.type_text}")
    rows.append(f"Args: {'unknown' if names is None else ' '.join(names)}")
    if service.clients:
        rows += ["Clients:", *(f" * {listed_node(node)}" for node in service.clients)]
    return rows


def _server(node: Node, endpoint: Endpoint) -> list[str]:
    took = callback_times(endpoint)
    return [
        f"Node: {listed_node(node)}",
        f"Host: {node.host}",
        f"Pid: {node.pid}",
        f"Calls: {endpoint.messages}{f', {took}' if took else ''}",
    ]


def _record(service: OfferedService) -> dict[str, object]:
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
