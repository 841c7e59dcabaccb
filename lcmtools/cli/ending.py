"""How a command ends: errors and signals become one line and an exit code.

What the commands are is not known here.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import TextIO

import click

from lcmtools.cli.output import complain, talk
from lcmtools.errors import LcmtoolsError

INTERRUPTED = 130
BY_SIGNAL = 128
"""A shell adds it to the number of the signal that ended a command."""

_QUIET_ENDS: dict[type[BaseException], int] = {
    KeyboardInterrupt: INTERRUPTED,
    click.Abort: INTERRUPTED,
    BrokenPipeError: 0,  # whoever reads has had enough
}


@contextlib.contextmanager
def endable(signals: list[int]) -> Iterator[None]:
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


def exit_code(result: object) -> int:
    """A command's own exit code; 0 where it returns none."""
    return result if isinstance(result, int) else 0


def explain(error: BaseException, command: str) -> int | None:
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


def writable(stream: TextIO | None) -> TextIO:
    """A stream that takes any text: a channel's name may be no UTF-8, and is shown escaped."""
    if stream is None:  # closed by whoever started this process
        return Path(os.devnull).open("w", encoding="utf-8")
    with contextlib.suppress(AttributeError):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[attr-defined]
    return stream


def flush(code: int) -> int:
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
