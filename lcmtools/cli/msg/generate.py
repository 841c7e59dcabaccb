"""``lcmtools msg generate``."""

from pathlib import Path

import click

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import show, talk
from lcmtools.packages.lcm_gen import LANGUAGES, generate_code
from lcmtools.packages.user_types import sources_of


@subcommand("generate")
@option("--lang", required=True, type=click.Choice(LANGUAGES), help="The language.")
@argument("folder", metavar="DIR", type=click.Path())
@argument("types", nargs=-1, completer="messages:types")
@json_option
def command(*, lang: str, folder: str, types: tuple[str, ...], as_json: bool) -> None:
    """Write code for message types into DIR with lcm-gen, for programs on plain LCM.

    TYPES are types or packages, shipped or your own; none means all your own. Types that they are
    made of are written too.

    \b
    Examples:
      lcmtools msg generate --lang cpp generated geometry_msgs/Twist std_msgs/String
      lcmtools msg generate --lang c generated air_lab0
    """
    written = list(map(str, generate_code(sources_of(types), lang, Path(folder).expanduser())))
    show(written, written, as_json=as_json)
    if not as_json:
        talk(f"{len(written)} file{'s'[: len(written) != 1]} in {folder}")
