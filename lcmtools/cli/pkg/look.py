"""``lcmtools pkg list``, ``find`` and ``build``."""

from pathlib import Path

from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.msg.build import build_folders
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.messages.type_source import shown
from lcmtools.packages.cmake import build_cpp, has_cpp
from lcmtools.packages.cpp_nodes import undeclared_sources
from lcmtools.packages.finding import find_packages, package_places, unknown_package
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import workspace
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
