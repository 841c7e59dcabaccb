"""Declaring commands: one way for their help, their options' types and their completion."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from inspect import cleandoc
from typing import Any, TypeVar

import click

from lcmtools.cli.completion import Source
from lcmtools.errors import UsageError
from lcmtools.settings import parse_bytes, parse_duration

CommandT = TypeVar("CommandT", bound=Callable[..., object])

_DIGITS = 18  # of a count, which then fits into 64 bits
_LEAST_RATE = 1e-9  # [Hz]; a clock does not hold longer periods
CONTEXT: Mapping[str, Any] = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


def subcommand(
    name: str,
    *usual: Callable[[click.Command], object],
    cls: type[click.Command] = click.Command,
    **context: object,
) -> Callable[[Callable[..., object]], click.Command]:
    """Make a function a command, with additional settings of its click context.

    The ``usual`` options follow those that are declared between this line and the function.
    """

    def declare(function: Callable[..., object]) -> click.Command:
        command = click.command(name, cls=cls, context_settings={**CONTEXT, **context})(function)
        together(*usual)(command)
        return command

    return declare


FunctionT = TypeVar("FunctionT", bound=Callable[..., object])


def examples(*lines: str) -> Callable[[FunctionT], FunctionT]:
    """Append example command lines, without "lcmtools ", to a command's docstring."""

    def declare(function: FunctionT) -> FunctionT:
        function.__doc__ = with_examples(cleandoc(function.__doc__ or ""), lines)
        return function

    return declare


def with_examples(text: str, lines: Iterable[str]) -> str:
    """Append examples to a help text."""
    return "\n".join([text, "", "\b", "Examples:", *(f"  lcmtools {line}" for line in lines)])


def together(*parts: Callable[[Any], Any]) -> Callable[[CommandT], CommandT]:
    """Combine options and arguments into one decorator of a function or a command."""

    def declare(command: CommandT) -> CommandT:
        # click appends to a command what it prepends to a function
        for part in parts if isinstance(command, click.Command) else reversed(parts):
            command = part(command)
        return command

    return declare


class _Argument(click.Argument):
    def __init__(self, *names: Any, completer: Source = "", **settings: Any) -> None:  # noqa: ANN401
        super().__init__(*names, **settings)
        self.completer = completer


class _Option(click.Option):
    def __init__(self, *names: Any, completer: Source = "", **settings: Any) -> None:  # noqa: ANN401
        super().__init__(*names, **settings)
        self.completer = completer


argument = partial(click.argument, cls=_Argument)
"""Adds an argument to a command; ``completer`` is the source of its candidates."""
option = partial(click.option, cls=_Option)
"""Adds an option to a command; ``completer`` is the source of its value's candidates."""
flag = partial(option, is_flag=True)  # adds an option that takes no value


def accepted_for_ros(*names: str) -> Callable[[CommandT], CommandT]:
    """Accept a flag of ROS that has no effect here, so that a line copied from there runs."""
    return flag(*names, expose_value=False, hidden=True)


def duration(value: str | float) -> float:
    """Parse a time span into seconds: ``2``, ``500ms``, ``1m`` or ``1h``; for ``type=``."""
    try:
        return parse_duration(str(value))
    except UsageError as error:
        raise click.BadParameter(str(error)) from None


def size(value: str | int) -> int:
    """Parse a size into bytes: ``500MB``, ``1GB``; for ``type=``."""
    try:
        return parse_bytes(str(value))
    except UsageError as error:
        raise click.BadParameter(str(error)) from None


def rate(value: str | float) -> float:
    """Parse a positive rate [Hz]; for ``type=``."""
    try:
        number = float(value)
    except ValueError:
        raise click.BadParameter(f"'{value}' is not a number") from None
    if not _LEAST_RATE < number < float("inf"):
        raise click.BadParameter("the rate must be greater than zero")
    return number


def whole_number(lowest: int) -> Callable[[str | int], int]:
    """Return a parser of whole numbers of at least ``lowest``, for ``type=``."""

    def read(value: str | int) -> int:
        text = str(value)
        is_number = text.isascii() and text.isdigit() and len(text) <= _DIGITS
        if not is_number or int(text) < lowest:
            raise click.BadParameter(f"'{value}' is not a whole number from {lowest} on")
        return int(text)

    return read
