"""``lcmtools node list``."""

import contextlib
from collections import Counter, deque

from lcmtools.cli.declare import argument, duration, option, subcommand
from lcmtools.cli.node.programs import program_record, program_rows
from lcmtools.cli.options import in_names, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import data, document, lines, talk
from lcmtools.graph.model import Node
from lcmtools.names import Pattern
from lcmtools.observe.describe import listed_node, node_record
from lcmtools.observe.programs import programs

_HEADING = "Programs that are no nodes (seen on the bus):"


@subcommand("list")
@argument("namespace", default="", completer="bus:namespaces")
@option(
    "-a",
    "--all",
    "show_all",
    is_flag=True,
    help="Show host, pid and up-time, hidden nodes, and programs that are no nodes.",
)
@option("-u", "--uri", is_flag=True, help="Print the nodes' addresses, as rosnode list -u.")
@option("-c", "--count-nodes", "count", is_flag=True, help="Print how many nodes there are.")
@option("--wait", type=duration, help="With -a: listen so long for other programs.")
@json_option
@looking_options
def command(
    namespace: str, *, show_all: bool, uri: bool, count: bool, wait: float | None, as_json: bool
) -> None:
    """List the nodes on the bus. A node that was killed or hangs is shown as stale.

    NAMESPACE keeps the nodes that are it or stand below it. In quotes it may be a pattern: * is
    anything but /, ** anything, ? one character. One without / may be a node's last part: "*arm*".

    \b
    Examples:
      lcmtools node list
      lcmtools node list -a /husky0
    """
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
        talk(f"several nodes have the same name: {', '.join(twice)}; lcmtools wtf says more")


def _row(node: Node, now: int) -> str:
    """As rosnode list -a has it, the address first, and what else is known behind the name."""
    up = f"up {_span(node.time_there(now) - node.start_time)}"
    return f"{node.host}:{node.pid} \t{node.name}\t{f'stale: {node.stale}' if node.stale else up}"


def _span(nanoseconds: int) -> str:
    """A time as people say it: 12 s, 3 min, 2.5 h, 4.2 days."""
    seconds = max(0, nanoseconds) / 1e9
    for unit, length in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"
