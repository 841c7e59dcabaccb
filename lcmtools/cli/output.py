"""Printing: data to standard output, talk to standard error; each line flushed."""

import json
import sys
from collections.abc import Iterable

import click

from lcmtools.errors import LcmtoolsError

# Anybody can put a channel on the bus whose name would clear or recolour the terminal.
_ESCAPES = {code: f"\\x{code:02x}" for code in (*range(32), *range(127, 160)) if code != ord("\t")}


def data(text: str) -> None:
    """Print a piece of data, ended by a newline, at once."""
    _write(f"{text}\n")


def lines(rows: Iterable[str]) -> None:
    """Print lines of data together; control characters, as a name may have them, escaped."""
    _write("".join(f"{row.translate(_ESCAPES)}\n" for row in rows))


def document(value: object) -> None:
    """Print one JSON document."""
    data(json.dumps(value, ensure_ascii=False, indent=2))


def talk(text: str) -> None:
    """Say something to the person, not to the pipe."""
    click.echo("\n".join(row.translate(_ESCAPES) for row in text.split("\n")), err=True)


def complain(command: str, error: LcmtoolsError) -> None:
    """Print an error in one line."""
    talk(f"{command}: {' '.join(str(error).split())}")


def _write(text: str) -> None:
    """Write to standard output at once.

    Raises:
        BrokenPipeError: Whoever reads has had enough.
        LcmtoolsError: It cannot be written, as on a full disk.
    """
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise LcmtoolsError(f"cannot write to standard output: {error.strerror}") from error
