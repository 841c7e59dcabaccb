"""The command ``lcmtools``: its table of commands, and where errors become exit codes."""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import TextIO

import click

from lcmtools import __version__
from lcmtools.cli.lazy import Entry, LazyGroup
from lcmtools.cli.options import CONTEXT, bus_options
from lcmtools.cli.output import complain, talk
from lcmtools.errors import LcmtoolsError

INTERRUPTED = 130
_BY_SIGNAL = 128  # a shell adds it to the number of the signal that ended a command

_TOPIC = "lcmtools.cli.topic"
_TOPIC_COMMANDS = {
    "list": Entry(f"{_TOPIC}.list:command", "List the topics on the bus."),
    "info": Entry(f"{_TOPIC}.info:command", "Show a topic's type, publishers and subscribers."),
    "echo": Entry(f"{_TOPIC}.echo:command", "Print the messages of a topic."),
    "pub": Entry(f"{_TOPIC}.pub:command", "Publish messages written in YAML."),
    "hz": Entry(f"{_TOPIC}.hz:command", "Measure a topic's rate."),
    "type": Entry(f"{_TOPIC}.type:command", "Print a topic's type."),
}
_NODE_COMMANDS = {
    "list": Entry("lcmtools.cli.node.list:command", "List the nodes on the bus."),
    "info": Entry("lcmtools.cli.node.info:command", "Show a node's publications and more."),
    "ping": Entry("lcmtools.cli.node.ping:command", "Measure how fast a node answers."),
    "cleanup": Entry("lcmtools.cli.node.cleanup:command", "Forget nodes that were killed."),
}
_MSG_COMMANDS = {
    "list": Entry("lcmtools.cli.msg.list:command", "List the message types."),
    "show": Entry("lcmtools.cli.msg.show:command", "Show the fields of a message type."),
}
_COMMANDS = {
    **_TOPIC_COMMANDS,
    "node": Entry("lcmtools.cli.main:node", "Look at nodes: list, info, ping, cleanup."),
    "msg": Entry("lcmtools.cli.main:msg", "Look at message types: list, show."),
    "wtf": Entry("lcmtools.cli.wtf:command", "Find what is wrong and say how to mend it."),
    "run": Entry("lcmtools.cli.run:command", "Run a node, or the simulator."),
    "topic": Entry("lcmtools.cli.main:topic", "topic list is list, and so on.", is_alias=True),
    "doctor": Entry("lcmtools.cli.wtf:command", "wtf, as ROS 2 names it.", is_alias=True),
    "interface": Entry("lcmtools.cli.main:msg", "msg, as ROS 2 names it.", is_alias=True),
}

_EPILOG = """\b
Examples:
  lcmtools list
  lcmtools echo /husky0/odometry
  lcmtools pub /chatter std_msgs/String "data: hello"

\b
Exit codes: 0 done, 1 failed, 2 wrong usage, 3 an extra is missing, 4 nothing came within
--timeout, 130 Ctrl-C, 143 SIGTERM. A node that is asked to end exits with 0.
"""


def _print_version(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if not value or ctx.resilient_parsing:
        return
    from importlib.metadata import version
    from platform import python_version

    click.echo(f"lcmtools {__version__} (lcm {version('lcm')}, Python {python_version()})")
    ctx.exit()


@click.group(
    cls=LazyGroup, entries=_COMMANDS, context_settings=CONTEXT, epilog=_EPILOG, name="lcmtools"
)
@bus_options
@click.option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_print_version,
    help="Print the versions of lcmtools, lcm and Python.",
)
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def root(debug: bool) -> None:  # noqa: FBT001 - click's signature
    """See and speak to every program on an LCM bus: topics, nodes, messages, and what is wrong."""
    if debug:
        os.environ["LCMTOOLS_DEBUG"] = "1"


@click.group(cls=LazyGroup, entries=_TOPIC_COMMANDS, context_settings=CONTEXT)
@bus_options
def topic() -> None:
    """Look at topics and publish on them.

    \b
    Examples:
      lcmtools topic list
      lcmtools topic echo /chatter
    """  # noqa: D301 - \b is click's mark


@click.group(cls=LazyGroup, entries=_NODE_COMMANDS, context_settings=CONTEXT)
@bus_options
def node() -> None:
    """Look at nodes.

    \b
    Examples:
      lcmtools node list
      lcmtools node info simple_controller
    """  # noqa: D301 - \b is click's mark


@click.group(cls=LazyGroup, entries=_MSG_COMMANDS, context_settings=CONTEXT)
def msg() -> None:
    """Look at message types.

    \b
    Examples:
      lcmtools msg list
      lcmtools msg show geometry_msgs/Twist
    """  # noqa: D301 - \b is click's mark


def main(arguments: Sequence[str]) -> int:
    """Run one command; return its exit code."""
    signals: list[int] = []
    try:
        # not root.main(): it answers Ctrl-C with an empty line
        with _endable(signals), root.make_context("lcmtools", list(arguments)) as context:
            return _exit_code(root.invoke(context))
    except BaseException as error:
        if signals:  # whatever the code that was interrupted has made of it
            return _BY_SIGNAL + signals[0]
        code = _explain(error, _command_name(arguments))
        if code is None:
            raise
        return code


def _explain(error: BaseException, command: str) -> int | None:
    """Say what went wrong in one line; the exit code, or None for what a traceback should show."""
    if isinstance(error, click.exceptions.Exit):
        return error.exit_code
    if isinstance(error, click.ClickException):
        return _usage_error(error, command)
    for kind, code in _QUIET_ENDS.items():
        if isinstance(error, kind):
            return code
    if os.environ.get("LCMTOOLS_DEBUG") or not isinstance(error, Exception):
        return None
    return _failure(error, command)


def _failure(error: Exception, command: str) -> int:
    """Print why a command failed."""
    if isinstance(error, LcmtoolsError):
        complain(command, error)
        return error.exit_code
    if isinstance(error, OSError):
        talk(f"{command}: {error.strerror or error}")
        return 1
    kind = type(error).__name__
    talk(f"{command}: a fault of lcmtools ({kind}: {error}); lcmtools --debug shows where")
    return 1


def run() -> None:
    """The console script."""
    sys.stdout, sys.stderr = _writable(sys.stdout), _writable(sys.stderr)
    code = main(sys.argv[1:])
    code = _flush(code)
    sys.exit(code)


_QUIET_ENDS: dict[type[BaseException], int] = {
    KeyboardInterrupt: INTERRUPTED,
    click.Abort: INTERRUPTED,
    BrokenPipeError: 0,  # whoever reads has had enough
}


@contextlib.contextmanager
def _endable(signals: list[int]) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM end a command in an orderly way; ``signals`` gets their numbers.

    Also where SIGINT was ignored when it began, as a shell script has it for what it starts with
    "&": kill -INT ends a command there as it ends rostopic.
    """

    def end(number: int, _frame: FrameType | None) -> None:
        signals.append(number)
        raise KeyboardInterrupt

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _exit_code(result: object) -> int:
    return result if isinstance(result, int) else 0


def _usage_error(error: click.ClickException, command: str) -> int:
    """Print a usage error in one line."""
    context = getattr(error, "ctx", None)
    command = context.command_path if context else command
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        click.echo(error.format_message(), err=True)
        return error.exit_code
    message = error.format_message().rstrip(".")
    talk(f"{command}: {message[:1].lower()}{message[1:]} (see {command} --help)")
    return error.exit_code


def _command_name(arguments: Sequence[str]) -> str:
    """The command as typed, for messages: "lcmtools node info"."""
    known = {**_COMMANDS, **_NODE_COMMANDS, **_MSG_COMMANDS}
    words = []
    for word in arguments:
        if word not in known:
            break
        words.append(word)
    return " ".join(["lcmtools", *words])


def _writable(stream: TextIO | None) -> TextIO:
    """A stream that takes any text: a channel's name may be no UTF-8, and is shown escaped."""
    if stream is None:  # closed by whoever started this process
        return Path(os.devnull).open("w", encoding="utf-8")
    with contextlib.suppress(AttributeError):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[attr-defined]
    return stream


def _flush(code: int) -> int:
    """Write what is left; a closed pipe is no fault, a full disk is."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        talk(f"lcmtools: cannot write: {error.strerror}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return code
