"""``lcmtools pkg create``."""

import os
from pathlib import Path

import click

from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.negative_numbers import CommandWithDeps
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import packages
from lcmtools.packages.create import NewPackage, check, create
from lcmtools.packages.noted import VARIABLE, note_workspace, noted_workspaces
from lcmtools.packages.workspace import noting


@subcommand("create", json_option, cls=CommandWithDeps)
@examples(
    "pkg create air_lab0 --deps nav_msgs geometry_msgs --node simple_controller",
    "pkg create air_lab0 ~/labs --msg ControllerEvaluationStat",
)
@argument("name")
@argument("folder", metavar="[DIR]", default=".", type=click.Path())
@option(
    "--deps",
    "--dependencies",
    "dependencies",
    multiple=True,
    metavar="PACKAGE...",
    help="Message packages that the package uses.",
    completer="messages:packages",
)
@option("--node", metavar="NAME", help="The node's name (else NAME_node).")
@option("--msg", "message", metavar="NAME", default="", help="A new message type.")
@option(
    "--license",
    "license_",
    metavar="SPDX",
    default="",
    help="For example MIT.",
    completer=("Apache-2.0", "BSD-3-Clause", "GPL-3.0-only", "LGPL-2.1-only", "MIT"),
)
@flag("--cpp", "is_cpp", help="A node in C++; lcmtools pkg build compiles it.")
@flag("--force", help="Overwrite existing files.")
def command(
    *,
    name: str,
    folder: str,
    dependencies: tuple[str, ...],
    node: str | None,
    message: str,
    license_: str,
    is_cpp: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Create a small package: a node, a launch file, a test and, with --msg, a message type.

    It is written to the folder NAME in DIR, or in the current folder, and needs no installation.
    That folder, a workspace, is noted: lcmtools finds the packages in it from everywhere. lcmtools
    config shows the noted ones.
    """
    wanted = [one for word in dependencies for one in word.split(",") if one]
    new = NewPackage(
        name,
        node or f"{name}_node",
        message,
        tuple(dict.fromkeys(wanted)),
        license_.strip(),
        is_cpp,
    )
    check(new, packages())
    place = Path(folder).expanduser() / name
    written = create(new, place, replace=force)
    record = {"folder": str(place), "files": [str(path) for path in written]}
    write_result(record, (str(place / path) for path in written), as_json=as_json)
    is_found = _note(Path(os.path.abspath(place)))  # noqa: PTH100 - keeps links
    if not as_json:
        where = "" if is_found or folder == "." else f"cd {folder}; "
        build = f"lcmtools pkg build {name}; " if is_cpp else ""
        write_note(f"next: {where}{build}lcmtools run {name} {new.node}")


def _note(package: Path) -> bool:
    """Note a package's workspace, and say so if it is new; return True if it is found."""
    space = noting(package)
    is_known = space in noted_workspaces(os.environ).folders
    try:
        is_noted = note_workspace(space, os.environ)
    except LcmtoolsError as error:
        write_note(f"{error}; the package is found only from {space}")
        return False
    if is_noted and not is_known:
        what = f"{space} is noted as a workspace, a folder with packages"
        write_note(f"{what}: they are found from everywhere (see lcmtools config)")
    elif not is_noted:
        write_note(f"the package is found only from {space}, which is not in {VARIABLE}")
    return is_noted
