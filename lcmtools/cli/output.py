"""Printing: data to standard output, talk to standard error; each line flushed."""

import contextlib
import os
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator

from lcmtools.color import BOLD_RED, paint, stream_wants_color
from lcmtools.errors import LcmtoolsError

# Anybody can put a channel on the bus whose name would clear or recolour the terminal, begin a line
# of its own or turn the direction of what follows.
_ODD = (*range(0x7F, 0xA0), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
_ESCAPES = {
    code: f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"  # noqa: PLR2004 - two digits
    for code in (*range(0x20), *_ODD)
    if code != ord("\t")
} | {0xDC00 + byte: f"\\x{byte:02x}" for byte in range(0x80, 0x100)}  # bytes that are no UTF-8
_ESCAPES_IN_LINES = {code: text for code, text in _ESCAPES.items() if code != ord("\n")}

_PATIENCE = 0.5  # [s] before progress is shown
_SHOWN_EVERY = 0.1  # [s]


def data(text: str) -> None:
    """Print a piece of data, ended by a newline, at once."""
    _write(f"{text}\n")


def on_screen(text: str) -> str:
    """Return lines of data; for a terminal, control characters escaped, which CSV may have."""
    return text.translate(_ESCAPES_IN_LINES) if sys.stdout.isatty() else text


def lines(rows: Iterable[str], decorate: Callable[[str], str] = str) -> None:
    """Print lines of data together, control characters escaped; ``decorate`` then colours them."""
    _write("".join(f"{decorate(row.translate(_ESCAPES))}\n" for row in rows))


def document(value: object) -> None:
    """Print one JSON document."""
    from lcmtools.formats.strict_json import write_json

    data(write_json(value, indent=2))


def show(
    value: object,
    rows: Iterable[str],
    decorate: Callable[[str], str] = str,
    *,
    as_json: bool,
    none: str = "",
) -> None:
    """Print a value as a JSON document, or as lines; say ``none`` where it is an empty list."""
    document(value) if as_json else lines(rows, decorate)
    if none and not value:
        talk(none)


@contextlib.contextmanager
def progress(doing: str, total: int) -> Iterator[Callable[[int], None]]:
    """Show how much of a long work is done, in a line of a terminal; after a while only."""
    begin = shown = time.monotonic()

    def report(done: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - begin > _PATIENCE and now - shown > _SHOWN_EVERY and sys.stderr.isatty():
            shown = now
            say(f"\r{doing.translate(_ESCAPES)}: {100 * done // max(1, total)} %")

    try:
        yield report
    finally:
        if shown > begin:
            say("\r\033[K")


def talk(text: str, speaker: str = "") -> None:
    """Print a message for the person to standard error, a line behind the name of its speaker."""
    said = text.translate(_ESCAPES)
    if speaker:
        name = f"{speaker.translate(_ESCAPES)}:"
        wanted = stream_wants_color(sys.stderr, os.environ)
        said = f"{paint(name, BOLD_RED) if wanted else name} {said}"
    say(f"{said}\n")


def complain(command: str, error: LcmtoolsError, *, as_json: bool = False) -> None:
    """Print an error in one line; as JSON where the data are JSON."""
    what, hint = (" ".join(part.split()) for part in (error.what, error.hint))
    if as_json:
        from lcmtools.formats.strict_json import write_json

        record = {"command": command, "error": what, "hint": hint, "exit_code": error.exit_code}
        talk(write_json(record))
    else:
        talk(f"{what}; {hint}" if hint else what, command)


def may_wait() -> bool:
    """Return True where a person or a file takes the output: a program at a pipe must not wait."""
    with contextlib.suppress(OSError):  # it is no file of the system
        mode = os.fstat(sys.stdout.fileno()).st_mode
        return stat.S_ISREG(mode) or stat.S_ISCHR(mode)
    return False


def clearing() -> str:
    """Return what clears the screen; "" where there is none."""
    can_clear = sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb"
    return "\033[2J\033[;H" if can_clear else ""  # the screen, and the cursor to its corner


def say(text: str) -> None:
    """Write to standard error as it is; where nothing can be said, the exit code remains."""
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
