"""``lcmtools msg package``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines
from lcmtools.errors import UnknownType
from lcmtools.messages.registry import packages, type_names
from lcmtools.names import did_you_mean


@click.command("package", context_settings=CONTEXT)
@click.argument("package", shell_complete=complete("messages:packages"))
@click.option("-s", "--single-line", is_flag=True, help="All in one line, with blanks between.")
@json_option
def command(package: str, *, single_line: bool, as_json: bool) -> None:
    """List the message types of a package.

    \b
    Examples:
      lcmtools msg package geometry_msgs
      lcmtools msg package std_msgs --json
    """  # noqa: D301 - \b is click's mark
    found = [name for name in type_names() if name.startswith(f"{package}/")]
    if not found:
        hint = did_you_mean(package, packages()) or "see: lcmtools msg packages"
        raise UnknownType(f"unknown package '{package}'", hint)
    if as_json:
        document(found)
    else:
        lines([" ".join(found)] if single_line else found)
