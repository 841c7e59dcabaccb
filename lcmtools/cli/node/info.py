"""``lcmtools node info``: asking, and putting the sections together.

A section is a function that gives lines, and one that gives JSON; ``lcmtools.cli.node.sections``
has those of nodes.
"""

import time

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.describe import node_record
from lcmtools.cli.node import parameters, sections
from lcmtools.cli.node.programs import command as command_of
from lcmtools.cli.node.programs import is_meant, listening, place, program_record, seen_type
from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_monitor
from lcmtools.cli.output import document, lines
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node
from lcmtools.observe.find import find_nodes
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import Program, programs
from lcmtools.publish.parameters import Answers


@click.command("info", context_settings=CONTEXT)
@click.argument("nodes", nargs=-1, required=True, shell_complete=complete("bus:nodes"))
@click.option("-q", "--quiet", is_flag=True, help="Only publications, subscriptions and services.")
@click.option("-a", "--include-hidden", "show_hidden", is_flag=True, help="Show hidden names too.")
@json_option
@bus_options
def command(nodes: tuple[str, ...], *, quiet: bool, show_hidden: bool, as_json: bool) -> None:
    """Show what a node publishes, subscribes to and serves, and the process that it is.

    NODES are names or pids; a program that is no node is found by its pid or its command.

    \b
    Examples:
      lcmtools node info simple_controller
      lcmtools node info /husky0/simple_controller lcm-source
    """  # noqa: D301 - \b is click's mark
    with open_monitor("node_info") as monitor:
        graph = monitor.settle(foreign=False)
        found = [one for word in nodes for one in _find(monitor, graph, word)]
        graph = monitor.graph()
    asked = [] if quiet and not as_json else [one for one in found if isinstance(one, Node)]
    known = parameters.ask(asked, monitor.url)
    now = time.time_ns()
    if as_json:
        document([_record(one, graph, now, known) for one in found])
        return
    for one in found:
        if isinstance(one, Node):
            rows = [
                "-" * 80,
                f"Node [{one.name}]",
                *sections.roles(one, show_hidden=show_hidden),
                "",
            ]
            lines(rows if quiet else [*rows, *_about(one, graph, now, known)])
        else:
            lines(_program_text(one, now, quiet=quiet))


def _find(monitor: BusMonitor, graph: Graph, word: str) -> list[Node] | list[Program]:
    """The nodes that a word means, else the programs.

    Raises:
        UsageError: The word is empty.
        LcmtoolsError: There is no such node and no such program.
    """
    try:
        return find_nodes(graph, word)
    except UsageError:
        raise
    except LcmtoolsError as unknown:
        seen = programs(monitor.settle(), monitor.url)
        if found := [program for program in seen if is_meant(program, word)]:
            return found
        raise unknown  # noqa: TRY201 - the first error, not that of looking further


def _about(node: Node, graph: Graph, now: int, known: Answers) -> list[str]:
    """What rosnode info prints after it has contacted a node, and more."""
    return [
        *sections.process(node, now),
        *parameters.text(node, known),
        *sections.counters(node),
        *sections.connections(node, graph),
        "",
    ]


def _program_text(program: Program, now: int, *, quiet: bool) -> list[str]:
    """The same for a program that is no node, as far as it is known."""
    rows = ["-" * 80, f"Program [{command_of(program)}] (no node: seen on the bus only)"]
    published = {seen.channel: f" * {seen.channel} [{seen_type(seen)}]" for seen in program.traffic}
    rows += ["Publications: ", *published.values()] if published else ["Publications: none seen"]
    hears = {True: "on channels that LCM does not tell", False: "None", None: "not known"}
    rows += ["", f"Subscriptions: {hears[program.listens]}", "", ""]
    if not quiet:
        rows += [f"Host: {place(program).rpartition(':')[0]}"]
        if program.process:
            rows += [f"Pid: {program.process.pid}", f"Command: {program.process.command}"]
            rows += sections.usage(program.process.pid, now)
        rows += listening(program)
        rows += [f"Ports: {', '.join(map(str, program.ports)) or 'none seen'}", ""]
    return rows


def _record(one: Node | Program, graph: Graph, now: int, known: Answers) -> dict[str, object]:
    if isinstance(one, Program):
        return program_record(one)
    return {
        **node_record(one),
        **sections.record(one, graph, now),
        **parameters.record(one, known),
    }
