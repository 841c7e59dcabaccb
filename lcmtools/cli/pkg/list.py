"""``lcmtools pkg list``."""

from pathlib import Path

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines, talk
from lcmtools.cli.pkg.found import folders
from lcmtools.packages.nodes import runnables
from lcmtools.packages.workspace import workspace


@click.command("list", context_settings=CONTEXT)
@json_option
def command(*, as_json: bool) -> None:
    """List the packages of the workspace and those that are installed, with their folders.

    The workspace is the nearest folder, from the current one upwards, that holds packages.

    \b
    Examples:
      lcmtools pkg list
      lcmtools pkg list --json
    """  # noqa: D301 - \b is click's mark
    found = folders()
    for problem in workspace(Path.cwd()).problems:
        talk(str(problem), "lcmtools pkg list")
    if as_json:
        known = runnables(Path.cwd())
        document(
            [
                {
                    "name": name,
                    "folder": str(folder),
                    "is_installed": is_installed,
                    "nodes": [node.name for node in known if node.package == name],
                }
                for name, (folder, is_installed) in found.items()
            ]
        )
        return
    width = max((len(name) for name in found), default=0)
    lines(f"{name:{width}}  {folder}" for name, (folder, _) in found.items())
