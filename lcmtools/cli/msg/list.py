"""``lcmtools msg list``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines, talk
from lcmtools.messages.registry import problems, type_names


@click.command("list", context_settings=CONTEXT)
@json_option
def command(*, as_json: bool) -> None:
    """List the message types that lcmtools knows.

    \b
    Examples:
      lcmtools msg list
      lcmtools msg list --json
    """  # noqa: D301 - \b is click's mark
    for problem in problems():
        talk(str(problem.error()), "lcmtools msg list")
    if as_json:
        document(type_names())
    else:
        lines(type_names())
