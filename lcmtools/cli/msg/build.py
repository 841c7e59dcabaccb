"""``lcmtools msg build``."""

from pathlib import Path

import click

from lcmtools.cli.msg.building import build_folders
from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.packages.user_types import user_types


@click.command("build", context_settings=CONTEXT)
@click.argument("folder", metavar="[DIR]", required=False, type=click.Path())
@json_option
def command(folder: str | None, *, as_json: bool) -> int:
    """Check and compile the .lcm files in DIR, or in LCMTOOLS_TYPE_PATH and the workspace.

    Nothing needs this: types are compiled when they are first used. It says at once what is wrong.
    The exit code is 1 if anything is.

    \b
    Examples:
      lcmtools msg build
      lcmtools msg build air_lab0/msg
    """  # noqa: D301 - \b is click's mark
    chosen = [Path(folder).absolute()] if folder else user_types().near_folders()
    if folder and not chosen[0].is_dir():
        raise UsageError(f"there is no folder {folder}")
    if not chosen:
        raise LcmtoolsError(
            "there are no folders with .lcm files", "name one, or set LCMTOOLS_TYPE_PATH"
        )
    return build_folders(chosen, as_json=as_json)
