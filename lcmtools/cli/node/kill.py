"""``lcmtools node kill``."""

import sys

import click

from lcmtools.cli.bus import in_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import asking_options, json_option
from lcmtools.cli.output import write_document, write_lines, write_note
from lcmtools.errors import UsageError
from lcmtools.graph.model import NodeInfo
from lcmtools.observe.node_requests import NodeEnd, end_nodes, node_to_end, nodes_to_end
from lcmtools.text_table import plural


@subcommand("kill", json_option, asking_options)
@examples("node kill simple_controller", "node kill --all --yes")
@argument("nodes", nargs=-1, completer="bus:nodes")
@flag("-a", "--all", "kill_all", help="All nodes, after confirmation.")
@flag("-y", "--yes", help="Do not ask for confirmation.")
@option("--timeout", type=duration, default=3.0, help="Wait this long for the end (else 3s).")
def command(
    nodes: tuple[str, ...], *, kill_all: bool, yes: bool, timeout: float, as_json: bool
) -> int:
    """Ask nodes to shut down, and report the result. The exit code is 1 if one did not.

    NODES are names, or pids or HOST:PID if two nodes have the same name. The node's whole process
    ends cleanly, as by SIGTERM, with exit code 0. Plain LCM programs cannot be ended.
    """
    if kill_all and nodes:
        raise UsageError("--all cannot be used with a node's name", "leave out one of them")
    if not (kill_all or nodes or sys.stdin.isatty()):  # no person can choose from a list
        raise click.MissingParameter(param_hint="'NODES...'", param_type="argument")
    with open_monitor("node_kill") as monitor:
        graph = monitor.settle(foreign=False)
        named = [node_to_end(monitor, graph, in_names(word)) for word in nodes]
        found = list({node.id: node for node in named or nodes_to_end(graph)}.values())
        if not found:
            write_note("no nodes running")
        elif not (nodes or (kill_all and yes)):
            found = _confirmed(found) if kill_all else _chosen(found)
        if found and not as_json:
            several = ["killing:", *(f" * {node.name}" for node in found)]
            write_lines(several if len(found) > 1 else [f"killing {found[0].name}"])
        ends = end_nodes(monitor, found, timeout)
    if as_json:
        write_document([end.to_json() for end in ends])
    elif found:  # as in rosnode kill; with names unless all have ended
        killed = [f"killed {end.node.name}" for end in ends if end.has_ended]
        write_lines(["killed"] if len(killed) == len(ends) else killed)
    return _complain(ends, timeout)


def _confirmed(nodes: list[NodeInfo]) -> list[NodeInfo]:
    if not sys.stdin.isatty():
        what = f"--all would kill {plural(len(nodes), 'node')} and needs confirmation"
        raise UsageError(what, "add --yes")
    write_note("This kills all nodes:")
    for node in nodes:
        write_note(f" * {node.name}")
    if click.confirm("Kill all nodes?", err=True):
        return nodes
    write_note("nothing was killed")
    return []


def _chosen(nodes: list[NodeInfo]) -> list[NodeInfo]:
    """Let the user choose a node from a list, as in rosnode kill."""
    for number, node in enumerate(nodes, 1):
        write_note(f"{number}. {node.name}")
    choice = click.IntRange(1, len(nodes))
    number = click.prompt("Number of the node to kill", type=choice, err=True)
    return [nodes[number - 1]]


def _complain(ends: list[NodeEnd], timeout: float) -> int:
    named = {end.node.name for end in ends}
    for end in ends:
        others = [name for name in end.others if name not in named]
        if not end.has_ended:
            write_note(end.complaint(timeout), "lcmtools node kill")
        elif others:
            write_note(f"ended with {end.node.name}, in the same process: {', '.join(others)}")
    return 0 if all(end.has_ended for end in ends) else 1
