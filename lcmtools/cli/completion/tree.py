"""The commands as plain data, for completion without importing click.

``commands.jsonl`` beside this file has them, a line each; ``from_click`` writes it.
"""

import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from lcmtools.cli.completion import Source

FILE = Path(__file__).with_name("commands.jsonl")


class Option(NamedTuple):
    """An option of a command."""

    names: Sequence[str]  # the long form last
    parameter: str  # its name in the command's code
    source: Source | None  # None for a flag
    help: str = ""
    repeats: bool = False
    is_hidden: bool = False  # understood, but not offered


class Argument(NamedTuple):
    """An argument of a command; if it repeats, it takes all words that follow."""

    parameter: str
    source: Source
    repeats: bool = False


class Command(NamedTuple):
    """The options and arguments of a command, or the commands of a group."""

    options: Sequence[Option]
    arguments: Sequence[Argument]
    commands: Mapping[str, str]  # and their descriptions; aliases too
    is_mixed: bool = True  # its own options may stand behind the first argument


def describe(path: Sequence[str]) -> Command | None:
    """Return the command with these words, or None."""
    beginning = f"[{json.dumps(' '.join(path))},"
    line = next((one for one in _lines() if one.startswith(beginning)), None)
    if line is None:
        return None
    _, options, arguments, commands, is_mixed = json.loads(line)
    known = [Option(*one) for one in options], [Argument(*one) for one in arguments]
    return Command(*known, commands, is_mixed)


@cache
def _lines() -> Sequence[str]:
    return FILE.read_text(encoding="utf-8").splitlines()
