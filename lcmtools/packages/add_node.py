"""Adding a node to a package: its file, and its lines in pyproject.toml or CMakeLists.txt.

Belongs here: what is written, and that nothing else in the package changes.
"""

import os
import re
from pathlib import Path

from lcmtools.errors import InvalidName, LcmtoolsError, UsageError, os_errors_as
from lcmtools.folders import read_text, write_whole
from lcmtools.messages.registry import packages
from lcmtools.messages.type_source import shown
from lcmtools.packages.cpp_nodes import PROJECT, included, parts_of, source_text
from lcmtools.packages.create import (
    NewPackage,
    check_node_name,
    cmake_entry,
    cmake_text,
    node_text,
)
from lcmtools.packages.finding import has_main
from lcmtools.packages.runnable_nodes import GROUP, TABLE, Runnable, entry, workspace_nodes
from lcmtools.packages.workspace import Package, load_toml, read_project, table

_HEADER = re.compile(r'\s*\[\s*project\s*\.\s*entry-points\s*\.\s*["\']lcmtools\.nodes["\']\s*\]')
_TARGETS = ("all", "clean", "help", "install", "package", "test")  # of every CMake project
_MAINS = (
    "give it one:  int main(int argc, char** argv)  that calls lcmtools::init",
    "give it one:  def main(args=None):  that calls lcmtools.init(args)",
)
"""Hints at what a node needs: in C++, and in Python."""


def add_node(
    package: Package, name: str, text: str | None = None, *, replace: bool = False
) -> list[Path]:
    """Add a node to a package; return the written files. An existing file is only declared.

    Without ``text`` the file gets the text of a new package's node. With ``replace`` the new node
    replaces an existing one.

    Raises:
        InvalidName: A name breaks a rule.
        UsageError: The node exists already, or there is a file that cannot be a node.
        LcmtoolsError: A file cannot be read or written.
    """
    check_node_name(name)
    file = _module(package, name)
    is_declared = _is_declared(package, name, file, text, replace=replace)
    project = package.folder / "pyproject.toml"
    node = Runnable(package.name, name, "")
    texts = {} if is_declared else {project: _declared(project, node)}
    return _written(texts, file, text or node_text(_new(package, name)), replace=replace)


def add_cpp_node(
    package: Package, name: str, file: Path, text: str | None = None, *, replace: bool = False
) -> list[Path]:
    """Add a node in C++ whose source is a file in the package's folder, as ``add_node`` does.

    It is declared with the packages of message types that the source includes.
    """
    check_node_name(name)
    if name in _TARGETS:
        raise InvalidName(f"CMake has a target '{name}' of its own", "use another name")
    is_declared = _is_declared(package, name, file, text, replace=replace)
    if file.exists() and not replace:
        text = read_text(file)
    text = text or node_text(_new(package, name, is_cpp=True))
    project = package.folder / PROJECT
    before = read_text(project) if project.exists() else cmake_text(package.name)
    parts = [one for one in parts_of(file) if one.is_relative_to(package.folder)]
    whole = "\n".join([text, *map(source_text, parts[1:])])
    types = included(whole, packages()) or _dependencies(package) or ["std_msgs"]
    sources = " ".join(str(one.relative_to(package.folder)) for one in parts)
    entry = cmake_entry(name, sources, types)
    gap = "\n" if "add_executable" in before else ""
    texts = {} if is_declared else {project: f"{before.rstrip()}\n{gap}{entry}"}
    return _written(texts, file, text, replace=replace)


def cpp_source(package: Package, file: str, here: Path) -> Path:
    """Return the path of a package's source in C++: an existing file, else one in its folder src.

    Raises:
        UsageError: The file is outside the package.
    """
    places = [here / file, package.folder / file, package.folder / "src" / file]
    places = [Path(os.path.abspath(place)) for place in places]  # noqa: PTH100 - keeps links
    inside = [place for place in places if place.is_relative_to(package.folder)]
    if found := next((place for place in inside if place.is_file()), None):
        return found
    if places[0].is_file() or not inside:
        what = f"{shown(places[0])} is outside the package {package.name}"
        raise UsageError(what, f"move it into {shown(package.folder / 'src')}")
    return inside[0] if "/" in file else inside[-1]


def _is_declared(
    package: Package, name: str, file: Path, text: str | None, *, replace: bool
) -> bool:
    """Return True if a node is declared; raise UsageError if it cannot be added with this file."""
    node = next((one for one in workspace_nodes(package) if one.name == name), None)
    is_kept = file.exists() and not replace
    if is_kept and text is not None:
        raise UsageError(f"{shown(file)} already exists", "--force overwrites it")
    source = (node.source or _module(package, name)) if node else file
    if node and (is_kept or source != file):
        raise UsageError(f"{package.name} has a node '{name}' already: {shown(source)}")
    if is_kept and not has_main(file):
        raise UsageError(f"{shown(file)} has no function main", _MAINS[file.suffix == ".py"])
    return node is not None


def _module(package: Package, name: str) -> Path:
    return package.import_folder() / package.name / f"{name}.py"


def _written(texts: dict[Path, str], file: Path, text: str, *, replace: bool) -> list[Path]:
    """Write the texts, and the node's file unless it is to stay; return the written files."""
    if replace or not file.exists():
        texts[file] = text
    for path, content in texts.items():
        with os_errors_as(f"cannot write {path}"):
            path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
    return sorted(texts)


def _new(package: Package, name: str, *, is_cpp: bool = False) -> NewPackage:
    return NewPackage(package.name, name, dependencies=_dependencies(package), is_cpp=is_cpp)


def _dependencies(package: Package) -> list[str]:
    deps = table(read_project(package.folder), "tool", "lcmtools").get("deps")
    return [str(one) for one in deps] if isinstance(deps, list) else []


def _declared(project: Path, node: Runnable) -> str:
    """Return the text of a pyproject.toml with the line that declares a node."""
    lines = read_text(project).splitlines()
    header = next((i for i, line in enumerate(lines) if _HEADER.match(line)), None)
    if header is None:
        lines += ["", TABLE, entry(node)]
    else:
        tables = (i for i in range(header + 1, len(lines)) if lines[i].lstrip().startswith("["))
        end = next(tables, len(lines))
        while not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#"):
            end -= 1
        lines.insert(end, entry(node))
    text = "\n".join(lines) + "\n"
    try:
        is_found = node.name in table(load_toml(text), "project", "entry-points", GROUP)
    except ValueError:
        is_found = False
    if not is_found:
        hint = f"write it below [project]:  {entry(node)}  as an entry point of {GROUP}"
        raise LcmtoolsError(f"{shown(project)} declares its nodes in an unusual way", hint)
    return text
