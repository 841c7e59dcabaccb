"""``lcmtools node list``."""

import contextlib

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.describe import listed_node, node_record
from lcmtools.cli.node.programs import HEADING, listed_program, program_record
from lcmtools.cli.options import CONTEXT, bus_options, duration, json_option, open_monitor
from lcmtools.cli.output import data, document, lines, talk
from lcmtools.graph.model import Graph, Node
from lcmtools.observe.find import below_or_like
from lcmtools.observe.programs import Program, programs


@click.command("list", context_settings=CONTEXT)
@click.argument("namespace", default="", shell_complete=complete("bus:namespaces"))
@click.option(
    "-a",
    "--all",
    "show_all",
    is_flag=True,
    help="Show host, pid and up-time, hidden nodes, and programs that are no nodes.",
)
@click.option("-u", "--uri", is_flag=True, help="Print the nodes' addresses, as rosnode list -u.")
@click.option("-c", "--count-nodes", "count", is_flag=True, help="Print how many nodes there are.")
@click.option("--wait", type=duration, help="With -a: listen so long for other programs.")
@json_option
@bus_options
def command(
    namespace: str, *, show_all: bool, uri: bool, count: bool, wait: float | None, as_json: bool
) -> None:
    """List the nodes on the bus. A node that was killed or hangs is shown as stale.

    NAMESPACE keeps the nodes that are it or stand below it, or that are like a pattern ("*arm*").

    \b
    Examples:
      lcmtools node list
      lcmtools node list -a /husky0
    """  # noqa: D301 - \b is click's mark
    with open_monitor("node_list") as monitor:
        graph = monitor.settle(foreign=show_all and wait is None)
        if show_all and wait is not None:
            with contextlib.suppress(EOFError):  # a log has ended
                for _ in monitor.packets(wait):
                    pass
            graph = monitor.graph()
        url = monitor.url
    nodes = _nodes(graph, namespace, show_all=show_all)
    others = programs(graph, url) if show_all and not namespace else []
    if as_json:
        document([*map(node_record, nodes), *map(program_record, others)])
    elif count:
        data(str(len(nodes)))
    elif uri:
        lines(_address(node) for node in nodes)
    elif show_all:
        lines([*(_row(node, graph.time) for node in nodes), *_other_rows(others)])
    else:
        lines(map(listed_node, nodes))
    if not nodes and not count:
        talk(f"no nodes{f' in {namespace}' if namespace else ''} on {url}")
    _warn_of_equal_names(nodes)


def _nodes(graph: Graph, wanted: str, *, show_all: bool) -> list[Node]:
    return [
        node
        for node in graph.nodes
        if (show_all or not node.is_hidden) and below_or_like(node.name, wanted)
    ]


def _row(node: Node, now: int) -> str:
    """As rosnode list -a has it, the address first, and what else is known behind the name."""
    up = f"up {_span(node.time_there(now) - node.start_time)}"
    return f"{node.host}:{node.pid} \t{node.name}\t{f'stale: {node.stale}' if node.stale else up}"


def _address(node: Node) -> str:
    return f"udp://{node.sender}/" if node.sender else "unknown address"


def _other_rows(others: list[Program]) -> list[str]:
    if not others:
        return []
    return ["", HEADING, *(row for program in others for row in listed_program(program))]


def _span(nanoseconds: int) -> str:
    """A time as people say it: 12 s, 3 min, 2.5 h, 4.2 days."""
    seconds = max(0, nanoseconds) / 1e9
    for unit, length in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{seconds:.0f} s"


def _warn_of_equal_names(nodes: list[Node]) -> None:
    names = [node.name for node in nodes if not node.stale]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        talk(f"several nodes have the same name: {', '.join(twice)}; lcmtools wtf says more")
