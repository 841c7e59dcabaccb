"""``lcmtools launch``."""

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.launch.screen import Screen
from lcmtools.cli.launch.shown import (
    argument_record,
    argument_rows,
    node_record,
    node_rows,
    outcome_rows,
    parameter_record,
    parameter_rows,
)
from lcmtools.cli.launch.typed import Typed, read_words
from lcmtools.cli.launch.waiting import wait_for_bus
from lcmtools.cli.options import CONTEXT, bus_options, chosen_url, duration, json_option
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import UsageError
from lcmtools.launch.arguments import arguments_of
from lcmtools.launch.file import STANDARD_INPUT, File, read_file, read_standard_input
from lcmtools.launch.logs import make_folder
from lcmtools.launch.packages import find_files, lab_files
from lcmtools.launch.plan import NodePlan, Output, Plan
from lcmtools.launch.reading import Given, make_plan
from lcmtools.launch.supervisor import Supervisor
from lcmtools.names import base_name_of, did_you_mean
from lcmtools.processes.child import StopTimeouts
from lcmtools.settings import usual_namespace

_QUESTIONS = (
    *("nodes", "args", "find-node", "show-args", "dump-params", "files", "dry-run", "list"),
)


@click.command("launch", context_settings=CONTEXT)
@click.argument(
    "words",
    nargs=-1,
    metavar="[PACKAGE] FILE... [NAME:=VALUE]... [__ns:=NAMESPACE]",
    shell_complete=complete("programs:launch_words"),
)
@click.option(
    "--ns",
    metavar="NAMESPACE",
    help="The same as __ns:=NAMESPACE.",
    shell_complete=complete("bus:namespaces"),
)
@click.option("--nodes", "question", flag_value="nodes", help="Only list the nodes' full names.")
@click.option(
    "--args",
    "node",
    metavar="NODE",
    help="Only print a node's command line.",
    shell_complete=complete("programs:launched_nodes"),
)
@click.option(
    "--find-node",
    "sought",
    metavar="NODE",
    help="Only print where a node is written.",
    shell_complete=complete("programs:launched_nodes"),
)
@click.option(
    "--show-args",
    "--ros-args",
    "question",
    flag_value="show-args",
    help="Only list the file's arguments.",
)
@click.option(
    "--dump-params",
    "question",
    flag_value="dump-params",
    help="Only print the nodes' parameters, as param dump does.",
)
@click.option("--files", "question", flag_value="files", help="Only list the files it reads.")
@click.option("--dry-run", "question", flag_value="dry-run", help="Only print all command lines.")
@click.option("-l", "--list", "question", flag_value="list", help="List the labs' launch files.")
@click.option("--screen", "output", flag_value="screen", help="Show the lines of all nodes.")
@click.option(
    "--log", "output", flag_value="log", help="Show warnings and errors only; the rest is in files."
)
@click.option("--wait", is_flag=True, help="Wait until the bus works, and start then.")
@click.option("--sigint-timeout", type=duration, default=15.0, help="From SIGINT on (else 15s).")
@click.option("--sigterm-timeout", type=duration, default=2.0, help="From SIGTERM on (else 2s).")
@json_option
@bus_options
def command(  # noqa: PLR0913 - one for each option
    words: tuple[str, ...],
    *,
    ns: str | None,
    question: str | None,
    node: str | None,
    sought: str | None,
    output: str | None,
    wait: bool,
    sigint_timeout: float,
    sigterm_timeout: float,
    as_json: bool,
) -> int:
    """Run the nodes of a launch file, and look after them until they end.

    FILE is YAML, or XML as ROS 1 has it; - is standard input. NAME:=VALUE gives it an argument,
    __ns:=/husky0 puts all of it into a namespace. Ctrl-C asks the nodes to end, in order: SIGINT,
    then SIGTERM, then SIGKILL. Log files are in ~/.local/state/lcmtools/log/latest.

    \b
    A launch file:
      args: {robot: husky0}
      nodes:
        - run: simple_controller        # as after lcmtools run
          ns: $(arg robot)
          remap: {controlled_velocity: velocity_cmd}
          param: {kp: 0.5}
          respawn: true                 # also: name, args, env, output, required, if, unless

    \b
    Exit codes: 0 all ended well, or were asked to; 1 a node failed; 2 the file is wrong.

    \b
    Examples:
      lcmtools launch simple_controller.launch __ns:=/husky0
      lcmtools launch air_lab0 simple_controller.launch --dry-run
      lcmtools launch robot.yaml robot:=husky1
    """  # noqa: D301 - \b is click's mark
    named = {"args": node, "find-node": sought}
    asked = next((name for name, value in named.items() if value is not None), question)
    if as_json and not asked:
        raise UsageError("--json needs a question", f"one of --{', --'.join(_QUESTIONS)}")
    if asked == "list":
        _list(as_json=as_json)
        return 0
    typed = read_words(words, ns, usual_namespace(os.environ))
    files = _read(typed)
    if asked == "show-args":
        arguments = [argument for file in files for argument in arguments_of(file.root)]
        _print(map(argument_record, arguments), argument_rows(arguments), as_json=as_json)
        return 0
    plan = make_plan(files, Given(typed.arguments, typed.namespace, os.environ))
    for note in plan.notes:
        talk(f"lcmtools launch: {note}")
    if asked:
        _answer(asked, plan, named.get(asked) or "", as_json=as_json)
        return 0
    if wait:
        wait_for_bus(chosen_url())
    return _run(plan, output, StopTimeouts(sigint_timeout, sigterm_timeout))


def _read(typed: Typed) -> list[File]:
    if typed.places == (STANDARD_INPUT,):
        return [read_standard_input()]
    return [read_file(path) for path in find_files(typed.places)]


def _answer(question: str, plan: Plan, name: str, *, as_json: bool) -> None:
    names = [node.name for node in plan.nodes]
    if question == "nodes":
        _print(names, names, as_json=as_json)
    elif question == "files":
        _print(plan.files, plan.files, as_json=as_json)
    elif question == "args":
        node = _find(name, plan.nodes)
        document(node_record(node)) if as_json else lines([node.command_line()])
    elif question == "find-node":
        node = _find(name, plan.nodes)
        document({"node": node.name, "place": node.place}) if as_json else lines([node.place])
    elif question == "dump-params":
        rows = (row for node in plan.nodes for row in parameter_rows(node))
        _print(map(parameter_record, plan.nodes), rows, as_json=as_json)
    else:
        rows = (row for node in plan.nodes for row in node_rows(node))
        _print(map(node_record, plan.nodes), rows, as_json=as_json)


def _find(name: str, nodes: Sequence[NodePlan]) -> NodePlan:
    """A node by its full name, or by the last part of it where that is enough."""
    full = [node for node in nodes if node.name == f"/{name.strip('/')}"]
    found = full or [node for node in nodes if base_name_of(node.name) == name]
    if len(found) == 1:
        return found[0]
    if found:
        names = ", ".join(node.name for node in found)
        raise UsageError(f"several nodes are called '{name}'", f"write one of {names}")
    known = [node.name for node in nodes]
    hint = did_you_mean(name, known) or f"there are {', '.join(known) or 'none'}"
    raise UsageError(f"there is no node '{name}' in the launch file", hint)


def _list(*, as_json: bool) -> None:
    known = lab_files()
    records = [{"package": package, "file": name} for package, name in known]
    _print(records, (f"{package} {name}" for package, name in known), as_json=as_json)


def _print(records: Iterable[object], rows: Iterable[str], *, as_json: bool) -> None:
    document(list(records)) if as_json else lines(rows)


def _run(plan: Plan, output: str | None, timeouts: StopTimeouts) -> int:
    """Run the nodes; the exit code."""
    if not plan.nodes:
        raise UsageError(
            "the launch file has no nodes to run", "lcmtools launch --dry-run shows it"
        )
    nodes = [_with_bus(_with_output(node, output)) for node in plan.nodes]
    url = chosen_url()
    # a node's print comes at once, as it would on a terminal
    environment = {"PYTHONUNBUFFERED": "1", **os.environ, "LCM_DEFAULT_URL": str(url)}
    folder = make_folder(os.environ)
    hidden = any(node.output is Output.LOG for node in nodes)
    talk(f"log files: {folder}{'; --screen shows all lines here too' if hidden else ''}")
    outcomes = Supervisor(nodes, environment, folder, Screen(), timeouts).run()
    sys.stdout.flush()
    talk("\n".join(outcome_rows(outcomes)))
    return int(any(outcome.has_failed for outcome in outcomes))


def _with_output(node: NodePlan, output: str | None) -> NodePlan:
    """A node whose lines go where the command line says."""
    if output is None:
        return node
    return replace(node, output=Output.BOTH if output == "screen" else Output.LOG)


def _with_bus(node: NodePlan) -> NodePlan:
    """A node whose file says another domain, which the bus of the others would win over."""
    domain = node.environment.get("LCMTOOLS_DOMAIN")
    if not domain or "LCM_DEFAULT_URL" in node.environment:
        return node
    from lcmtools.bus.url import domain_url

    url = str(domain_url(domain, f"{node.place}: LCMTOOLS_DOMAIN"))
    return replace(node, environment={**node.environment, "LCM_DEFAULT_URL": url})
