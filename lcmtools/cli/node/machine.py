"""``lcmtools node machine``."""

import socket

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import all_option, bus_options, json_option, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Node
from lcmtools.names import did_you_mean
from lcmtools.observe.computers import Computers
from lcmtools.observe.describe import listed_node


@subcommand("machine")
@argument("host", required=False, completer="bus:hosts")
@all_option
@json_option
@bus_options
def command(host: str | None, *, show_all: bool, as_json: bool) -> None:
    """List the computers that nodes run on, or the nodes of one computer.

    HOST is its name or its address.

    \b
    Examples:
      lcmtools node machine
      lcmtools node machine husky0-pc
    """
    with open_monitor("node_machine") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    nodes = [node for node in graph.nodes if show_all or not node.is_hidden]
    computers = Computers(graph.nodes)
    names: dict[str, list[Node]] = {name: [] for name in sorted(set(map(computers.of, nodes)))}
    found = nodes if host is None else _nodes_of(host, nodes, computers)
    for node in found:
        names[computers.of(node)].append(node)
    if as_json:
        document([{"host": h, "nodes": [n.name for n in of]} for h, of in names.items() if of])
    else:
        lines(names if host is None else map(listed_node, found))
    if not nodes:
        talk(f"no nodes on {url}")


def _nodes_of(host: str, nodes: list[Node], computers: Computers) -> list[Node]:
    """The nodes of a computer, by its name or its address.

    Raises:
        LcmtoolsError: No node runs on it; with what may have been meant.
    """
    wanted = socket.gethostname() if host in ("localhost", "127.0.0.1") else host
    found = [
        node
        for node in nodes
        if wanted in (node.host, computers.of(node), node.sender and node.sender.address)
    ]
    if not found:
        hint = did_you_mean(host, {node.host for node in nodes})
        what = f"no node runs on machine {host}"
        raise LcmtoolsError(what, hint or "lcmtools node machine lists the machines")
    return found
