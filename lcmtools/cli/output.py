"""Printing: data to standard output, talk to standard error; each line flushed."""

import json
import sys
from collections.abc import Iterable

import click

from lcmtools.errors import LcmtoolsError


def data(text: str) -> None:
    """Print a piece of data, ended by a newline, at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def lines(rows: Iterable[str]) -> None:
    """Print lines of data together."""
    text = "".join(f"{row}\n" for row in rows)
    sys.stdout.write(text)
    sys.stdout.flush()


def document(value: object) -> None:
    """Print one JSON document."""
    data(json.dumps(value, ensure_ascii=False, indent=2))


def talk(text: str) -> None:
    """Say something to the person, not to the pipe."""
    click.echo(text, err=True)


def complain(command: str, error: LcmtoolsError) -> None:
    """Print an error in one line."""
    talk(f"{command}: {' '.join(str(error).split())}")
