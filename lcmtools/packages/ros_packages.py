"""ROS packages near a folder: those with a package.xml, by name, and the programs in them.

They are searched in the folder and those above it, two levels deep, and in their ``src``: in a
catkin or colcon workspace, and in a repository. Other users' packages are never used.
"""

import os
import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.workspace import is_meant, subfolders, text_of_own

_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>", re.ASCII)
_MOST_LEVELS = 16
_MOST_FOLDERS = 2000  # at each level
_MOST_FILES = 10_000
"""The most files of a package that are searched: it may be a home folder."""


def ros_name(folder: Path) -> str:
    """Return the name in a folder's package.xml; "" if it has none."""
    found = _NAME.search(text_of_own(folder / "package.xml"))
    return found[1] if found else ""


def ros_packages(*starts: Path) -> dict[str, Path]:
    """Return the folders of the packages near some folders, by name; the nearest if two have it."""
    found: dict[str, Path] = {}
    for start in starts:
        for level in (start, *start.parents)[:_MOST_LEVELS]:
            here = _packages_at(level) if level != level.parent else {}
            if here and is_meant(level, start, list(here.values())):
                found = {**here, **found}
    return found


@lru_cache(maxsize=_MOST_LEVELS)
def _packages_at(level: Path) -> dict[str, Path]:
    """Return the packages at one level, which takes a moment."""
    found: dict[str, Path] = {}
    for folder in islice(_candidates(level), _MOST_FOLDERS):
        if name := ros_name(folder):
            found.setdefault(name, folder)
    return found


def _candidates(level: Path) -> Iterator[Path]:
    yield level
    for place in (level, level / "src"):
        children = sorted(subfolders(place))
        yield from children
        for child in children:
            yield from sorted(subfolders(child))


def files_below(folder: Path) -> Iterator[Path]:
    """Return a package's files in order, without those in hidden folders."""
    for count, path in enumerate(sorted(folder.rglob("*"))):
        if count == _MOST_FILES:
            return
        if not any(part.startswith(".") for part in path.relative_to(folder).parts):
            yield path


def program_in(folder: Path, name: str) -> str:
    """Return an executable file in a package's folder, as found by rosrun, or ""."""
    fitting = (path for path in files_below(folder) if path.name in (name, f"{name}.py"))
    return next((str(path) for path in fitting if _is_program(path)), "")


def ros_program(words: Sequence[str], here: Path) -> str:
    """Return the program for the words PACKAGE NAME ...; "" if there is no such ROS package.

    UsageError is raised if the package has no such program.
    """
    folder = ros_packages(here).get(words[0])
    if folder is None:
        return ""
    programs = [path.name for path in files_below(folder) if _is_program(path)]
    if len(words) == 1:
        hint = f"it has {', '.join(programs)}" if programs else "it has none: chmod +x makes one"
        raise UsageError(f"the program of the ROS package {words[0]} is missing", hint)
    if found := program_in(folder, words[1]):
        return found
    hint = did_you_mean(words[1], programs) or "chmod +x makes a script one; C++ needs ROS"
    raise UsageError(f"the ROS package {words[0]} has no program '{words[1]}'", hint)


def _is_program(path: Path) -> bool:
    return path.is_file() and os.access(path, os.X_OK)
