"""``lcmtools node info``."""

import time

from lcmtools.cli.bus import in_names, notify, open_monitor
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import write_document, write_lines
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, NodeInfo
from lcmtools.observe.node_requests import find_programs
from lcmtools.observe.reading.find import find_nodes
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import Program
from lcmtools.observe.reports import node_report, program_report
from lcmtools.publish.parameter_report import block, values
from lcmtools.publish.remote_parameters import Answers, ParameterClient, has_parameters

_TIMEOUT = 0.5  # [s] for parameters: the rest of the answer does not wait for a busy node


@subcommand("info", json_option, looking_options)
@examples("node info simple_controller", "node info /husky0/simple_controller lcm-source")
@argument("nodes", nargs=-1, required=True, completer="bus:nodes")
@flag("-q", "--quiet", help="Only publications, subscriptions and services.")
@flag("-a", "--include-hidden", "show_hidden", help="Show hidden names too.")
def command(nodes: tuple[str, ...], *, quiet: bool, show_hidden: bool, as_json: bool) -> None:
    """Show a node's publications, subscriptions, services and process.

    NODES are names or pids; a plain LCM program is found by its pid or command.
    """
    with open_monitor("node_info") as monitor:
        graph = monitor.settle(foreign=False)
        found = [one for word in nodes for one in _find(monitor, graph, word)]
        graph = monitor.graph()
    nodes_found = (
        [] if quiet and not as_json else [one for one in found if isinstance(one, NodeInfo)]
    )
    able = [node for node in nodes_found if _can_be_asked(node)]
    known = ParameterClient(monitor.url, _TIMEOUT).get_all(able)[0]
    now = graph.time if monitor.is_log else time.time_ns()
    if as_json:
        write_document([_to_json(one, graph, known, now) for one in found])
        return
    for one in found:
        if isinstance(one, Program):
            write_lines(program_report.to_lines(one, now, quiet=quiet))
            continue
        if quiet:
            write_lines(node_report.roles(one, show_hidden=show_hidden))
            if one.stale:
                notify(f"{one.name} is stale: {one.stale}")
            continue
        parameters = _parameters(one, known)
        write_lines(node_report.to_lines(one, graph, now, parameters, show_hidden=show_hidden))


def _find(monitor: BusMonitor, graph: Graph, word: str) -> list[NodeInfo] | list[Program]:
    try:
        return find_nodes(graph, in_names(word))
    except UsageError:
        raise
    except LcmtoolsError:
        if found := find_programs(monitor, word):
            return found
        raise


def _can_be_asked(node: NodeInfo) -> bool:
    return has_parameters(node) and not (node.stale or node.is_recorded)


def _parameters(node: NodeInfo, known: Answers) -> list[str]:
    if not _can_be_asked(node):
        return []
    if node.name not in known:
        return ["Parameters: (did not answer)"]
    return ["Parameters: ", *block(known[node.name], " * ")]


def _to_json(one: NodeInfo | Program, graph: Graph, known: Answers, now: int) -> dict[str, object]:
    if isinstance(one, Program):
        return program_report.to_json(one)
    parameters = known.get(one.name)
    known_values = None if parameters is None else values(parameters)
    return {**node_report.to_json(one, graph, now), "parameters": known_values}
