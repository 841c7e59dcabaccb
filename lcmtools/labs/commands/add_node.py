"""``lcmtools pkg add-node``: it is here because it knows the labs' skeletons."""

import re
from pathlib import Path

from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import UsageError
from lcmtools.labs.skeletons import in_package, skeleton_text
from lcmtools.messages.type_source import shown
from lcmtools.packages.add_node import add_cpp_node, add_node, cpp_source
from lcmtools.packages.cpp_nodes import SUFFIXES
from lcmtools.packages.finding import find_package
from lcmtools.packages.workspace import workspace


@subcommand("add-node", json_option)
@examples(
    "pkg add-node evaluate_controller --skeleton evaluate_controller",
    "pkg add-node driver --package air_lab0",
    "pkg add-node air_lab0 driver.cpp",
)
@argument("name")
@argument("file", metavar="[FILE.cpp]", required=False, completer="files")
@option(
    "--package",
    metavar="NAME",
    help="The package (else that of this folder).",
    completer="runnables:packages",
)
@option(
    "--skeleton",
    metavar="NAME",
    help="Begin with a lab's skeleton.",
    completer="lcmtools.labs.commands.completion:skeletons",
)
@flag("--force", help="Overwrite an existing file.")
def command(
    *,
    name: str,
    file: str | None,
    package: str | None,
    skeleton: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Add a node to a package: its file, and the line that declares it in pyproject.toml.

    A file NAME.py that is in the package already is kept and only declared. With FILE.cpp, the node
    is in C++: its source is an existing file of the package, or a new one in its folder src, and
    CMakeLists.txt declares it. NAME may be left out if it is that of the file, or be the package's.
    """
    if file is not None and package is None and _is_package(name):
        name, file, package = file, None, name
    if file is None and name.endswith(SUFFIXES):
        name, file = Path(name).stem, name
    if file is not None and not file.endswith(SUFFIXES):
        raise UsageError(f"'{file}' is not a source in C++", "for Python, leave the file out")
    home = find_package(package, Path.cwd())
    text = None
    if skeleton is not None:
        text = skeleton_text(skeleton, is_cpp=file is not None)
        text = in_package(text, skeleton, home.name)
        text = re.sub(rf"\b{skeleton}\b", name, text)
    if file is None:
        paths = add_node(home, name, text, replace=force)
    else:
        source = cpp_source(home, file, Path.cwd())
        paths = add_cpp_node(home, name, source, text, replace=force)
    written = [shown(path) for path in paths]
    write_result({"package": home.name, "files": written}, written, as_json=as_json)
    if not as_json:
        build = f"lcmtools pkg build {home.name}; " if file else ""
        write_note(f"next: {build}lcmtools run {home.name} {name}")


def _is_package(name: str) -> bool:
    return any(one.name == name for one in workspace(Path.cwd()).packages)
