"""``lcmtools launch``."""

import os
from collections.abc import Callable

from lcmtools.cli.declare import CommandT, argument, duration, examples, flag, option, subcommand
from lcmtools.cli.launch.running import notify, run
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.output import show
from lcmtools.errors import UsageError
from lcmtools.launch.command_line import read_words
from lcmtools.launch.file import STANDARD_INPUT, read_file, read_standard_input
from lcmtools.launch.packages import find_files
from lcmtools.launch.plan_report import PLAN_ANSWERS, arguments_answer, list_answer
from lcmtools.launch.reading import make_plan
from lcmtools.processes.child import StopTimeouts
from lcmtools.settings import usual_namespace


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
        show(*list_answer(), as_json=as_json)
        return 0
    typed = read_words(words, ns, usual_namespace(os.environ))
    is_piped = typed.places == (STANDARD_INPUT,)
    files = [read_standard_input()] if is_piped else list(map(read_file, find_files(typed.places)))
    if query == "show-args":
        show(*arguments_answer(files), as_json=as_json)
        return 0
    plan = make_plan(files, typed.arguments, typed.namespace, os.environ)
    if query:
        answer = PLAN_ANSWERS[query](plan, named.get(query) or "")
        notify(*plan.notes)
        show(*answer, as_json=as_json)
        return 0
    return run(plan, output, StopTimeouts(sigint_timeout, sigterm_timeout), wait=wait)
