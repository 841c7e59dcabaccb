"""The command ``lcmtools``, and how it is run."""

import atexit
import sys
from collections.abc import Sequence

import click

from lcmtools import __version__
from lcmtools.cli import ending
from lcmtools.cli.commands import COMMANDS
from lcmtools.cli.declare import CONTEXT, flag
from lcmtools.cli.lazy import COMMAND, LazyGroup
from lcmtools.cli.options import bus_options, manner_options
from lcmtools.messages.supply import set_supply
from lcmtools.packages import provide_user_types
from lcmtools.settings import SETTINGS, VARIABLES

EXIT_CODES = """\
0 success, 1 failure, 2 wrong usage, 3 an extra is missing, 4 nothing received within
--timeout, 129 the terminal was closed, 130 Ctrl-C, 143 SIGTERM. A node that is ended by
node kill exits with 0."""
_OWN = [name for name in VARIABLES if name.startswith("LCMTOOLS_")]
_EPILOG = f"""\b
Examples:
  lcmtools list
  lcmtools echo /husky0/odometry
  lcmtools pub /chatter std_msgs/String "data: hello"

\b
Exit codes: {EXIT_CODES}

Environment: {", ".join([*(one.variable for one in SETTINGS.values()), *_OWN])}, NO_COLOR.
lcmtools config shows them, and which can also be set in a file.
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
@flag(
    "--version",
    expose_value=False,
    is_eager=True,
    callback=_print_version,
    help="Print the versions of lcmtools, lcm and Python.",
)
def root() -> None:
    """Inspect and use an LCM bus: topics, nodes, messages, services, and diagnosis of faults."""


root.params += manner_options(hidden=False)


def main(arguments: Sequence[str], signals: Sequence[int] = ()) -> int:
    """Run one command and return its exit code.

    Nothing is left behind: no signal handler, environment variable, thread or socket. Python code
    and tests call it as often as they like.
    ``signals`` are those that have interrupted the command, where the caller handles them.
    """
    context: click.Context | None = None
    provide_user_types()
    with ending.unchanged_environment():
        try:
            # not root.main(): it answers Ctrl-C with an empty line
            with root.make_context("lcmtools", list(arguments)) as context:
                result = root.invoke(context)
                return result if isinstance(result, int) else 0
        except BaseException as error:
            if signals:  # a consequence of the signal, whatever the interrupted code raised
                return ending.exit_code(signals[0])
            command = context.meta.get(COMMAND) if context else None
            code = ending.explain(error, command or "lcmtools", as_json=_wants_json(arguments))
            if code is None:
                raise
            return code
        finally:
            set_supply(None)


def run() -> None:
    """Run the console script: ``main`` with signals handled, and the end of the process."""
    atexit.register(ending.leave)  # the first one, which is called last
    sys.stdin = sys.stdin or ending.open_nothing("r")  # the lowest of the closed ones first
    sys.stdout, sys.stderr = ending.writable(sys.stdout), ending.writable(sys.stderr)
    with ending.interrupting_signals() as signals:
        code = main(sys.argv[1:], signals)
    ending.end(code)


def _wants_json(arguments: Sequence[str]) -> bool:
    return "--json" in arguments[: [*arguments, "--"].index("--")]
