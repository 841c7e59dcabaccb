"""``lcmtools msg packages``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines
from lcmtools.messages.registry import packages


@click.command("packages", context_settings=CONTEXT)
@json_option
def command(*, as_json: bool) -> None:
    """List the packages that have message types.

    \b
    Examples:
      lcmtools msg packages
      lcmtools msg packages --json
    """  # noqa: D301 - \b is click's mark
    if as_json:
        document(packages())
    else:
        lines(packages())
