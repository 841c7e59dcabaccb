"""Declaring commands: one way for their help, their options' types and their completion."""

from collections.abc import Callable, Iterable
from inspect import cleandoc
from typing import Any, TypeVar

import click

from lcmtools.cli.completion.completer import Completer
from lcmtools.errors import UsageError
from lcmtools.settings import parse_duration

CommandT = TypeVar("CommandT", bound=Callable[..., object])

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


def subcommand(
    name: str,
    *usual: Callable[[click.Command], object],
    cls: type[click.Command] = click.Command,
    **context: object,
) -> Callable[[Callable[..., object]], click.Command]:
    """Make a function a command, with what its click context has besides the usual.

    The ``usual`` options follow those that are declared between this line and the function.
    """

    def declare(function: Callable[..., object]) -> click.Command:
        command = click.command(name, cls=cls, context_settings={**CONTEXT, **context})(function)
        together(*usual)(command)
        return command

    return declare


FunctionT = TypeVar("FunctionT", bound=Callable[..., object])


def examples(*lines: str) -> Callable[[FunctionT], FunctionT]:
    """End a command's help, which is its docstring, with command lines behind "lcmtools "."""

    def declare(function: FunctionT) -> FunctionT:
        function.__doc__ = with_examples(cleandoc(function.__doc__ or ""), lines)
        return function

    return declare


def with_examples(text: str, lines: Iterable[str]) -> str:
    """Return a help text with examples at its end."""
    return "\n".join([text, "", "\b", "Examples:", *(f"  lcmtools {line}" for line in lines)])


def together(*parts: Callable[[Any], Any]) -> Callable[[CommandT], CommandT]:
    """Make several options and arguments one decorator, of a function or of a command."""

    def declare(command: CommandT) -> CommandT:
        # click appends to a command what it prepends to a function
        for part in parts if isinstance(command, click.Command) else reversed(parts):
            command = part(command)
        return command

    return declare


def argument(
    *names: str,
    completer: str | tuple[str, ...] = "",
    **settings: Any,  # noqa: ANN401 - click's own
) -> Callable[[CommandT], CommandT]:
    """Add an argument, completed by "module:function", "files" or words; see ``Completer``."""
    return click.argument(*names, **_with_completer(completer, settings))


def option(
    *names: str,
    completer: str | tuple[str, ...] = "",
    **settings: Any,  # noqa: ANN401 - click's own
) -> Callable[[CommandT], CommandT]:
    """Add an option, completed by "module:function", "files" or words; see ``Completer``."""
    return click.option(*names, **_with_completer(completer, settings))


def _with_completer(completer: str | tuple[str, ...], settings: dict[str, Any]) -> dict[str, Any]:
    if not completer:
        return settings
    source = completer if isinstance(completer, str) else [[word] for word in completer]
    return {"shell_complete": Completer(source), **settings}


def duration(value: str | float) -> float:
    """Parse a time span into seconds: ``2``, ``2s``, ``500ms`` or ``1m``; for ``type=``."""
    try:
        return parse_duration(str(value))
    except UsageError as error:
        raise click.BadParameter(str(error)) from None


def rate(value: str | float) -> float:
    """Parse a rate in Hz, which is positive; for ``type=``."""
    try:
        number = float(value)
    except ValueError:
        raise click.BadParameter(f"'{value}' is not a number") from None
    if not 0 < number < float("inf"):
        raise click.BadParameter("the rate must be greater than zero")
    return number


def whole_number(lowest: int) -> Callable[[str | int], int]:
    """Return a parser of whole numbers from ``lowest`` on, for ``type=``."""

    def read(value: str | int) -> int:
        text = str(value)
        if not (text.isascii() and text.isdigit() and int(text) >= lowest):
            raise click.BadParameter(f"'{value}' is not a whole number from {lowest} on")
        return int(text)

    return read
