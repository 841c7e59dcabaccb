"""Common parts of the ``param`` commands: finding nodes, and reporting missing answers."""

from collections.abc import Sequence

from lcmtools.cli import bus, options
from lcmtools.cli.bus import in_names, notify
from lcmtools.errors import ServiceError, ServiceTimeout
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.publish.remote_parameters import (
    ParameterClient,
    ParameterTarget,
    find_target,
    nodes_with_parameters,
)

timeout_option = options.timeout_option(3.0)


def look(timeout: float) -> tuple[Graph, ParameterClient]:
    """Return the nodes on the bus, and a client for their parameters."""
    graph, url = bus.look("param")
    return graph, ParameterClient(url, timeout)


def named(graph: Graph, node: str, *name: str) -> ParameterTarget:
    """Return the node, parameter or namespace that the command line names."""
    return find_target(graph, [in_names(node), *filter(None, name)])


def living_nodes(graph: Graph, *, show_all: bool) -> list[Node]:
    """Return the nodes with parameters, and write a note for those that run but do not answer."""
    for node in graph.nodes:
        if node.stale is Staleness.HANGS and not (node.tool or node.is_hidden):
            notify(f"{node.name} {node.stale}")
    known = nodes_with_parameters(graph)
    return [node for node in known if not node.stale and (show_all or not node.is_hidden)]


def complain_of(errors: Sequence[ServiceError]) -> int:
    """Write which nodes did not answer, and return the exit code."""
    for error in errors:
        notify(f"{error}")
    return ServiceTimeout.exit_code if errors else 0
