"""Declaring commands: one way for their help, their options' types and their completion."""

from collections.abc import Callable
from typing import Any, TypeVar

import click

from lcmtools.cli.completion.completer import Completer
from lcmtools.errors import UsageError
from lcmtools.settings import parse_duration

CommandT = TypeVar("CommandT", bound=Callable[..., object])

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


def subcommand(
    name: str, *, cls: type[click.Command] = click.Command, **context: object
) -> Callable[[Callable[..., object]], click.Command]:
    """Make a function a command, with what its click context has besides the usual."""
    return click.command(name, cls=cls, context_settings={**CONTEXT, **context})


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
