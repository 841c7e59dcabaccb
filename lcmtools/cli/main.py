"""The command ``lcmtools``: its groups, and how a command is run."""

import sys
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import click

from lcmtools import __version__
from lcmtools.cli.commands import (
    COMMANDS,
    LAB_COMMANDS,
    MSG_COMMANDS,
    NODE_COMMANDS,
    PARAM_ABSENT,
    PARAM_COMMANDS,
    PKG_COMMANDS,
    SERVICE_COMMANDS,
    SIM_COMMANDS,
    SRV_COMMANDS,
    TOPIC_COMMANDS,
)
from lcmtools.cli.declare import CONTEXT, option
from lcmtools.cli.ending import (
    BY_SIGNAL,
    end_at_once,
    exit_code,
    explain,
    flush,
    interrupting_signals,
    open_nothing,
    unchanged_environment,
    writable,
)
from lcmtools.cli.lazy import COMMAND, Entry, LazyGroup
from lcmtools.cli.options import bus_options, manner_options
from lcmtools.messages.type_source import set_supply
from lcmtools.packages import provide_user_types

EXIT_CODES = (
    "0 success, 1 failure, 2 wrong usage, 3 an extra is missing, 4 nothing received within"
    " --timeout, 130 Ctrl-C, 143 SIGTERM. A node that is ended by node kill exits with 0."
)
_EPILOG = """\b
Examples:
  lcmtools list
  lcmtools echo /husky0/odometry
  lcmtools pub /chatter std_msgs/String "data: hello"

\b
Exit codes: 0 success, 1 failure, 2 wrong usage, 3 an extra is missing, 4 nothing received within
--timeout, 130 Ctrl-C, 143 SIGTERM. A node that is ended by node kill exits with 0.

\b
Environment: LCM_DEFAULT_URL, LCMTOOLS_DOMAIN, LCMTOOLS_NAMESPACE, LCMTOOLS_TIMEOUT,
LCMTOOLS_TYPE_PATH, LCMTOOLS_COLOR, NO_COLOR. Most can also be set in a file; lcmtools config
shows the values and their sources.
"""


def _print_version(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if not value or ctx.resilient_parsing:
        return
    from importlib.metadata import version
    from platform import python_version

    click.echo(f"lcmtools {__version__} (lcm {version('lcm')}, Python {python_version()})")
    ctx.exit()


@click.group(
    cls=LazyGroup, entries=COMMANDS, context_settings=CONTEXT, epilog=_EPILOG, name="lcmtools"
)
@bus_options
@option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_print_version,
    help="Print the versions of lcmtools, lcm and Python.",
)
def root() -> None:
    """Inspect and use an LCM bus: topics, nodes, messages, services, and diagnosis of faults."""


root.params += manner_options(hidden=False)


def _group(
    name: str,
    entries: Mapping[str, Entry],
    text: str,
    *examples: str,
    has_bus: bool = True,
    absent: Mapping[str, str] = MappingProxyType({}),
) -> LazyGroup:
    """A group of commands; where it has a bus, that may be named before the command."""
    rows = "\n".join(f"  lcmtools {name} {example}" for example in examples)
    text = f"{text}\n\n\b\nExamples:\n{rows}"
    group = LazyGroup(name, entries=entries, absent=absent, help=text, context_settings=CONTEXT)
    if has_bus:
        bus_options(group)
        group.params.reverse()  # click appends to a command what it prepends to a function
    return group


_TOPIC = "Look at topics and publish on them."
topic = _group("topic", TOPIC_COMMANDS, _TOPIC, "list", "echo /chatter")
node = _group("node", NODE_COMMANDS, "Query nodes, and end them.", "list", "info simple_controller")
_MSG = "Show message types."
msg = _group("msg", MSG_COMMANDS, _MSG, "list", "show geometry_msgs/Twist", has_bus=False)
_PKG = "Create and find packages of nodes and messages."
_CREATE = "create air_lab0 --deps nav_msgs geometry_msgs"
pkg = _group("pkg", PKG_COMMANDS, _PKG, _CREATE, "list", has_bus=False)
_SRV = "Show service types."
srv = _group("srv", SRV_COMMANDS, _SRV, "list", "show std_srvs/Trigger", has_bus=False)
_SERVICE = "List and call services."
service = _group("service", SERVICE_COMMANDS, _SERVICE, "list", 'call /switch "data: true"')
_PARAM = "Read and set the parameters of running nodes."
_SET = "set simple_controller kp 0.5"
param = _group("param", PARAM_COMMANDS, _PARAM, "list", _SET, absent=PARAM_ABSENT)
_SIM = "Control a simulator on the bus; lcmtools run sim starts one."
sim = _group("sim", SIM_COMMANDS, _SIM, "pause", "set-pose husky0 1 -2 90deg")
_LAB = "Work on the labs: start their simulators, and check your programs."
_CHECK = 'check husky --controller "python my_controller.py"'
lab = _group("lab", LAB_COMMANDS, _LAB, "start husky", _CHECK)


def main(arguments: Sequence[str], signals: Sequence[int] = ()) -> int:
    """Run one command and return its exit code.

    Nothing is left behind: no signal handler, environment variable, thread or socket. Python code
    and tests call it as often as they like.
    ``signals`` are those that have interrupted the command, where the caller handles them.
    """
    context: click.Context | None = None
    provide_user_types()
    with unchanged_environment():
        try:
            # not root.main(): it answers Ctrl-C with an empty line
            with root.make_context("lcmtools", list(arguments)) as context:
                return exit_code(root.invoke(context))
        except BaseException as error:
            if signals:  # a consequence of the signal, whatever the interrupted code raised
                return BY_SIGNAL + signals[0]
            command = context.meta.get(COMMAND) if context else None
            code = explain(error, command or "lcmtools", as_json=_wants_json(arguments))
            if code is None:
                raise
            return code
        finally:
            set_supply(None)


def run() -> None:
    """Run the console script: ``main`` with signals handled, and the end of the process."""
    sys.stdin = sys.stdin or open_nothing("r")  # the lowest of the closed ones first
    sys.stdout, sys.stderr = writable(sys.stdout), writable(sys.stderr)
    with interrupting_signals() as signals:
        code = main(sys.argv[1:], signals)
    end_at_once()
    sys.exit(flush(code))


def _wants_json(arguments: Sequence[str]) -> bool:
    return "--json" in arguments[: [*arguments, "--"].index("--")]
