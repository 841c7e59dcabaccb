"""``lcmtools service list``, ``find``, ``type``, ``args`` and ``info``."""

from lcmtools.cli.bus import in_names, look, looking_names
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import write_result
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import service_name
from lcmtools.observe.reading.find import OfferedService, find_service, offered_services


@subcommand("list", all_option, json_option, looking_options)
@examples("service list", "service list -t /husky0")
@argument("namespace", default="", completer="bus:namespaces")
@flag("-t", "--show-types", help="Show each service's type.")
@flag("-n", "--nodes", "show_nodes", help="Show the nodes that offer it.")
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
    write_result([one.to_json() for one in services], rows, as_json=as_json, none=none)


def _row(service: OfferedService, *, show_types: bool, show_nodes: bool) -> str:
    words = [service.name, *[f"[{service.type_text}]"] * show_types]
    words += [node.name for node, _ in service.servers if show_nodes]
    words += [] if service.is_alive else [f"(stale: {service.servers[0][0].stale})"]
    return " ".join(words)


def _find(tool: str, *words: str) -> list[OfferedService]:
    graph, _ = look(tool)
    return [find_service(graph, in_names(word), looking_names().namespace) for word in words]


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
    write_result(found, found, as_json=as_json, none=f"no services of type {name} on {url}")


@subcommand("type", json_option, looking_options)
@examples("service type /reset", "srv show $(lcmtools service type /reset)")
@argument("service", completer="bus:services")
def type_(service: str, *, as_json: bool) -> None:
    """Print a service's type."""
    found = _find("service_type", service)[0]
    if not (found.types or as_json):
        raise LcmtoolsError(f"the type of {found.name} is not known")
    record = {"service": found.name, "type": found.type_text if found.types else None}
    write_result(record, [found.type_text], as_json=as_json)


@subcommand("args", json_option, looking_options)
@examples("service args /switch", "service args /switch --json")
@argument("service", completer="bus:services")
def args(service: str, *, as_json: bool) -> None:
    """Print the names of a service's arguments: the fields of its request."""
    found = _find("service_args", service)[0]
    names = [field.name for field in visible_fields(found.type_class().Request)]
    write_result(names, [" ".join(names)], as_json=as_json)


@subcommand("info", json_option, looking_options)
@examples("service info /reset", "service info /reset --json")
@argument("services", metavar="SERVICE...", nargs=-1, required=True, completer="bus:services")
def info(services: tuple[str, ...], *, as_json: bool) -> None:
    """Show a service's node, type, arguments and clients."""
    from lcmtools.observe.reports import service_report  # the others do without

    found = _find("service_info", *services)
    rows = (row for one in found for row in service_report.to_lines(one, is_only=len(found) == 1))
    write_result(list(map(service_report.to_json, found)), rows, as_json=as_json)
