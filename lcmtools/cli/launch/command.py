"""``lcmtools launch``."""

import os
import sys
from dataclasses import replace

from lcmtools.bus.preflight import wait_for_bus
from lcmtools.bus.url import domain_url
from lcmtools.cli.declare import argument, duration, option, subcommand
from lcmtools.cli.launch.answers import (
    PLAN_ANSWERS,
    arguments_answer,
    list_answer,
    outcome_rows,
)
from lcmtools.cli.launch.screen import Screen
from lcmtools.cli.options import bus_options, chosen_url, json_option
from lcmtools.cli.output import show, talk
from lcmtools.errors import UsageError
from lcmtools.launch.command_line import read_words
from lcmtools.launch.file import STANDARD_INPUT, read_file, read_standard_input
from lcmtools.launch.logs import make_folder
from lcmtools.launch.packages import find_files
from lcmtools.launch.plan import NodePlan, Output, Plan
from lcmtools.launch.reading import Given, make_plan
from lcmtools.launch.supervisor import Supervisor
from lcmtools.processes.child import StopTimeouts
from lcmtools.settings import usual_namespace

_QUESTIONS = (
    *("nodes", "args", "find-node", "show-args", "dump-params", "files", "dry-run", "list"),
)


@subcommand("launch")
@argument(
    "words",
    nargs=-1,
    metavar="[PACKAGE] FILE... [NAME:=VALUE]... [__ns:=NAMESPACE]",
    completer="programs:launch_words",
)
@option(
    "--ns", metavar="NAMESPACE", help="The same as __ns:=NAMESPACE.", completer="bus:namespaces"
)
@option("--nodes", "question", flag_value="nodes", help="Only list the nodes' full names.")
@option(
    "--args",
    "node",
    metavar="NODE",
    help="Only print a node's command line.",
    completer="programs:launched_nodes",
)
@option(
    "--find-node",
    "sought",
    metavar="NODE",
    help="Only print the line that defines a node.",
    completer="programs:launched_nodes",
)
@option(
    "--show-args",
    "--ros-args",
    "question",
    flag_value="show-args",
    help="Only list the file's arguments.",
)
@option(
    "--dump-params",
    "question",
    flag_value="dump-params",
    help="Only print the nodes' parameters, as param dump does.",
)
@option("--files", "question", flag_value="files", help="Only list the files that are read.")
@option("--dry-run", "question", flag_value="dry-run", help="Only print all command lines.")
@option("-l", "--list", "question", flag_value="list", help="List the labs' launch files.")
@option("--screen", "output", flag_value="screen", help="Show the output of all nodes.")
@option("--log", "output", flag_value="log", help="Show warnings and errors only; log the rest.")
@option("--wait", is_flag=True, help="Wait for a working bus before starting.")
@option("--sigint-timeout", type=duration, default=15.0, help="Time after SIGINT (else 15s).")
@option("--sigterm-timeout", type=duration, default=2.0, help="Time after SIGTERM (else 2s).")
@json_option
@bus_options
def command(
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
    """Run and supervise the nodes of a launch file.

    FILE is YAML or ROS 1 XML; - is standard input. NAME:=VALUE sets an argument, __ns:=/husky0 puts
    all nodes into a namespace. Ctrl-C ends the nodes by SIGINT, then SIGTERM, then SIGKILL. Log
    files are in ~/.local/state/lcmtools/log/latest.

    \b
    A launch file:
      args: {robot: husky0}
      nodes:
        - run: simple_controller        # as in lcmtools run
          ns: $(arg robot)
          remap: {controlled_velocity: velocity_cmd}
          param: {kp: 0.5}
          respawn: true                 # also: name, args, env, output, required, if, unless

    \b
    Exit codes: 0 all nodes ended normally or on request; 1 a node failed; 2 the file is invalid.

    \b
    Examples:
      lcmtools launch simple_controller.launch __ns:=/husky0
      lcmtools launch air_lab0 simple_controller.launch --dry-run
      lcmtools launch robot.yaml robot:=husky1
    """
    named = {"args": node, "find-node": sought}
    query = next((name for name, value in named.items() if value is not None), question)
    if as_json and not query:
        raise UsageError("--json needs a question", f"one of --{', --'.join(_QUESTIONS)}")
    if query == "list":
        show(*list_answer(), as_json=as_json)
        return 0
    typed = read_words(words, ns, usual_namespace(os.environ))
    is_piped = typed.places == (STANDARD_INPUT,)
    files = [read_standard_input()] if is_piped else list(map(read_file, find_files(typed.places)))
    if query == "show-args":
        show(*arguments_answer(files), as_json=as_json)
        return 0
    plan = make_plan(files, Given(typed.arguments, typed.namespace, os.environ))
    for note in plan.notes:
        talk(f"lcmtools launch: {note}")
    if query:
        show(*PLAN_ANSWERS[query](plan, named.get(query) or ""), as_json=as_json)
        return 0
    if wait:
        wait_for_bus(chosen_url(), lambda text: talk(f"lcmtools launch: {text}"))
    return _run(plan, output, StopTimeouts(sigint_timeout, sigterm_timeout))


def _run(plan: Plan, output: str | None, timeouts: StopTimeouts) -> int:
    if not plan.nodes:
        hint = "lcmtools launch --dry-run shows it"
        raise UsageError("the launch file has no nodes to run", hint)
    nodes = [_with_bus(_with_output(node, output)) for node in plan.nodes]
    # a node's print comes at once, as it would on a terminal
    environment = {"PYTHONUNBUFFERED": "1", **os.environ, "LCM_DEFAULT_URL": str(chosen_url())}
    folder = make_folder(os.environ)
    hidden = any(node.output is Output.LOG for node in nodes)
    talk(f"log files: {folder}{'; --screen shows all lines here too' if hidden else ''}")
    outcomes = Supervisor(nodes, environment, folder, Screen(), timeouts).run()
    sys.stdout.flush()
    talk("\n".join(outcome_rows(outcomes)))
    return int(any(outcome.has_failed for outcome in outcomes))


def _with_output(node: NodePlan, output: str | None) -> NodePlan:
    if output is None:
        return node
    return replace(node, output=Output.BOTH if output == "screen" else Output.LOG)


def _with_bus(node: NodePlan) -> NodePlan:
    """Return a node on the domain that its file sets, if any, and not on the launcher's bus."""
    domain = node.environment.get("LCMTOOLS_DOMAIN")
    if not domain or "LCM_DEFAULT_URL" in node.environment:
        return node
    url = str(domain_url(domain, f"{node.place}: LCMTOOLS_DOMAIN"))
    return replace(node, environment={**node.environment, "LCM_DEFAULT_URL": url})
