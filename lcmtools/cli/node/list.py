"""``lcmtools node list``, ``machine`` and ``cleanup``."""

import contextlib
import socket
from collections import Counter, deque
from collections.abc import Callable

from lcmtools.cli.bus import in_names, look, looking_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.options import all_option, bus_options, json_option, looking_options
from lcmtools.cli.output import data, document, lines, show, talk
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Node, Staleness
from lcmtools.names import Pattern, did_you_mean

_HEADING = "Programs that are no nodes (seen on the bus):"


@subcommand("list", json_option, looking_options)
@examples("node list", "node list -a /husky0")
@argument("namespace", default="", completer="bus:namespaces")
@option(
    "-a",
    "--all",
    "show_all",
    is_flag=True,
    help="Show host, pid and up-time, hidden nodes, and plain LCM programs.",
)
@option("-u", "--uri", is_flag=True, help="Print the nodes' addresses, as rosnode list -u.")
@option("-c", "--count-nodes", "count", is_flag=True, help="Print the number of nodes.")
@option("--wait", type=duration, help="With -a: observe other programs for this long.")
def list_nodes(
    namespace: str, *, show_all: bool, uri: bool, count: bool, wait: float | None, as_json: bool
) -> None:
    """List the nodes on the bus. A node that was killed or hangs is shown as stale.

    NAMESPACE selects a node or the nodes in a namespace. In quotes it may be a pattern: * is any
    characters but /, ** any characters, ? one. A pattern without / may match a node's last part:
    "*arm*".
    """
    from lcmtools.cli.node.sections import program_record, program_rows  # the others do without
    from lcmtools.observe.describe import listed_node, node_record
    from lcmtools.observe.senders import programs

    with open_monitor("node_list") as monitor:
        graph = monitor.settle(foreign=show_all and wait is None)
        if show_all and wait is not None:
            with contextlib.suppress(EOFError):  # a log has ended
                deque(monitor.packets(wait), maxlen=0)
            graph = monitor.graph()
        url = monitor.url
    pattern = Pattern(in_names(namespace), looking_names().namespace, hidden=show_all)
    nodes = [node for node in graph.nodes if pattern.means_node(node.name)]
    others = programs(graph, url) if show_all and not namespace else []
    if as_json:
        document([*map(node_record, nodes), *map(program_record, others)])
    elif count:
        data(str(len(nodes)))
    elif uri:
        lines(f"udp://{node.sender}/" if node.sender else "unknown address" for node in nodes)
    elif show_all:
        lines(_row(node, graph.time) for node in nodes)
        lines(["", _HEADING, *(row for one in others for row in program_rows(one))] * bool(others))
    else:
        lines(map(listed_node, nodes))
    if not nodes and not count:
        talk(f"no nodes{f' in {namespace}' if namespace else ''} on {url}")
    names = Counter(node.name for node in nodes if not node.stale)
    if twice := sorted(name for name, number in names.items() if number > 1):
        talk(f"several nodes have the same name: {', '.join(twice)}; lcmtools wtf shows more")


def _row(node: Node, now: int) -> str:
    """As rosnode list -a has it, the address first, and what else is known behind the name."""
    seconds = max(0, node.time_there(now) - node.start_time) / 1e9
    units = (("days", 86400), ("h", 3600), ("min", 60))
    spans = (f"{seconds / length:.1f} {unit}" for unit, length in units if seconds >= 2 * length)
    state = f"stale: {node.stale}" if node.stale else f"up {next(spans, f'{seconds:.0f} s')}"
    return f"{node.host}:{node.pid} \t{node.name}\t{state}"


@subcommand("machine", all_option, json_option, bus_options)
@examples("node machine", "node machine husky0-pc")
@argument("host", required=False, completer="bus:hosts")
def machine(host: str | None, *, show_all: bool, as_json: bool) -> None:
    """List the computers that nodes run on, or the nodes of one computer.

    HOST is a name or an address.
    """
    from lcmtools.observe.describe import Computers, listed_node

    graph, url = look("node_machine")
    nodes = [node for node in graph.nodes if show_all or not node.is_hidden]
    machine_of = Computers(graph.nodes).of
    names: dict[str, list[Node]] = {name: [] for name in sorted(set(map(machine_of, nodes)))}
    found = nodes if host is None else _nodes_of(host, nodes, machine_of)
    for node in found:
        names[machine_of(node)].append(node)
    record = [{"host": h, "nodes": [n.name for n in of]} for h, of in names.items() if of]
    show(record, names if host is None else map(listed_node, found), as_json=as_json)
    if not nodes:
        talk(f"no nodes on {url}")


def _nodes_of(host: str, nodes: list[Node], machine_of: Callable[[Node], str]) -> list[Node]:
    wanted = socket.gethostname() if host in ("localhost", "127.0.0.1") else host
    found = [
        node
        for node in nodes
        if wanted in (node.host, machine_of(node), node.sender and node.sender.address)
    ]
    if not found:
        hint = did_you_mean(host, {node.host for node in nodes})
        what = f"no node runs on machine {host}"
        raise LcmtoolsError(what, hint or "lcmtools node machine lists the machines")
    return found


@subcommand("cleanup", json_option, bus_options)
@examples("node cleanup", "node cleanup --domain 3")
@option("-y", "--yes", is_flag=True, expose_value=False, help="Accepted as in rosnode; no effect.")
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
    show(names, names, as_json=as_json)
    if not ended:
        talk("no node has ended without saying goodbye")
