"""The command lines of nodes with own arguments, parsed before a bus is opened."""

import argparse
from collections.abc import Callable, Sequence
from typing import NoReturn

from lcmtools.errors import UsageError
from lcmtools.labs.nodes import own_arguments, unknown_argument


class NodeParser(argparse.ArgumentParser):
    """A parser of a node's own arguments whose errors are one line."""

    def __init__(self) -> None:
        super().__init__(add_help=False, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """Raise a UsageError."""
        raise UsageError(message.removeprefix("argument "), "--help shows what this node takes")


def read_command_line(
    args: Sequence[str] | None, help_text: str | None, parser: argparse.ArgumentParser
) -> argparse.Namespace | None:
    """Parse a node's own arguments; None if ``--help`` was given and printed.

    ``args`` and ``help_text`` are as in ``own_arguments``.

    Raises:
        UsageError: An argument is wrong.
    """
    words = own_arguments(args, help_text)
    if words is None:
        return None
    options, unknown = parser.parse_known_args(words)
    if unknown:
        flags = [flag for action in parser._actions for flag in action.option_strings]  # noqa: SLF001 - argparse has no other way
        raise unknown_argument(args, unknown[0], flags)
    return options


def one_of(choices: Sequence[str]) -> Callable[[str], str]:
    """Return a parser that accepts one of some words."""

    def read(text: str) -> str:
        if text not in choices:
            raise argparse.ArgumentTypeError(f"'{text}' is not one of {', '.join(choices)}")
        return text

    return read


def at_least(minimum: float, wanted: str) -> Callable[[str], float]:
    """Return a parser of a number from ``minimum`` on; ``wanted`` describes it in errors."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not minimum <= value < float("inf"):
            raise argparse.ArgumentTypeError(f"'{text}' is not {wanted}")
        return value

    return read
