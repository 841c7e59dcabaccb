"""``lcmtools msg packages``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines
from lcmtools.messages.registry import packages


@click.command("packages", context_settings=CONTEXT)
@click.option("-s", "--single-line", is_flag=True, help="All in one line, with blanks between.")
@json_option
def command(*, single_line: bool, as_json: bool) -> None:
    """List the packages that have message types.

    \b
    Examples:
      lcmtools msg packages
      lcmtools msg packages --json
    """  # noqa: D301 - \b is click's mark
    if as_json:
        document(packages())
    else:
        lines([" ".join(packages())] if single_line else packages())
