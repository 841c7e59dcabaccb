"""``lcmtools node info``."""

import time

import click

from lcmtools.cli.describe import node_record
from lcmtools.cli.find import find_node
from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch
from lcmtools.cli.output import document, lines
from lcmtools.graph.model import Endpoint, Graph, Node, Role


@click.command("info", context_settings=CONTEXT)
@click.argument("nodes", nargs=-1, required=True)
@json_option
@bus_options
def command(nodes: tuple[str, ...], *, as_json: bool) -> None:
    """Show what a node publishes, subscribes to and serves, and the process that it is.

    \b
    Examples:
      lcmtools node info simple_controller
      lcmtools node info /husky0/simple_controller /morse
    """  # noqa: D301 - \b is click's mark
    with open_watch("node_info") as watch:
        graph = watch.settle(foreign=False)
    found = [find_node(graph, name) for name in nodes]
    if as_json:
        document([_record(node) for node in found])
        return
    for node in found:
        lines(_text(node, graph))


def _text(node: Node, graph: Graph) -> list[str]:
    """As rosnode info prints it."""
    rows = ["-" * 80, f"Node [{node.name}]"]
    rows += [*_section("Publications", node.having(Role.PUBLISHER)), ""]
    rows += [*_section("Subscriptions", node.having(Role.SUBSCRIBER)), ""]
    rows += [*_section("Services", node.having(Role.SERVICE)), "", ""]
    rows.append(f"Host: {node.host}")
    rows.append(f"Pid: {node.pid}")
    rows.append(f"Command: {node.command}")
    if node.stale:
        rows.append(f"Stale: {node.stale}")
    else:
        rows.append(f"Up for: {(time.time_ns() - node.start_time) / 1e9:.0f} s")
    rows += ["Connections:", *_connections(node, graph), ""]
    return rows


def _section(title: str, endpoints: tuple[Endpoint, ...]) -> list[str]:
    if not endpoints:
        return [f"{title}: None"]
    return [f"{title}: ", *(f" * {_endpoint_text(endpoint)}" for endpoint in endpoints)]


def _endpoint_text(endpoint: Endpoint) -> str:
    if endpoint.role is Role.SERVICE:
        return endpoint.topic
    types = " or ".join(endpoint.types) or "unknown type"
    drops = f", {endpoint.drops} dropped" if endpoint.drops else ""
    return f"{endpoint.topic} [{types}]{drops}"


def _connections(node: Node, graph: Graph) -> list[str]:
    """The other nodes that this one's topics lead to."""
    rows = []
    for endpoint in (*node.having(Role.PUBLISHER), *node.having(Role.SUBSCRIBER)):
        topic = graph.topic(endpoint.topic)
        outbound = endpoint.role is Role.PUBLISHER
        for peer, _ in topic.subscribers if outbound else topic.publishers:
            if peer.id != node.id:
                direction = "to" if outbound else "from"
                rows += [f" * topic: {endpoint.topic}", f"    * {direction}: {peer.name}"]
    return rows or [" * none"]


def _record(node: Node) -> dict[str, object]:
    return {
        **node_record(node),
        "publications": [_endpoint_record(e) for e in node.having(Role.PUBLISHER)],
        "subscriptions": [_endpoint_record(e) for e in node.having(Role.SUBSCRIBER)],
        "services": [_endpoint_record(e) for e in node.having(Role.SERVICE)],
    }


def _endpoint_record(endpoint: Endpoint) -> dict[str, object]:
    return {
        "topic": endpoint.topic,
        "types": list(endpoint.types),
        "depth": endpoint.depth,
        "messages": endpoint.messages,
        "bytes": endpoint.bytes,
        "drops": endpoint.drops,
    }
