"""``lcmtools node kill``."""

import sys

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.describe import host_text
from lcmtools.cli.node.ending import Ending, end_nodes, place_of
from lcmtools.cli.node.programs import command as command_of
from lcmtools.cli.node.programs import is_meant
from lcmtools.cli.options import CONTEXT, bus_options, duration, json_option, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.observe.find import find_nodes
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import programs


@click.command("kill", context_settings=CONTEXT)
@click.argument("nodes", nargs=-1, shell_complete=complete("bus:nodes"))
@click.option("-a", "--all", "kill_all", is_flag=True, help="All nodes; asks first.")
@click.option("-y", "--yes", is_flag=True, help="Do not ask.")
@click.option("--timeout", type=duration, default=3.0, help="Wait so long for the end (else 3s).")
@json_option
@bus_options
def command(
    nodes: tuple[str, ...], *, kill_all: bool, yes: bool, timeout: float, as_json: bool
) -> int:
    """Ask nodes to shut down, and say whether they did. Exits with 1 if one did not.

    NODES are names, or where two nodes have one name pids, or HOST:PID. A node's whole process
    ends, as by SIGTERM: with a goodbye, and exit code 0. Programs that are no nodes cannot be
    asked.

    \b
    Examples:
      lcmtools node kill simple_controller
      lcmtools node kill --all --yes
    """  # noqa: D301 - \b is click's mark
    if kill_all and nodes:
        raise UsageError("--all takes no node's name", "leave out one of them")
    if not (kill_all or nodes or sys.stdin.isatty()):  # there is nobody to choose from a list
        raise click.MissingParameter(param_hint="'NODES...'", param_type="argument")
    with open_monitor("node_kill") as monitor:
        graph = monitor.settle(foreign=False)
        found = _everybody(graph) if kill_all or not nodes else _named(monitor, graph, nodes)
        if not found:
            talk("no nodes running")
        elif not nodes:
            found = _agreed(found, yes=yes) if kill_all else _chosen(found)
        if not as_json and found:
            lines(_announcing(found))
        endings = end_nodes(monitor, found, timeout)
    if as_json:
        document([_record(ending) for ending in endings])
    elif found:
        lines(_said(endings))
    return _complain(endings, timeout)


def _everybody(graph: Graph) -> list[Node]:
    """All nodes that run and are no commands that look."""
    return [
        node
        for node in graph.nodes
        if not (node.is_hidden or node.tool or node.stale is Staleness.ENDED)
    ]


def _named(monitor: BusMonitor, graph: Graph, words: tuple[str, ...]) -> list[Node]:
    """The nodes that are meant, each once; none is asked unless all are found."""
    return list({node.id: node for word in words for node in [_one(monitor, graph, word)]}.values())


def _one(monitor: BusMonitor, graph: Graph, word: str) -> Node:
    try:
        found = find_nodes(graph, word)
    except UsageError:
        raise
    except LcmtoolsError:
        _explain_program(monitor, word)
        raise
    if len({place_of(node) for node in found}) > 1:
        what = "pid" if word.isdecimal() else "name"
        raise LcmtoolsError(f"{len(found)} nodes have the {what} {word}", _distinction(found))
    if found[0].stale is Staleness.ENDED:
        raise LcmtoolsError(
            f"{found[0].name} has ended already, without saying goodbye",
            "lcmtools node cleanup forgets it",
        )
    return found[0]


def _distinction(nodes: list[Node]) -> str:
    """What to write for one of several nodes: its pid, its computer too where pids are the same."""
    if len({node.pid for node in nodes}) == len(nodes):
        return f"write a pid: {', '.join(f'{node.pid} on {host_text(node)}' for node in nodes)}"
    has_names = len({node.host for node in nodes}) > 1
    places = [place_of(node) for node in nodes]
    return "write HOST:PID: " + ", ".join(
        f"{host if has_names else address}:{pid}" for host, address, pid in places
    )


def _explain_program(monitor: BusMonitor, word: str) -> None:
    """Raise what to type where a word means a program that is no node."""
    others = programs(monitor.settle(), monitor.url)
    meant = next((p for p in others if is_meant(p, word)), None)
    if meant and meant.process is None:
        raise LcmtoolsError(
            f"what sends from {word} is no node and cannot be asked", "end it on its computer"
        )
    if meant and meant.process:
        raise LcmtoolsError(
            f"{command_of(meant)} (pid {meant.process.pid}) is no node and cannot be asked",
            f"type: kill {meant.process.pid}",
        )


def _agreed(nodes: list[Node], *, yes: bool) -> list[Node]:
    """The nodes, if the person says so; none otherwise.

    Raises:
        UsageError: There is nobody to ask.
    """
    if yes:
        return nodes
    if not sys.stdin.isatty():
        raise UsageError(
            f"--all would kill {len(nodes)} nodes, and there is nobody to ask", "add --yes"
        )
    talk("\n".join(["This kills all nodes:", *(f" * {node.name}" for node in nodes)]))
    if click.confirm("Kill all nodes?", err=True):
        return nodes
    talk("nothing was killed")
    return []


def _chosen(nodes: list[Node]) -> list[Node]:
    """The node that a person chooses from a list, as rosnode kill has it."""
    talk("\n".join(f"{number}. {node.name}" for number, node in enumerate(nodes, 1)))
    number = click.prompt(
        "Number of the node to kill", type=click.IntRange(1, len(nodes)), err=True
    )
    return [nodes[number - 1]]


def _announcing(nodes: list[Node]) -> list[str]:
    if len(nodes) == 1:
        return [f"killing {nodes[0].name}"]
    return ["killing:", *(f" * {node.name}" for node in nodes)]


def _said(endings: list[Ending]) -> list[str]:
    """As rosnode kill says it; which ones where not all have ended."""
    if all(ending.ended for ending in endings):
        return ["killed"]
    return [f"killed {ending.node.name}" for ending in endings if ending.ended]


def _complain(endings: list[Ending], timeout: float) -> int:
    """Say what else ended and what did not; the exit code."""
    named = {ending.node.name for ending in endings}
    for ending in endings:
        if ending.ended and (others := [name for name in ending.others if name not in named]):
            talk(f"ended with {ending.node.name}, in the same process: {', '.join(others)}")
        elif not ending.ended:
            what, hint = ending.complaint(timeout)
            talk(f"{what}; {hint}", "lcmtools node kill")
    return 0 if all(ending.ended for ending in endings) else 1


def _record(ending: Ending) -> dict[str, object]:
    return {
        "node": ending.node.name,
        "host": ending.node.host,
        "pid": ending.node.pid,
        "heard": ending.heard or ending.ended,
        "ended": ending.ended,
        "ended_with_it": list(ending.others) if ending.ended else [],
    }
