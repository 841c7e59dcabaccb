"""``lcmtools pkg build``."""

from pathlib import Path

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.msg.build import build_folders
from lcmtools.cli.options import json_option
from lcmtools.cli.output import talk
from lcmtools.cli.pkg.list import unknown_package
from lcmtools.errors import LcmtoolsError
from lcmtools.packages.workspace import workspace


@subcommand("build")
@argument("name", required=False, completer="programs:packages")
@json_option
def command(name: str | None, *, as_json: bool) -> int:
    """Check and compile the messages of the workspace's packages, or of one.

    Nothing needs this: messages are compiled when they are first used. It says at once what is
    wrong. The exit code is 1 if anything is.

    \b
    Examples:
      lcmtools pkg build
      lcmtools pkg build air_lab0
    """
    found = workspace(Path.cwd()).packages
    chosen = [one for one in found if name in (None, one.name)]
    if not chosen and name:
        raise unknown_package(name, (one.name for one in found))
    if not chosen:
        raise LcmtoolsError("there is no package here", "lcmtools pkg create NAME makes one")
    code = build_folders([one.folder for one in chosen], as_json=as_json)
    if code == 0:
        talk(f"ready: {', '.join(one.name for one in chosen)}")
    return code
