"""ROS packages near a folder: those with a package.xml, by name.

They are searched in the folder and those above it, two levels deep, and four in their ``src``: in
a catkin or colcon workspace, and in a repository; then in noted workspaces and in ROS_PACKAGE_PATH.
Other users' packages are never used.
"""

import os
import re
from collections.abc import Iterator
from functools import lru_cache
from itertools import islice
from pathlib import Path

from lcmtools.packages.noted import noted_workspaces
from lcmtools.packages.workspace import is_meant, subfolders, text_of_own

_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>", re.ASCII)
_ENDS = frozenset(("package.xml", "CATKIN_IGNORE", "rospack_nosubdirs"))
_MOST_LEVELS = 16
_DEEPEST = 4  # folders below src
_MOST_FOLDERS = 2000  # at each level


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
    for folder in noted_workspaces(os.environ).folders:
        found = {**_packages_at(folder), **found}
    return {**_packages_in(os.environ.get("ROS_PACKAGE_PATH", "")), **found}


@lru_cache(maxsize=2)
def _packages_in(path: str) -> dict[str, Path]:
    """Return the packages below the folders of ROS_PACKAGE_PATH; the first if two have a name."""
    found: dict[str, Path] = {}
    for start in filter(None, path.split(os.pathsep)):
        for folder in islice(_below(start), _MOST_FOLDERS):
            if name := ros_name(folder):
                found.setdefault(name, folder)
    return found


def _below(start: str) -> Iterator[Path]:
    """Yield the folders below one, as rospack does: none in a package, and none that is hidden."""
    for folder, names, files in os.walk(start):
        is_end = not _ENDS.isdisjoint(files)
        names[:] = [] if is_end else sorted(one for one in names if not one.startswith("."))
        if "CATKIN_IGNORE" not in files:
            yield Path(folder)


@lru_cache(maxsize=_MOST_LEVELS)
def _packages_at(level: Path) -> dict[str, Path]:
    """Return the packages at one level, which takes a moment."""
    found: dict[str, Path] = {}
    for folder in islice(_candidates(level), _MOST_FOLDERS):
        if name := ros_name(folder):
            found.setdefault(name, folder)
    return found


def _candidates(level: Path) -> Iterator[Path]:
    """Yield the folders near a level, the nearest first: none in a package."""
    yield level
    for place, depth in ((level, 2), (level / "src", _DEEPEST)):
        folders = [place]
        for _ in range(depth):
            outside = (one for one in folders if one == place or not ros_name(one))
            below = (child for one in outside for child in sorted(subfolders(one)))
            folders = [*islice(below, _MOST_FOLDERS)]
            yield from folders
