"""The end of a command: turning errors and signals into one line and an exit code."""

import contextlib
import errno
import os
import re
import select
import signal
import stat
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import FrameType
from typing import NoReturn, TextIO, cast

import click
from click.core import ParameterSource

from lcmtools.cli.output import write_error, write_note
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.signals import Doubles, ending_signals

INTERRUPTED = 130
BY_SIGNAL = 128
"""The exit code of a command that a signal has ended is this and the signal's number."""
_READER_GONE = signal.SIGURG  # nothing else sends it; without a handler it is ignored

_NO_MEMORY = re.compile("failed to map segment|[Cc]annot allocate memory")  # of a shared library

_SOON = 0.001  # [s] from an interrupt that Python has ignored to the next
_AGAIN = 1.0  # [s] from one to the next, while a command goes on though its reader is gone
_ENVIRONMENT = ParameterSource.ENVIRONMENT
_CHANGED = ("LCMTOOLS_COLOR", "LCMTOOLS_DEBUG", "NO_COLOR", "COLUMNS", "LINES")
"""Environment variables that options set for the command and the processes that it starts."""


@contextlib.contextmanager
def unchanged_environment() -> Iterator[None]:
    """Restore the environment variables that a command line may set."""
    before = {name: os.environ[name] for name in _CHANGED if name in os.environ}
    try:
        yield
    finally:
        for name in _CHANGED:
            os.environ.pop(name, None)
        os.environ.update(before)


@contextlib.contextmanager
def interrupting_signals() -> Iterator[list[int]]:
    """Let Ctrl-C, SIGTERM and a closed terminal raise KeyboardInterrupt; yield their numbers.

    Also where SIGINT was ignored when the process began, as a shell script has it for what it
    starts with "&": kill -INT ends a command there as it ends rostopic. One that Python ignores,
    because it comes while an object is finalized, comes again. The interrupts carry the exit code.
    """
    signals: list[int] = []
    asking, doubles = ending_signals(), Doubles()

    def interrupt(number: int, _frame: FrameType | None) -> None:
        if number == signal.SIGHUP and signals:  # a shell that ends and its terminal both send one
            return
        if number in asking and doubles.is_double():
            return
        signals.append(number)
        raise KeyboardInterrupt(exit_code(signals[0]))

    def interrupt_again(ignored: "sys.UnraisableHookArgs") -> None:
        if ignored.exc_type is KeyboardInterrupt:  # raised during a clean-up; every import has one
            signal.setitimer(signal.ITIMER_REAL, _SOON)
        else:
            show(ignored)

    numbers = (*asking, signal.SIGALRM, _READER_GONE)
    before = {number: signal.signal(number, interrupt) for number in numbers}
    show, sys.unraisablehook = sys.unraisablehook, interrupt_again
    try:
        yield signals
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        sys.unraisablehook = show
        for number, handler in before.items():
            signal.signal(number, handler)


def end_with_reader() -> None:
    """End the command when its output loses its reader, even if it writes nothing.

    Of a terminal SIGHUP says so. Without effect outside of ``interrupting_signals``.
    """
    if callable(signal.getsignal(_READER_GONE)) and not sys.stdout.isatty():
        ended, end_of_command = os.pipe()
        click.get_current_context().call_on_close(partial(os.close, end_of_command))
        descriptors = sys.stdout.fileno(), ended
        threading.Thread(target=_await_reader_gone, args=descriptors, daemon=True).start()


def _await_reader_gone(output: int, ended: int) -> None:
    poll = select.poll()
    for descriptor in (output, ended):
        poll.register(descriptor, 0)  # errors only: the other end of the pipe is closed
    while ended not in dict(poll.poll()):
        signal.pthread_kill(cast(int, threading.main_thread().ident), _READER_GONE)
        time.sleep(_AGAIN)  # Python may lose an interrupt that arrives while it formats an error
    os.close(ended)


def exit_code(number: int) -> int:
    """Return the exit code after a signal; 0 if the reader of the output has gone."""
    return 0 if number == _READER_GONE else BY_SIGNAL + number


def end_at_once() -> None:
    """Let a signal that arrives after all output end the process silently."""
    for number in ending_signals():
        signal.signal(number, lambda number, _frame: os._exit(BY_SIGNAL + number))


def explain(error: BaseException, command: str, *, as_json: bool = False) -> int | None:
    """Print an error in one line; return the exit code, or None if a traceback is to show it.

    Where the data are JSON, failures are printed as JSON too; wrong usage is not.
    """
    if isinstance(error, click.exceptions.Exit):
        return error.exit_code
    if isinstance(error, click.ClickException):
        return _usage_error(error, command)
    if isinstance(error, (KeyboardInterrupt, click.Abort)):
        return INTERRUPTED
    if isinstance(error, BrokenPipeError):  # the reader has closed the pipe
        return 0
    if os.environ.get("LCMTOOLS_DEBUG") or not isinstance(error, Exception):
        return None
    failure = _failure(error)
    write_error(command, failure, as_json=as_json and not isinstance(failure, UsageError))
    return failure.exit_code


def _failure(error: Exception) -> LcmtoolsError:
    if isinstance(error, LcmtoolsError):
        return error
    if scarce := _scarce(error):
        what, limits = scarce
        return LcmtoolsError(f"the system gives no more {what}", f"end others; see ulimit {limits}")
    if isinstance(error, FileNotFoundError) and not error.filename:  # as os.getcwd has it
        return LcmtoolsError("the working directory has been deleted", "go to another one: cd")
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return LcmtoolsError(f"{where}{error.strerror or error}")
    kind = type(error).__name__
    return LcmtoolsError(f"a fault of lcmtools ({kind}: {error})", "lcmtools --debug shows where")


def _scarce(error: BaseException | None) -> tuple[str, str] | None:
    """Return what an error, or the cause of it, says that the system lacks, and its limits."""
    if error is None:
        return None
    number, text = getattr(error, "errno", 0), str(error)  # an ImportError has only a text
    if number in (errno.EMFILE, errno.ENFILE) or text.endswith(os.strerror(errno.EMFILE)):
        return "file descriptors", "-n"
    if isinstance(error, MemoryError) or number == errno.ENOMEM or _NO_MEMORY.search(text):
        return "memory", "-v"
    if isinstance(error, RuntimeError) and "start new thread" in text:
        return "threads", "-u and -v"
    return _scarce(error.__cause__ or error.__context__)


def _usage_error(error: click.ClickException, command: str) -> int:
    context = getattr(error, "ctx", None)
    command = context.command_path if context else command
    message = " ".join(error.format_message().split()).rstrip(".")
    message = _of_variable(error) or f"{message[:1].lower()}{message[1:]}"
    if isinstance(error, click.NoSuchOption) and (instead := _of_ros(command, error.option_name)):
        message = f"no such option '{error.option_name}'; {instead}"
    words = {parameter.metavar for parameter in context.command.params} if context else ()
    if "extra argument" in message and "COMMAND" in words:
        message += "; a command line is one word, in quotes"
    write_note(f"{message} (see {command} --help)", command)
    return error.exit_code


def _of_ros(command: str, option: str) -> str:
    from lcmtools.cli.ros import option_instead

    return option_instead(command, option)


def _of_variable(error: click.ClickException) -> str:
    """Return the text of an error in the value of an environment variable, or ""."""
    if not isinstance(error, click.BadParameter) or not (error.ctx and error.param):
        return ""
    source = error.ctx.get_parameter_source(error.param.name or "")
    return f"{error.param.envvar}: {error.message.rstrip('.')}" if source is _ENVIRONMENT else ""


def open_nothing(mode: str) -> TextIO:
    """Open a replacement for a standard stream that was closed before the process began."""
    return cast(TextIO, Path(os.devnull).open(mode, encoding="utf-8"))


def writable(stream: TextIO | None) -> TextIO:
    """Return the stream, set to UTF-8, or to escape what its terminal cannot show.

    A channel's name, for example, may not be UTF-8. JSON in a pipe or a file always is.
    """
    if stream is None:
        return open_nothing("w")
    with contextlib.suppress(AttributeError):
        encoding = stream.encoding if stream.isatty() else "utf-8"
        stream.reconfigure(encoding=encoding, errors="backslashreplace")  # type: ignore[attr-defined]
    return stream


_ended: list[int] = []


def leave() -> None:
    """End the process without Python's finalization, which takes 3 ms.

    Called last of all handlers of atexit. A node's program of its own unregisters it: files that
    it has left open are closed, and written to their end, as Python ends.
    """
    if _ended:
        os._exit(_ended[0])


def end(code: int) -> NoReturn:
    """Flush the output, and end the process."""
    end_at_once()
    _ended.append(flush(code))
    sys.exit(_ended[0])


def flush(code: int) -> int:
    """Flush the output. A missing reader is no error; a full disk is reported once."""
    try:
        sys.stdout.flush()
    except OSError as error:
        if not (code or _is_without_reader(error)):  # else the command has said why it failed
            write_note(f"cannot write: {error.strerror}", "lcmtools")
            code = 1
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    try:
        sys.stderr.flush()
    except OSError:  # else the interpreter tries again at its end, and exits with 120
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    return code


def _is_without_reader(error: OSError) -> bool:
    """Return whether the pipe or the terminal at standard output has been closed."""
    is_device = stat.S_ISCHR(os.fstat(sys.stdout.fileno()).st_mode)
    return error.errno == errno.EPIPE or (error.errno == errno.EIO and is_device)
