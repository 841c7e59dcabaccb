"""``lcmtools lab skeleton``."""

from pathlib import Path

import click

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import UsageError
from lcmtools.labs.skeletons import NAMES, copy_skeleton


@subcommand("skeleton")
@option("-l", "--list", "show_list", is_flag=True, help="List the skeletons.")
@option("--force", is_flag=True, help="Overwrite an existing file.")
@json_option
@argument("name", required=False, completer="lcmtools.labs.commands.completion:skeletons")
@argument("folder", metavar="DIR", default=".", type=click.Path(path_type=Path))
def command(name: str | None, folder: Path, *, show_list: bool, force: bool, as_json: bool) -> None:
    """Copy a lab's node with TODOs into DIR (else here), to complete.

    It runs unchanged, with python; its first lines show the command.

    \b
    Examples:
      lcmtools lab skeleton simple_controller
      lcmtools lab skeleton kinect_viewer my_lab
    """
    if show_list and name:
        raise UsageError("--list takes no skeleton's name", "leave out one of them")
    if show_list:
        document(list(NAMES)) if as_json else lines(NAMES)
        return
    if not name:
        raise UsageError(
            "the skeleton's name is missing", "lcmtools lab skeleton --list shows them"
        )
    path = copy_skeleton(name, folder, overwrite=force)
    document({"file": str(path)}) if as_json else lines([str(path)])
    talk(f"fill in its TODOs, and run it: python {path}")
