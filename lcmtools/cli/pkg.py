"""``lcmtools pkg``."""

import os
import shlex
from pathlib import Path

import click

from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.msg_build import build_folders
from lcmtools.cli.negative_numbers import CommandWithDeps
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.registry import packages
from lcmtools.messages.type_source import shown
from lcmtools.packages.cmake import (
    build_cpp,
    compiler_flags,
    cpp_folder,
    find_liblcm,
    has_cpp,
    wheel_prefix,
)
from lcmtools.packages.cpp_nodes import undeclared_sources
from lcmtools.packages.create import NewPackage, check, create
from lcmtools.packages.finding import find_packages, package_places, unknown_package
from lcmtools.packages.noted import VARIABLE, note_workspace, noted_workspaces
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import noting, workspace
from lcmtools.text_table import text_table


@subcommand("list", json_option)
@examples("pkg list", "pkg list --json")
def list_packages(*, as_json: bool) -> None:
    """List the packages of workspaces and those that are installed, with their folders.

    A workspace is a folder with packages, directly or in src: the nearest one, from the current
    folder upwards, and those that pkg create has noted or LCMTOOLS_PACKAGE_PATH names.
    """
    found = package_places(Path.cwd())
    for problem in workspace(Path.cwd()).problems:
        write_note(str(problem), "lcmtools pkg list")
    known = runnables(Path.cwd()) if as_json else []
    record = [
        {
            "name": name,
            "folder": str(folder),
            "is_installed": is_installed,
            "nodes": [node.name for node in known if node.package == name],
        }
        for name, (folder, is_installed) in found.items()
    ]
    rows = [(name, str(folder)) for name, (folder, _) in found.items()]
    write_result(record, text_table(rows), as_json=as_json)


@subcommand("find", json_option)
@examples("pkg find air_lab0", "pkg prefix air_lab0 --json")
@argument("name", completer="runnables:packages")
def find_command(name: str, *, as_json: bool) -> None:
    """Print the folder of a package."""
    found = package_places(Path.cwd())
    if name not in found:
        raise unknown_package(name, found, Path.cwd())
    folder, is_installed = found[name]
    record = {"name": name, "folder": str(folder), "is_installed": is_installed}
    write_result(record, [str(folder)], as_json=as_json)


@subcommand("build", json_option)
@examples("pkg build", "pkg build air_lab0")
@argument("name", required=False, completer="runnables:packages")
def build(name: str | None, *, as_json: bool) -> int:
    """Check and compile the messages and the C++ nodes of the workspace's packages, or of one.

    Python needs no building, and its messages are compiled when they are first used. CMake builds a
    package that has a CMakeLists.txt into its folder build. The exit code is 1 if there are errors.
    """
    chosen = find_packages(name, Path.cwd())
    code = build_folders([one.folder for one in chosen], as_json=as_json)
    for one in chosen if code == 0 else ():
        if has_cpp(one.folder):
            build_cpp(one.folder)
        for source in undeclared_sources(one.folder):
            adding = f"lcmtools pkg add-node {source.name} --package {one.name}"
            write_note(f"{shown(source)} is not a node yet; type: {adding}")
    if code == 0:
        write_note(f"ready: {', '.join(one.name for one in chosen)}")
    return code


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
def create_package(
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


@subcommand("cpp-path", json_option)
@examples(
    "pkg cpp-path",
    "pkg cpp-path --flags",
)
@flag("--flags", "with_flags", help="The compiler's flags, liblcm's included.")
@flag("--lcm", "of_lcm", help="The folder of the liblcm that pip has installed.")
def cpp_path(*, with_flags: bool, of_lcm: bool, as_json: bool) -> None:
    """Print the folder of the C++ headers and of their CMake package.

    A node is compiled by  g++ node.cpp $(lcmtools pkg cpp-path --flags)  or by CMake, with
    find_package(lcmtools) and -DCMAKE_PREFIX_PATH=$(lcmtools pkg cpp-path). The system's liblcm is
    used, or else the one that the Python package lcm brings.
    """
    if with_flags and of_lcm:
        raise UsageError("--flags and --lcm are two questions", "ask one at a time")
    folder = cpp_folder()
    if as_json:
        record = {
            "folder": str(folder),
            "pkg_config": str(folder / "pkgconfig"),
            "liblcm": find_liblcm().prefix or None,
            "flags": compiler_flags(),
        }
        write_result(record, [], as_json=True)
        return
    line = str(wheel_prefix()) if of_lcm else str(folder)
    write_result({}, [shlex.join(compiler_flags()) if with_flags else line], as_json=False)
