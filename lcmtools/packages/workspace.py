"""Packages: folders of the workspace whose pyproject.toml has a table [tool.lcmtools].

Of ROS packages next to them, which have a package.xml, only the types are used.

The workspace is the nearest folder, from the current one upwards, that contains packages, directly
or, up to two folders deep, in ``src``. Packages of noted workspaces come last. Other users' folders
are never used. Must not know nodes or messages.
"""

import os
import re
import stat
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from lcmtools.errors import InvalidFile
from lcmtools.folders import read_bytes, read_text
from lcmtools.packages.noted import noted_workspaces

MARK = "[tool.lcmtools]"
"""The table that marks a pyproject.toml as a package's."""

ROS_FOLDERS = ("msg", "srv", "action")
"""The folders with types in a ROS package."""

_MOST_FOLDERS = 300  # subfolders; a folder with more, like /tmp, is not a workspace
_MOST_LEVELS = 16


class Package(NamedTuple):
    """A package of the workspace: its import name ("air_lab0") and its pyproject.toml's folder."""

    name: str
    folder: Path
    is_noted: bool = False  # True if it is only found because its workspace is noted

    def import_folder(self) -> Path:
        """The folder from which its code is imported."""
        source = self.folder / "src"
        return source if (source / self.name).is_dir() else self.folder


class Workspace(NamedTuple):
    """The packages of workspaces."""

    packages: list[Package]  # sorted by name; if two have the same name, the nearer one
    problems: list[InvalidFile]  # errors of broken packages, which do not affect others


def workspace(*starts: Path) -> Workspace:
    """Return the packages of the workspaces around these folders, and of noted ones."""
    found: dict[str, Package] = {}
    problems: list[InvalidFile] = []
    near = package_folders(*starts)
    others = noted_type_folders(os.environ)
    noted = [folder for folder in others if _is_own(folder) and folder not in near]
    for folder in (*near, *noted):
        try:
            name = package_name(folder)
        except InvalidFile as error:  # noqa: PERF203 - each package fails on its own
            problems.append(error)
        else:
            found.setdefault(name, Package(name, folder, folder in noted))
    return Workspace([found[name] for name in sorted(found)], problems)


def noting(package: Path) -> Path:
    """Return the folder to note so that a package is found: its workspace, else the package's."""
    is_found = package in packages_in(package.parent) and not _is_shared(package.parent)
    return package.parent if is_found else package


def package_folders(*starts: Path) -> list[Path]:
    """Return the folders of packages around ``starts``, unread; those of the first come first."""
    return [folder for folder in type_folders(*starts) if _is_own(folder)]


def type_folders(*starts: Path) -> list[Path]:
    """Return the folders of these packages, and of ROS packages with types next to them."""
    found: dict[Path, None] = {}
    for start in starts:
        found.update(dict.fromkeys(_workspace(start)))
    return list(found)


def noted_type_folders(environment: Mapping[str, str]) -> list[Path]:
    """Return the folders of these packages in noted workspaces."""
    spaces = noted_workspaces(environment).folders
    return list(dict.fromkeys(one for space in spaces for one in packages_in(space)))


def load_toml(text: str) -> dict[str, object]:
    """Parse a TOML text; ValueError if it is invalid."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    return tomllib.loads(text)


def read_project(folder: Path) -> dict[str, object]:
    """Read a package's pyproject.toml; InvalidFile, with the line, if it is not TOML."""
    path = folder / "pyproject.toml"
    try:
        return load_toml(read_text(path))
    except ValueError as error:
        place = re.search(r"\(at line (\d+), column \d+\)", str(error))
        line = f":{place[1]}" if place else ""
        reason = re.sub(r"\s*\(at .*\)", "", str(error))
        raise InvalidFile(f"{path}{line}: this is not TOML: {reason}") from error


def table(value: object, *keys: str) -> dict[str, object]:
    """Return a nested table; empty if there is none."""
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value if isinstance(value, dict) else {}


def package_name(folder: Path) -> str:
    """Return the import name of the package in a folder; InvalidFile if it has none."""
    name = table(read_project(folder), "project").get("name")
    path = folder / "pyproject.toml"
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z][\w.-]*", name, re.ASCII):
        raise InvalidFile(
            f"{path}: the package has no valid name", 'write  name = "air_lab0"  below [project]'
        )
    return re.sub(r"[-.]+", "_", name)


def _workspace(start: Path) -> list[Path]:
    """Return the packages of the workspace around a folder."""
    for level in (start, *start.parents)[:_MOST_LEVELS]:
        found = [*_children(level), *_below_src(level)]
        if found and level.parent.name == "src":  # of a repository in a workspace
            found = list(dict.fromkeys([*found, *_below_src(level.parent.parent)]))
        if found and is_meant(level, start, found):
            return found
        if _is_package(level) and level not in _children(level.parent):  # too many are next to it
            return [level]
    return []


def packages_in(folder: Path) -> list[Path]:
    """Return the packages of a workspace, which may be a single one."""
    if _is_package(folder):
        return [folder]
    return [*_children(folder), *_below_src(folder)]


def is_meant(level: Path, start: Path, found: list[Path]) -> bool:
    """Return True if the packages in a folder are for ``start``, which is it or below it.

    In a folder writable by all, such as /tmp, only if ``start`` is it or is in a package.
    """
    is_near = level == start or any(start.is_relative_to(one) for one in found)
    return is_near or not _is_shared(level)


def _is_shared(folder: Path) -> bool:
    return bool(folder.stat().st_mode & stat.S_IWOTH)


def _children(folder: Path) -> list[Path]:
    """Return the packages in a folder."""
    return sorted(path for path in subfolders(folder) if _is_package(path))


def _below_src(folder: Path) -> list[Path]:
    """Return the packages in a workspace's src, and in the folders there, such as repositories."""
    places = sorted(subfolders(folder / "src"))
    inner = [one for place in places if not _is_package(place) for one in _children(place)]
    return [*filter(_is_package, places), *inner]


def subfolders(folder: Path) -> Iterator[Path]:
    """Return the folders in a folder, without hidden ones; none if there are too many."""
    try:
        with os.scandir(folder) as entries:
            names = [one.name for one in entries if one.name[0] != "." and one.is_dir()]
    except OSError:
        return
    if len(names) <= _MOST_FOLDERS:
        yield from (folder / name for name in names)


def _is_package(folder: Path) -> bool:
    if text_of_own(folder / "package.xml"):  # a folder that must not be searched has none
        return _is_own(folder) or any((folder / name).is_dir() for name in ROS_FOLDERS)
    return _is_own(folder)


def _is_own(folder: Path) -> bool:
    """Return True for one of lcmtools' own packages."""
    return any(line.strip() == MARK for line in text_of_own(folder / "pyproject.toml").splitlines())


def text_of_own(path: Path) -> str:
    """Return the text of a file if it is this user's and of usual length; else ""."""
    try:
        state = path.stat()
        if state.st_uid in (os.getuid(), 0):
            return read_bytes(path).decode("utf-8", "replace")
    except (OSError, InvalidFile):
        pass
    return ""
