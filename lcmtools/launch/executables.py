"""The programs of nodes: from the names in a launch file to a command line.

Belongs here: ``pkg`` and ``type`` of a ``<node>``, and ``run:``. Must not know launch files.
Everything is found before anything is started.
"""

import os
import shlex
import shutil
import sys
import sysconfig
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.launch.packages import files_below, find_package, is_there, lab_packages, path_from
from lcmtools.names import did_you_mean
from lcmtools.packages.nodes import OWN, Runnable, find_node, runnables

RUN = ("lcmtools", "run")
_SAME_NODE = {
    "teleop_twist_keyboard": "teleop",
    "pioneer_teleop": "pioneer_manual_controller",
    "gazebo": "sim",
    "gzserver": "sim",
    "morse": "sim",
}
"""Other names of lcmtools' nodes in the labs' texts and in ROS."""
_ROS_PACKAGES = {
    "beginner_tutorials",
    "image_view",
    "my_package",
    "morse",
    "rqt_robot_steering",
    "teleop_twist_keyboard",
}
"""Packages of ROS whose nodes lcmtools has under the same names; besides the labs' own."""


@dataclass(frozen=True, slots=True)
class Executable:
    """The command line of a node, and the directory that it must be run in; "" for any."""

    command: tuple[str, ...]
    directory: str = ""


def find_executable(package: str, name: str, folder: Path) -> Executable:
    """Return the command of a package's node, as ``pkg`` and ``type`` name it.

    Args:
        package: Of the workspace, installed, or one that the labs' texts name.
        name: The node's name in it; a script's with or without its suffix.
        folder: The launch file's, whose workspace counts too.

    Raises:
        UsageError: There is no such package, or no such node in it.
    """
    plain = name.removesuffix(".py")
    for start in (Path.cwd(), folder):
        own = {node.name for node in _nodes_from(start) if node.package == package != OWN}
        if word := next((word for word in (name, plain) if word in own), ""):
            directory = "" if start == Path.cwd() else str(folder)
            return Executable((*RUN, package, word), directory)
    if package != OWN and (script := _script(package, name, folder)):
        return Executable((script,))
    nodes = _nodes_of(package, folder)
    for spelling in (plain, _SAME_NODE.get(plain, plain)):
        if package in _as_lcmtools() and spelling in nodes:
            return Executable((*RUN, spelling))
    if not nodes:
        find_package(package, folder)  # says that there is none
    listed = f"it has {', '.join(sorted(nodes))}" if nodes else "make its file executable: chmod +x"
    hint = did_you_mean(name, nodes) or listed
    raise UsageError(f"there is no node '{name}' in the package {package}", hint)


def find_typed(words: Sequence[str], folder: Path) -> tuple[Executable, list[str]]:
    """Return the command of the node that words mean after ``lcmtools run``, and the words after.

    Raises:
        UsageError: There is no such node, or several packages have it.
    """
    for start in (Path.cwd(), folder):
        try:
            _, rest = find_node(words, _nodes_from(start))
        except UsageError as error:
            failure = error
            continue
        typed = words[: len(words) - len(rest)]
        return Executable((*RUN, *typed), "" if start == Path.cwd() else str(folder)), rest
    if len(words) > 1 and words[0] in _as_lcmtools():
        return find_executable(words[0], words[1], folder), list(words[2:])
    if shutil.which(words[0]) or is_there(path_from(folder, words[0])):
        hint = f"a program is written so:  exec: {words[0]}"
        raise UsageError(
            failure.what, f"{hint},  args: {shlex.join(words[1:])}" if words[1:] else hint
        )
    raise failure


def find_program(word: str, folder: Path) -> str:
    """Return a program by its path, relative to the launch file's folder, or by its name.

    Raises:
        UsageError: There is none, or it is not executable.
    """
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
    """Return the command of a file that is a node: Python's with this Python, others as they are.

    Raises:
        UsageError: There is none, or it is not executable.
    """
    path = path_from(folder, word)
    if path.suffix == ".py" and path.is_file() and not os.access(path, os.X_OK):
        return (sys.executable, str(path))
    return (find_program(str(path), folder),)


def startable(command: Sequence[str]) -> list[str]:
    """Return a command line as it is started here: ``lcmtools`` is the one that runs now."""
    words = list(command)
    try:
        place = next(i for i in range(len(words)) if tuple(words[i : i + 2]) == RUN)
    except StopIteration:
        return words
    own = Path(sysconfig.get_path("scripts")) / OWN
    words[place : place + 1] = [str(own)] if own.is_file() else [sys.executable, "-m", OWN]
    return words


def _nodes_of(package: str, folder: Path) -> set[str]:
    """Return the names of a package's nodes."""
    own = OWN if package in _as_lcmtools() else package
    known = (*_nodes_from(Path.cwd()), *_nodes_from(folder))
    return {node.name for node in known if node.package == own}


@lru_cache(maxsize=4)
def _nodes_from(start: Path) -> tuple[Runnable, ...]:
    """Return the nodes of a folder's workspace and of installed packages, which takes a moment."""
    return tuple(runnables(start))


def _as_lcmtools() -> set[str]:
    """Return the packages whose nodes lcmtools has."""
    return {OWN, *lab_packages(), *_ROS_PACKAGES}


def _script(package: str, name: str, folder: Path) -> str:
    """Return an executable file of a package's folder, as rosrun finds them, or ""."""
    try:
        files = files_below(find_package(package, folder))
    except UsageError:
        return ""
    wanted = (name, f"{name}.py")
    fitting = (path for path in files if path.name in wanted and path.is_file())
    return next((str(path) for path in fitting if os.access(path, os.X_OK)), "")
