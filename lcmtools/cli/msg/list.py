"""``lcmtools msg list``, ``msg package`` and ``msg packages``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import show, talk
from lcmtools.errors import UnknownType
from lcmtools.messages.registry import packages, problems, type_names
from lcmtools.names import did_you_mean

_single_line_option = option(
    "-s", "--single-line", is_flag=True, help="All in one line, with blanks between."
)


@subcommand("list")
@json_option
def command(*, as_json: bool) -> None:
    """List the message types that lcmtools knows.

    \b
    Examples:
      lcmtools msg list
      lcmtools msg list --json
    """
    for problem in problems():
        talk(str(problem.error()), "lcmtools msg list")
    show(type_names(), type_names(), as_json=as_json)


@subcommand("package")
@argument("package", completer="messages:packages")
@_single_line_option
@json_option
def package_command(package: str, *, single_line: bool, as_json: bool) -> None:
    """List the message types of a package.

    \b
    Examples:
      lcmtools msg package geometry_msgs
      lcmtools msg package std_msgs --json
    """
    found = [name for name in type_names() if name.startswith(f"{package}/")]
    if not found:
        hint = did_you_mean(package, packages()) or "see: lcmtools msg packages"
        raise UnknownType(f"unknown package '{package}'", hint)
    show(found, [" ".join(found)] if single_line else found, as_json=as_json)


@subcommand("packages")
@_single_line_option
@json_option
def packages_command(*, single_line: bool, as_json: bool) -> None:
    """List the packages that have message types.

    \b
    Examples:
      lcmtools msg packages
      lcmtools msg packages --json
    """
    found = packages()
    show(found, [" ".join(found)] if single_line else found, as_json=as_json)
