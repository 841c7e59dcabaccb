"""``lcmtools launch``."""

import os
import shlex
import sys
from collections.abc import Callable
from dataclasses import replace

from lcmtools.bus.preflight import wait_for_bus
from lcmtools.bus.url import domain_url
from lcmtools.cli.bus import chosen_url
from lcmtools.cli.declare import CommandT, argument, duration, examples, flag, option, subcommand
from lcmtools.cli.launch_screen import Screen
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import UsageError
from lcmtools.launch.file import STANDARD_INPUT, read_file, read_standard_input, read_words
from lcmtools.launch.logs import make_folder
from lcmtools.launch.packages import find_files
from lcmtools.launch.plan import NodePlan, Output, Plan
from lcmtools.launch.plan_report import PLAN_ANSWERS, arguments_answer, list_answer
from lcmtools.launch.reading import make_plan
from lcmtools.launch.supervisor import Supervisor
from lcmtools.processes.child import StopTimeouts
from lcmtools.settings import usual_namespace
from lcmtools.text_table import text_table


def _question(*names: str, text: str) -> Callable[[CommandT], CommandT]:
    return option(*names, "question", flag_value=names[0].strip("-"), help=text)


def _question_of_node(*names: str, text: str) -> Callable[[CommandT], CommandT]:
    return option(*names, metavar="NODE", completer="runnables:launched_nodes", help=text)


@subcommand("launch", json_option, bus_options)
@examples(
    "launch simple_controller.launch __ns:=/husky0",
    "launch air_lab0 simple_controller.launch --dry-run",
    "launch robot.yaml robot:=husky1",
)
@argument(
    "words",
    nargs=-1,
    metavar="[PACKAGE] FILE... [NAME:=VALUE]... [__ns:=NAMESPACE]",
    completer="runnables:launch_words",
)
@option(
    "--ns", metavar="NAMESPACE", help="The same as __ns:=NAMESPACE.", completer="bus:namespaces"
)
@_question("--nodes", text="Only list the nodes' full names.")
@_question_of_node("--args", "node", text="Only print a node's command line.")
@_question_of_node("--find-node", "sought", text="Only print the line that defines a node.")
@_question("--show-args", "--ros-args", text="Only list the file's arguments.")
@_question("--dump-params", text="Only print the nodes' parameters, as param dump does.")
@_question("--files", text="Only list the files that are read.")
@_question("--dry-run", text="Only print all command lines.")
@_question("--list", "-l", text="List the labs' launch files.")
@option("--screen", "output", flag_value="screen", help="Show the output of all nodes.")
@option("--log", "output", flag_value="log", help="Show warnings and errors only; log the rest.")
@flag("--wait", help="Wait for a working bus before starting.")
@option("--sigint-timeout", type=duration, default=15.0, help="Time after SIGINT (else 15s).")
@option("--sigterm-timeout", type=duration, default=2.0, help="Time after SIGTERM (else 2s).")
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
    """
    named = {"args": node, "find-node": sought}
    query = next((name for name, value in named.items() if value is not None), question)
    if as_json and not query:
        known = "nodes, --args, --find-node, --show-args, --dump-params, --files, --dry-run, --list"
        raise UsageError("--json needs an option that asks for data", f"one of --{known}")
    if query == "list":
        write_result(*list_answer(), as_json=as_json)
        return 0
    typed = read_words(words, ns, usual_namespace(os.environ))
    is_piped = typed.places == (STANDARD_INPUT,)
    files = [read_standard_input()] if is_piped else list(map(read_file, find_files(typed.places)))
    if query == "show-args":
        write_result(*arguments_answer(files), as_json=as_json)
        return 0
    plan = make_plan(files, typed.arguments, typed.namespace, os.environ)
    if query:
        answer = PLAN_ANSWERS[query](plan, named.get(query) or "")
        notify(*plan.notes)
        write_result(*answer, as_json=as_json)
        return 0
    return run(plan, output, StopTimeouts(sigint_timeout, sigterm_timeout), wait=wait)


def notify(*texts: str) -> None:
    """Write notes that begin with the name of the command."""
    for text in texts:
        write_note(f"lcmtools launch: {text}")


def run(plan: Plan, output: str | None, timeouts: StopTimeouts, *, wait: bool) -> int:
    """Run the nodes of a plan until all have ended; return the exit code.

    ``output`` is "screen" or "log" for all nodes; None as the file has it. With ``wait`` they wait
    for a working bus first.
    """
    url = chosen_url()
    notify(*plan.notes)
    if wait:
        wait_for_bus(url, notify)
    if not plan.nodes:
        hint = "lcmtools launch --dry-run shows it"
        raise UsageError("the launch file has no nodes to run", hint)
    nodes = [_with_bus(_with_output(node, output)) for node in plan.nodes]
    # a node's print() appears at once, as on a terminal
    environment = {"PYTHONUNBUFFERED": "1", **os.environ, "LCM_DEFAULT_URL": str(url)}
    folder = make_folder(os.environ)
    hidden = any(node.output is Output.LOG for node in nodes)
    write_note(f"log files: {folder}{'; --screen shows all lines here too' if hidden else ''}")
    ended = Supervisor(nodes, environment, folder, Screen(), timeouts).run()
    sys.stdout.flush()
    rows = [("node", "end", "restarts", "log")]
    for one in ended:
        log = shlex.quote(one.log) if one.log else "-"
        rows.append((one.plan.name, one.end_text(), str(max(0, one.starts - 1)), log))
    for row in text_table(rows):
        write_note(row)
    return int(any(one.has_failed for one in ended))


def _with_output(node: NodePlan, output: str | None) -> NodePlan:
    if output is None:
        return node
    return replace(node, output=Output.BOTH if output == "screen" else Output.LOG)


def _with_bus(node: NodePlan) -> NodePlan:
    """Return a node with the URL of the domain that its launch file sets, if any."""
    domain = node.environment.get("LCMTOOLS_DOMAIN")
    if not domain or "LCM_DEFAULT_URL" in node.environment:
        return node
    url = str(domain_url(domain, f"{node.place}: LCMTOOLS_DOMAIN"))
    return replace(node, environment={**node.environment, "LCM_DEFAULT_URL": url})
