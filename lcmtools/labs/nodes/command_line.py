"""Reading the command line of a node that has arguments of its own.

What such a node takes, it says by an argument parser; names, parameters and the bus it does not
need to know: they are for every node. Nothing is known here of what the arguments mean.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from lcmtools.arguments import misspelt, split_arguments
from lcmtools.errors import UsageError
from lcmtools.labs.nodes import check_command_line
from lcmtools.names import did_you_mean


class NodeParser(argparse.ArgumentParser):
    """A parser whose complaints are one line, and whose help is the node's own text."""

    def __init__(self) -> None:
        super().__init__(add_help=False, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong.

        Raises:
            UsageError: Always.
        """
        raise UsageError(message.removeprefix("argument "), "--help shows what this node takes")


def read_command_line(
    args: Sequence[str] | None, help_text: str, parser: argparse.ArgumentParser
) -> argparse.Namespace | None:
    """A node's own arguments, read before there is a bus.

    Args:
        args: The command line without the program's name; ``sys.argv`` when None.
        help_text: What ``--help`` prints; see ``check_command_line``.
        parser: What the node takes.

    Returns:
        The arguments, or None when help was asked for, and printed.

    Raises:
        UsageError: Something on it is wrong.
    """
    words = list(sys.argv[1:] if args is None else args)
    if "--help" in words or "-h" in words:
        check_command_line(["--help"], help_text)
        return None
    options, unknown = parser.parse_known_args(split_arguments(words)[1])
    if unknown:
        hint = misspelt(words, unknown[0]) or did_you_mean(unknown[0], flags_of(parser))
        raise UsageError(
            f"unknown argument '{unknown[0]}'", hint or "--help shows what this node takes"
        )
    return options


def flags_of(parser: argparse.ArgumentParser) -> list[str]:
    """The options that a parser takes."""
    return [flag for action in parser._actions for flag in action.option_strings]  # noqa: SLF001 - argparse tells by no other way


def one_of(choices: Sequence[str]) -> Callable[[str], str]:
    """Reads one of some words."""

    def read(text: str) -> str:
        if text not in choices:
            raise argparse.ArgumentTypeError(f"'{text}' is none of {', '.join(choices)}")
        return text

    return read


def at_least(minimum: float, wanted: str) -> Callable[[str], float]:
    """Reads a number that is at least so large; ``wanted`` says what is expected."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not minimum <= value < float("inf"):
            raise argparse.ArgumentTypeError(f"'{text}' is not {wanted}")
        return value

    return read
