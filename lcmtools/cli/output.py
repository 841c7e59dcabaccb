"""Printing: data to standard output, notes and errors to standard error; each line flushed.

To standard output: ``write_result`` (a value, as JSON or as lines), ``write_document`` (as JSON),
``write_lines`` (for people, control characters escaped) and ``write_data`` (as it is). To standard
error: ``write_note`` (a line), ``write_error`` and ``write_stderr`` (as it is).
"""

import contextlib
import os
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from lcmtools.color import BOLD_RED, paint, stream_wants_color
from lcmtools.errors import LcmtoolsError
from lcmtools.escapes import ESCAPES, ESCAPES_IN_LINES
from lcmtools.folders import is_standard_output

_PATIENCE = 0.5  # [s] before progress is shown
_SHOWN_EVERY = 0.1  # [s]


def write_data(text: str) -> None:
    """Write text and a newline to standard output, and flush it."""
    _write(f"{text}\n")


def on_screen(text: str) -> str:
    """Escape control characters if standard output is a terminal; CSV may contain some."""
    return text.translate(ESCAPES_IN_LINES) if sys.stdout.isatty() else text


def write_lines(rows: Iterable[str], decorate: Callable[[str], str] = str) -> None:
    """Write lines to standard output with control characters escaped, then decorated."""
    _write("".join(f"{decorate(row.translate(ESCAPES))}\n" for row in rows))


def write_document(value: object) -> None:
    """Write a JSON document to standard output."""
    from lcmtools.formats.strict_json import write_json

    write_data(write_json(value, indent=2))


def write_result(
    value: object,
    rows: Iterable[str],
    decorate: Callable[[str], str] = str,
    *,
    as_json: bool,
    none: str = "",
) -> None:
    """Write a value as a JSON document or as lines; for an empty list also the note ``none``."""
    write_document(value) if as_json else write_lines(rows, decorate)
    if none and not value:
        write_note(none)


@contextlib.contextmanager
def results_beside(target: str | Path | None) -> Iterator[None]:
    """Write results to standard error if standard output is the target of data, as "-" is."""
    with contextlib.ExitStack() as stack:
        if is_standard_output(target):
            stack.enter_context(contextlib.redirect_stdout(sys.stderr))
        yield


@contextlib.contextmanager
def progress(doing: str, total: int) -> Iterator[Callable[[int], None]]:
    """Show the progress of a long operation on a terminal, after the first half second."""
    begin = shown = time.monotonic()

    def report(done: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - begin > _PATIENCE and now - shown > _SHOWN_EVERY and sys.stderr.isatty():
            shown = now
            write_stderr(f"\r{doing.translate(ESCAPES)}: {100 * done // max(1, total)} %")

    try:
        yield report
    finally:
        if shown > begin:
            write_stderr("\r\033[K")


def write_note(text: str, speaker: str = "") -> None:
    """Write a line to standard error, after the name of its speaker if given."""
    line = text.translate(ESCAPES)
    if speaker:
        name = f"{speaker.translate(ESCAPES)}:"
        wanted = stream_wants_color(sys.stderr, os.environ)
        line = f"{paint(name, BOLD_RED) if wanted else name} {line}"
    write_stderr(f"{line}\n")


def write_error(command: str, error: LcmtoolsError, *, as_json: bool = False) -> None:
    """Write an error in one line, as JSON if the command prints JSON."""
    what, hint = (" ".join(part.split()) for part in (error.what, error.hint))
    if as_json:
        from lcmtools.formats.strict_json import write_json

        record = {"command": command, "error": what, "hint": hint, "exit_code": error.exit_code}
        write_note(write_json(record))
    else:
        write_note(f"{what}; {hint}" if hint else what, command)


def may_wait() -> bool:
    """Return whether output may be delayed: to a terminal or a file, but not to a pipe."""
    with contextlib.suppress(OSError):  # not a file of the operating system
        mode = os.fstat(sys.stdout.fileno()).st_mode
        return stat.S_ISREG(mode) or stat.S_ISCHR(mode)
    return False


def clearing() -> str:
    """Return the escape sequence that clears the screen, or "" if there is no screen."""
    can_clear = sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb"
    return "\033[2J\033[;H" if can_clear else ""  # clear, and move the cursor to the corner


def write_stderr(text: str) -> None:
    """Write text to standard error as it is. Ignore a closed or full stream."""
    with contextlib.suppress(OSError, ValueError):  # ValueError: the stream is closed
        sys.stderr.write(text)
        sys.stderr.flush()


def _write(text: str) -> None:
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise LcmtoolsError(f"cannot write to standard output: {error.strerror}") from error
