"""``lcmtools service list``, ``find``, ``type``, ``args`` and ``info``."""

from collections.abc import Iterator

from lcmtools.cli.bus import in_names, look, looking_names
from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import show
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import service_name
from lcmtools.observe.describe import listed_node, node_record
from lcmtools.observe.find import OfferedService, find_service, offered_services


@subcommand("list", all_option, json_option, looking_options)
@examples("service list", "service list -t /husky0")
@argument("namespace", default="", completer="bus:namespaces")
@option("-t", "--show-types", is_flag=True, help="Show each service's type.")
@option("-n", "--nodes", "show_nodes", is_flag=True, help="Show the nodes that offer it.")
def list_services(
    namespace: str, *, show_types: bool, show_nodes: bool, show_all: bool, as_json: bool
) -> None:
    """List the services of nodes.

    NAMESPACE selects a service, those in a namespace, or those that match a pattern: '/husky*'.
    """
    graph, url = look("service_list")
    services = offered_services(graph, in_names(namespace), show_all=show_all)
    rows = (_row(s, show_types=show_types, show_nodes=show_nodes) for s in services)
    none = f"no services{f' in {namespace}' if namespace else ''} on {url}"
    show(list(map(_listed_record, services)), rows, as_json=as_json, none=none)


def _find(tool: str, *words: str) -> list[OfferedService]:
    graph, _ = look(tool)
    return [find_service(graph, in_names(word), looking_names().namespace) for word in words]


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


@subcommand("find", all_option, json_option, looking_options)
@examples("service find std_srvs/Trigger", "service find SetBool --json")
@argument("type_", metavar="TYPE", completer="messages:service_types")
def find(type_: str, *, show_all: bool, as_json: bool) -> None:
    """List the services of a type.

    TYPE is std_srvs/Trigger, std_srvs/srv/Trigger, std_srvs.Trigger or Trigger.
    """
    name = service_name(type_)
    graph, url = look("service_find")
    found = [s.name for s in offered_services(graph, show_all=show_all) if name in s.types]
    show(found, found, as_json=as_json, none=f"no services of type {name} on {url}")


@subcommand("type", json_option, looking_options)
@examples("service type /reset", "srv show $(lcmtools service type /reset)")
@argument("service", completer="bus:services")
def type_(service: str, *, as_json: bool) -> None:
    """Print a service's type."""
    found = _find("service_type", service)[0]
    if not (found.types or as_json):
        raise LcmtoolsError(f"the type of {found.name} is not known")
    record = {"service": found.name, "type": found.type_text if found.types else None}
    show(record, [found.type_text], as_json=as_json)


@subcommand("args", json_option, looking_options)
@examples("service args /switch", "service args /switch --json")
@argument("service", completer="bus:services")
def args(service: str, *, as_json: bool) -> None:
    """Print the names of a service's arguments: the fields of its request."""
    found = _find("service_args", service)[0]
    names = [field.name for field in visible_fields(found.type_class().Request)]
    show(names, [" ".join(names)], as_json=as_json)


@subcommand("info", json_option, looking_options)
@examples("service info /reset", "service info /reset --json")
@argument("services", metavar="SERVICE...", nargs=-1, required=True, completer="bus:services")
def info(services: tuple[str, ...], *, as_json: bool) -> None:
    """Show a service's node, type, arguments and clients."""
    found = _find("service_info", *services)
    rows = (row for one in found for row in _text(one, is_only=len(found) == 1))
    show(list(map(_record, found)), rows, as_json=as_json)


def _text(service: OfferedService, *, is_only: bool) -> Iterator[str]:
    from lcmtools.observe.counters import callback_times  # the others do without

    yield from [] if is_only else [f"Service: {service.name}"]
    for node, endpoint in service.servers:
        took = callback_times(endpoint)
        yield from (f"Node: {listed_node(node)}", f"Host: {node.host}", f"Pid: {node.pid}")
        yield f"Calls: {endpoint.messages}{f', {took}' if took else ''}"
    names = service.arguments()
    yield f"Type: {service.type_text}"
    yield f"Args: {'unknown' if names is None else ' '.join(names)}"
    if service.clients:
        yield from ("Clients:", *(f" * {listed_node(node)}" for node in service.clients))


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
