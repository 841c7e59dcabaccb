"""The programs of nodes: from the names in a launch file to a command line.

Belongs here: ``pkg`` and ``type`` of a ``<node>``, and ``run:``. Must not know launch files.
All programs are looked up before any is started.
"""

import os
import shlex
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.launch.packages import is_there, lab_packages, package_folder, path_from
from lcmtools.names import did_you_mean
from lcmtools.packages.finding import find_node, own_answer, undeclared
from lcmtools.packages.programs import (
    RUN,
    built_program,
    command_of,
    program_in,
    python_command,
)
from lcmtools.packages.runnable_nodes import OWN, Runnable, runnables
from lcmtools.packages.workspace import workspace
from lcmtools.ros_words.nodes import PACKAGES, SAME_NODE

_TUTORIALS = ("beginner_tutorials", "my_package")
"""Packages that the labs' texts name, whose nodes lcmtools has under the same names."""


@dataclass(frozen=True, slots=True)
class Executable:
    """The program of a node."""

    command: tuple[str, ...]  # the words that start it
    directory: str = ""  # the directory that it must be run in; "" for any
    arguments: tuple[str, ...] = ()  # the words after them in the file
    takes_names: bool = True  # True if it reads ``__ns:=`` etc., as nodes do
    note: str = ""  # a sentence on whose program it is, if another may be meant


def find_executable(package: str, name: str, folder: Path) -> Executable:
    """Return the command of a package's node, as ``pkg`` and ``type`` name it; UsageError for none.

    The package is in the workspace (also that of the launch file's folder), installed, or one that
    the labs' texts name. A script's name may have its suffix.
    """
    plain = name.removesuffix(".py")
    known = _nodes_from(Path.cwd(), folder)
    nodes = {node.name: node for node in known if node.package == package}
    for word in (name, plain):
        if package != OWN and word in nodes:
            return _of_node(nodes[word], (package, word), folder)
    if package != OWN and (script := _script(package, name, folder)):
        return Executable(command_of(script))
    in_workspace = (one.name for one in workspace(Path.cwd(), folder).packages)
    is_own = package in _as_lcmtools() and package not in in_workspace
    nodes = {node.name: node for node in known if node.package == OWN} if is_own else nodes
    for spelling in (plain, SAME_NODE.get(plain, plain)):
        if is_own and spelling in nodes:
            return _own(spelling, known, package)
    if not nodes:
        package_folder(package, folder)  # raises UsageError for an unknown package
    if error := undeclared((package, plain), known, (Path.cwd(), folder)):
        raise error
    listed = f"it has {', '.join(sorted(nodes))}" if nodes else "make its file executable: chmod +x"
    hint = did_you_mean(name, nodes) or listed
    raise UsageError(f"there is no node '{name}' in the package {package}", hint)


def find_typed(words: Sequence[str], folder: Path) -> Executable:
    """Return the program for words as after ``lcmtools run``; further words are arguments.

    Raises:
        UsageError: There is no such node or program, or several packages have it.
    """
    known = _nodes_from(Path.cwd(), folder)
    try:
        node, rest = find_node(words, known, Path.cwd(), folder)
    except UsageError as error:
        failure = error
    else:
        note = own_answer(node) if words[0] == node.name else ""
        typed = (OWN, node.name) if note else words[: len(words) - len(rest)]
        return replace(_of_node(node, typed, folder), arguments=tuple(rest), note=note)
    if len(words) > 1 and (program := _script(words[0], words[1], folder)):
        return Executable(command_of(program), arguments=tuple(words[2:]))
    if len(words) > 1 and words[0] in _as_lcmtools():
        return replace(find_executable(words[0], words[1], folder), arguments=tuple(words[2:]))
    if shutil.which(words[0]) or is_there(path_from(folder, words[0])):
        hint = f"write a program as  exec: {words[0]}"
        hint += f",  args: {shlex.join(words[1:])}" if words[1:] else ""
        raise UsageError(failure.what, hint)
    raise failure


def find_program(word: str, folder: Path) -> str:
    """Find a program by its path relative to a folder, or by its name; else raise UsageError."""
    if "/" not in word:
        if shutil.which(word) is None:
            raise UsageError(f"there is no program '{word}' on the PATH", "write a path: ./name")
        return word
    path = path_from(folder, word)
    if not is_there(path):
        raise UsageError(f"there is no program {path}")
    if not os.access(path, os.X_OK):
        raise UsageError(f"{path} is not executable", f"type: chmod +x {shlex.quote(str(path))}")
    return str(path)


def find_script(word: str, folder: Path) -> tuple[str, ...]:
    """Return the command of a file that is a node; this Python runs Python files.

    Raises:
        UsageError: There is none, or it is not executable.
    """
    path = path_from(folder, word)
    if path.suffix == ".py" and path.is_file() and not os.access(path, os.X_OK):
        return python_command(path)
    return command_of(Path(find_program(str(path), folder)))


def _own(name: str, known: Sequence[Runnable], package: str) -> Executable:
    """Return the command of lcmtools' own node, which a launch file names with another package.

    The command of a model answer names its package, so that only the launcher notes it.
    """
    node = next(node for node in known if (node.package, node.name) == (OWN, name))
    answer = own_answer(node)
    is_hidden = any(node.name == name and node.is_near for node in known)
    words = (OWN, name) if answer or is_hidden else (name,)
    return Executable((*RUN, *words), note="" if package == OWN else answer)


def _of_node(node: Runnable, typed: Sequence[str], folder: Path) -> Executable:
    if node.source:
        return Executable((str(built_program(node)),))
    return Executable((*RUN, *typed), _directory(node, folder))


def _directory(node: Runnable, folder: Path) -> str:
    """Return the directory from which a node of the launch file's workspace is found."""
    is_here = node.folder is None or node in _nodes_from(Path.cwd())
    return "" if is_here else str(folder)


@lru_cache(maxsize=4)
def _nodes_from(*starts: Path) -> tuple[Runnable, ...]:
    """Return the nodes of folders' workspaces and of installed packages, which takes a moment."""
    return tuple(runnables(*starts))


def _as_lcmtools() -> set[str]:
    return {OWN, *lab_packages(), *_TUTORIALS, *PACKAGES}


def _script(package: str, name: str, folder: Path) -> Path | None:
    """Return an executable file in a package's folder; UsageError if there are several."""
    try:
        home = package_folder(package, folder)
    except UsageError:
        return None
    return program_in(home, name)
