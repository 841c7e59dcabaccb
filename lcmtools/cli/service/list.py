"""``lcmtools service list`` and ``find``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import all_option, in_names, json_option, looking_options, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.messages.registry import service_name
from lcmtools.observe.find import OfferedService, offered_services


@subcommand("list")
@argument("namespace", default="", completer="bus:namespaces")
@option("-t", "--show-types", is_flag=True, help="Show each service's type.")
@option("-n", "--nodes", "show_nodes", is_flag=True, help="Show the nodes that answer.")
@all_option
@json_option
@looking_options
def list_services(
    namespace: str, *, show_types: bool, show_nodes: bool, show_all: bool, as_json: bool
) -> None:
    """List the services that nodes offer.

    NAMESPACE keeps the services that are it or stand below it, or match it: '/husky*'.

    \b
    Examples:
      lcmtools service list
      lcmtools service list -t /husky0
    """
    with open_monitor("service_list") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    services = offered_services(graph, in_names(namespace), show_all=show_all)
    if as_json:
        document([_record(service) for service in services])
    else:
        lines(_row(s, show_types=show_types, show_nodes=show_nodes) for s in services)
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


def _record(service: OfferedService) -> dict[str, object]:
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
    document(found) if as_json else lines(found)
    if not found:
        talk(f"no services of type {name} on {url}")
