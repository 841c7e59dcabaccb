"""``lcmtools pkg create``."""

from pathlib import Path

import click

from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.negative_numbers import CommandWithDeps
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.messages.registry import packages
from lcmtools.packages.create import NewPackage, check, create


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
@flag("--force", help="Overwrite existing files.")
def command(
    *,
    name: str,
    folder: str,
    dependencies: tuple[str, ...],
    node: str | None,
    message: str,
    license_: str,
    force: bool,
    as_json: bool,
) -> None:
    """Create a small package: a node, a launch file, a test and, with --msg, a message type.

    It is written to the folder NAME in DIR, or in the current folder, and needs no installation.
    """
    wanted = [one for word in dependencies for one in word.split(",") if one]
    new = NewPackage(
        name, node or f"{name}_node", message, tuple(dict.fromkeys(wanted)), license_.strip()
    )
    check(new, packages())
    place = Path(folder).expanduser() / name
    written = create(new, place, replace=force)
    record = {"folder": str(place), "files": [str(path) for path in written]}
    write_result(record, (str(place / path) for path in written), as_json=as_json)
    if not as_json:
        where = "" if folder == "." else f"cd {folder}; "
        write_note(f"next: {where}lcmtools run {name} {new.node}")
