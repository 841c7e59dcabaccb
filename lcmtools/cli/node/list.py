"""``lcmtools node list``, ``machine`` and ``cleanup``."""

from collections import Counter

from lcmtools.cli.bus import in_names, look, looking_names, notify_starting, open_monitor
from lcmtools.cli.declare import (
    accepted_for_ros,
    argument,
    duration,
    examples,
    flag,
    option,
    subcommand,
)
from lcmtools.cli.options import all_option, bus_options, json_option, looking_options
from lcmtools.cli.output import write_data, write_document, write_lines, write_note, write_result
from lcmtools.graph.model import Staleness
from lcmtools.names import Pattern

_HEADING = "Programs that are not nodes (seen on the bus):"


@subcommand("list", json_option, looking_options)
@examples("node list", "node list -a /husky0")
@argument("namespace", default="", completer="bus:namespaces")
@flag(
    "-a",
    "--all",
    "show_all",
    help="Show host, pid and up-time, hidden nodes, and plain LCM programs.",
)
@flag("-u", "--uri", help="Print the nodes' addresses, as rosnode list -u.")
@flag("-c", "--count-nodes", "count", help="Print the number of nodes.")
@option("--wait", type=duration, help="With -a: observe other programs for this long.")
def list_nodes(
    namespace: str, *, show_all: bool, uri: bool, count: bool, wait: float | None, as_json: bool
) -> None:
    """List the nodes on the bus. A node that was killed or hangs is shown as stale.

    NAMESPACE selects a node or the nodes in a namespace. In quotes it may be a pattern: * is any
    characters but /, ** any characters, ? one. A pattern without / may match a node's last part:
    "*arm*".
    """
    with open_monitor("node_list", asks=True) as monitor:
        from lcmtools.observe.reading.senders import programs  # while the nodes answer
        from lcmtools.observe.reports import node_list_report, program_report
        from lcmtools.observe.reports.describe import listed_node

        graph, url = monitor.settle(foreign=show_all, wait=wait if show_all else None), monitor.url
    pattern = Pattern(in_names(namespace), looking_names().namespace, hidden=show_all)
    nodes = [node for node in graph.nodes if pattern.means_node(node.name)]
    others = programs(graph, url) if (show_all or not nodes) and not namespace else []
    if as_json:
        records = [program_report.to_json(one) for one in others if show_all]
        write_document([*map(node_list_report.to_json, nodes), *records])
    elif count:
        write_data(str(len(nodes)))
    elif uri:
        write_lines(f"udp://{node.sender}/" if node.sender else "unknown address" for node in nodes)
    elif show_all:
        write_lines(node_list_report.to_lines(nodes, graph.time))
        rows = (row for one in others for row in program_report.listed_rows(one))
        write_lines(["", _HEADING, *rows] if others else [])
    else:
        write_lines(map(listed_node, nodes))
    if not nodes and not count:
        more = "; -a shows programs that are not nodes" if others and not show_all else ""
        write_note(f"no nodes{f' in {namespace}' if namespace else ''} on {url}{more}")
    names = Counter(node.name for node in nodes if not (node.stale or node.is_recorded))
    if twice := sorted(name for name, number in names.items() if number > 1):
        write_note(f"several nodes have the same name: {', '.join(twice)}; lcmtools wtf shows more")
    notify_starting(graph, url)


@subcommand("machine", all_option, json_option, bus_options)
@examples("node machine", "node machine husky0-pc")
@argument("host", required=False, completer="bus:hosts")
def machine(host: str | None, *, show_all: bool, as_json: bool) -> None:
    """List the computers that nodes run on, or the nodes of one computer.

    HOST is a name or an address.
    """
    from lcmtools.observe.reports.describe import Computers, listed_node

    graph, url = look("node_machine")
    nodes = [node for node in graph.nodes if show_all or not node.is_hidden]
    computers = Computers(graph.nodes)
    found = nodes if host is None else computers.nodes_on(host, nodes)
    names: dict[str, list[str]] = {}
    for node in found:
        names.setdefault(computers.of(node), []).append(node.name)
    record = [{"host": name, "nodes": of} for name, of in sorted(names.items())]
    rows = sorted(names) if host is None else map(listed_node, found)
    write_result(record, rows, as_json=as_json, none=f"no nodes on {url}")


@subcommand("cleanup", json_option, bus_options)
@examples("node cleanup", "node cleanup --domain 3")
@accepted_for_ros("-y", "--yes")  # nothing is asked
def cleanup(*, as_json: bool) -> None:
    """Forget the nodes that ended without saying goodbye, and print their names.

    Nodes that still run are kept, even if they do not answer.
    """
    with open_monitor("node_cleanup") as monitor:
        nodes = monitor.settle(foreign=False).nodes
        ended = [node for node in nodes if node.stale is Staleness.ENDED]
        for node in ended:
            monitor.forget(node)
    names = [node.name for node in ended]
    none = "no node has ended without saying goodbye"
    write_result(names, names, as_json=as_json, none=none)
