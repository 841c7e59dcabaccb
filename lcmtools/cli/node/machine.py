"""``lcmtools node machine``."""

import socket

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.describe import listed_node
from lcmtools.cli.options import CONTEXT, all_option, bus_options, json_option, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Node
from lcmtools.names import did_you_mean
from lcmtools.observe.computers import Computers


@click.command("machine", context_settings=CONTEXT)
@click.argument("host", required=False, shell_complete=complete("bus:hosts"))
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
    """  # noqa: D301 - \b is click's mark
    with open_monitor("node_machine") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    nodes = [node for node in graph.nodes if show_all or not node.is_hidden]
    computers = Computers(graph.nodes)
    hosts = sorted({computers.of(node) for node in nodes})
    found = nodes if host is None else _nodes_of(host, nodes, computers)
    if as_json:
        names = {
            name: [node.name for node in found if computers.of(node) == name] for name in hosts
        }
        document([{"host": name, "nodes": of} for name, of in names.items() if of])
    else:
        lines(hosts if host is None else map(listed_node, found))
    if not nodes:
        talk(f"no nodes on {url}")


def _nodes_of(host: str, nodes: list[Node], computers: Computers) -> list[Node]:
    """The nodes of a computer, by its name or its address.

    Raises:
        LcmtoolsError: No node runs on it; with what may have been meant.
    """
    own = socket.gethostname()
    wanted = own if host in ("localhost", "127.0.0.1") else host
    found = [node for node in nodes if wanted in _names(node, computers)]
    if not found:
        hint = did_you_mean(host, {node.host for node in nodes})
        raise LcmtoolsError(
            f"no node runs on machine {host}", hint or "lcmtools node machine lists the machines"
        )
    return found


def _names(node: Node, computers: Computers) -> tuple[str, ...]:
    """What the computer of a node may be called."""
    address = (node.sender.address,) if node.sender else ()
    return (node.host, computers.of(node), *address)
