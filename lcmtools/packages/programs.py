"""Programs of packages: executable files anywhere in a package's folder, as rosrun finds them.

Belongs here: a program by its name, also that of a node in C++, and the command that starts it.
"""

import os
import re
import shlex
import shutil
import sys
import sysconfig
from collections.abc import Iterator, Sequence
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.messages.type_source import shown
from lcmtools.names import did_you_mean
from lcmtools.packages.cpp_nodes import PROJECT, cpp_sources
from lcmtools.packages.ros_packages import ros_packages
from lcmtools.packages.runnable_nodes import OWN, Runnable
from lcmtools.packages.workspace import workspace

RUN = (OWN, "run")
_MOST_FILES = 10_000
"""The most files of a package that are searched: it may be a home folder."""
_BUILT = {"build", "dist"}
_BY_CMAKE = "CMakeFiles"  # a folder with trial programs of CMake's own
_BY_ENV = re.compile(rb"#!\s*/usr/bin/env\s+(python[\d.]*)\s*")


def files_below(folder: Path) -> Iterator[Path]:
    """Return a package's files in order, without those in hidden folders and of CMake."""
    for count, path in enumerate(sorted(folder.rglob("*"))):
        if count == _MOST_FILES:
            return
        parts = path.relative_to(folder).parts
        if not any(part.startswith(".") or part == _BY_CMAKE for part in parts):
            yield path


def program_folder(package: str, here: Path) -> Path | None:
    """Return the folder of a package near ``here``, also of ROS; None if there is none."""
    own = (one.folder for one in workspace(here).packages if one.name == package)
    return next(own, None) or ros_packages(here).get(package)


def programs_in(folder: Path) -> list[Path]:
    """Return the executable files of a package."""
    return [path for path in files_below(folder) if _is_program(path)]


def built_program(node: Runnable) -> Path:
    """Return the program of a node in C++, in the package's folder build or elsewhere in it.

    Raises:
        UsageError: It is not built.
    """
    assert node.folder is not None, "packages with sources are not installed"
    usual = node.folder / "build" / node.name
    found = [path for path in programs_in(node.folder) if path.name == node.name]
    if not found:
        what = f"the node '{node.name}' of {node.package} is not built"
        raise UsageError(what, f"type: lcmtools pkg build {node.package}")
    return usual if usual in found else found[0]


def program_in(folder: Path, name: str) -> Path | None:
    """Return a package's program, whose suffix ".py" may be left out; None if there is none.

    Copies in the folders build and dist count only if there is no other.

    Raises:
        UsageError: There are several, or the file is not executable.
    """
    files = [path for path in files_below(folder) if path.is_file()]
    named = [path for path in files if path.name == name]
    named = named or [path for path in files if path.name == f"{name}.py"]
    found = [path for path in named if _is_program(path)]
    found = [one for one in found if not _BUILT & set(one.relative_to(folder).parts)] or found
    if len(found) > 1:
        choices = " or ".join(f"lcmtools run {_typed(path)}" for path in found)
        raise UsageError(f"there are several programs '{name}' in {shown(folder)}", choices)
    return found[0] if found else None


def not_executable(folder: Path, name: str) -> UsageError | None:
    """Return the error for a package's file with this name that is not executable, else None.

    Modules do not count: they are declared as nodes.
    """
    for path in files_below(folder):
        is_named = path.name in (name, f"{name}.py") and path.is_file()
        if is_named and not _is_program(path) and not (path.parent / "__init__.py").is_file():
            command = f"chmod +x {shlex.quote(shown(path))}"
            return UsageError(f"{shown(path)} is not executable", f"type: {command}")
    return None


def find_program(words: Sequence[str], here: Path) -> Path | None:
    """Return the program for ``PACKAGE NAME ...``; None if there is no such package or program.

    Raises:
        UsageError: There are several, it is not executable, or a ROS package has none.
    """
    folder = program_folder(words[0], here)
    if folder is None:
        return None
    name = words[1] if len(words) > 1 else ""
    if name and (found := program_in(folder, name)):
        return found
    if name and (error := not_executable(folder, name)):
        raise error
    if folder != ros_packages(here).get(words[0]):
        if name and (folder / PROJECT).is_file() and not cpp_sources(folder):  # made by a function
            what = f"the package {words[0]} has no program '{name}'"
            raise UsageError(what, f"C++ nodes are built by  lcmtools pkg build {words[0]}")
        return None
    programs = [path.name for path in programs_in(folder)]
    if not name:
        hint = f"it has {', '.join(programs)}" if programs else "it has none: chmod +x makes one"
        raise UsageError(f"the program of the ROS package {words[0]} is missing", hint)
    hint = did_you_mean(name, programs) or "chmod +x makes a script one; C++ needs ROS"
    raise UsageError(f"the ROS package {words[0]} has no program '{name}'", hint)


def command_of(path: Path) -> tuple[str, ...]:
    """Return the words that start a program.

    This Python runs a Python file, with ROS's modules of types, unless it names another Python.
    """
    try:
        with path.open("rb") as file:
            first = file.readline(200)
    except OSError:  # starting it will report the error
        first = b"#!"
    by_env = _BY_ENV.fullmatch(first)
    is_plain = path.suffix == ".py" and not first.startswith(b"#!")
    if is_plain or (by_env and _is_this_python(by_env[1].decode())):
        return python_command(path)
    return (str(path),)


def python_command(path: Path) -> tuple[str, ...]:
    """Return the words by which this Python runs a file as a node."""
    return (sys.executable, "-m", "lcmtools.packages.script", str(path))


def _is_this_python(name: str) -> bool:
    """Return True for the name of the running Python, or of one that is not installed."""
    found = shutil.which(name)
    return found is None or Path(found).parent == Path(sys.executable).parent


def _typed(path: Path) -> str:
    text = shown(path)
    return shlex.quote(text if "/" in text else f"./{text}")


def _is_program(path: Path) -> bool:
    return path.is_file() and os.access(path, os.X_OK)


def startable(command: Sequence[str]) -> list[str]:
    """Return a command line as it is started here: ``lcmtools`` means the running one."""
    words = list(command)
    place = next((i for i in range(len(words)) if tuple(words[i : i + 2]) == RUN), None)
    if place is None:
        return words
    own = Path(sysconfig.get_path("scripts")) / OWN
    words[place : place + 1] = [str(own)] if own.is_file() else [sys.executable, "-m", OWN]
    return words
