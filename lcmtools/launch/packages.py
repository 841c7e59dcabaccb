"""Packages and the launch files in them: from names to folders and files.

A package is one of the workspace, also of ROS, an installed one of Python, or one of lcmtools' own,
the labs'.
"""

import os
import sys
from collections.abc import Sequence
from itertools import product
from pathlib import Path

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.programs import files_below
from lcmtools.packages.ros_packages import ros_packages
from lcmtools.packages.type_files import module_folders
from lcmtools.packages.workspace import workspace

LABS = Path(__file__).parent / "files"  # packages that the labs' texts name, with launch files
SUFFIXES = (".launch", ".yaml", ".yml", ".xml")


def path_from(folder: Path, name: str) -> Path:
    """Return a path in a launch file in a folder, which may begin with "~"; UsageError if bad."""
    try:
        os.fsencode(name)
        path = folder / Path(name).expanduser()
    except (RuntimeError, ValueError):  # an unknown user's home, or a lone surrogate
        raise UsageError(f"{name!a} is not a path") from None
    if "\0" in name:
        raise UsageError(f"{name!a} is not a path")
    return path


def is_there(path: Path) -> bool:
    """Return True if a path can be read: a file, or a pipe made by a shell."""
    try:
        return path.exists() and not path.is_dir()
    except (OSError, ValueError):  # a name that is too long or invalid
        return False


def package_folder(name: str, *starts: Path) -> Path:
    """Return a package's folder, also from the workspaces of ``starts``; UsageError for none."""
    places = (Path.cwd(), *starts)
    space, of_ros = workspace(*places), ros_packages(*places)
    if name.replace("_", "a").replace("-", "a").isalnum():
        own = (package.folder for package in space.packages if package.name == name)
        module = name.replace("-", "_")
        installed = [] if module in sys.stdlib_module_names else module_folders(module)
        ros = [of_ros[name]] if name in of_ros else []
        for folder in (*own, *ros, *installed, LABS / name):
            if folder.is_dir():
                return folder
    known = [*lab_packages(), *of_ros, *(package.name for package in space.packages)]
    hint = did_you_mean(name, known) or "it is neither installed nor in this workspace"
    raise UsageError(f"there is no package '{name}'", hint)


def is_package(name: str) -> bool:
    """Return True if there is a package of this name."""
    try:
        package_folder(name)
    except UsageError:
        return False
    return True


def lab_packages() -> list[str]:
    """Return the packages that the labs' texts name."""
    return sorted(path.name for path in LABS.iterdir() if path.is_dir())


def lab_files() -> list[tuple[str, str]]:
    """Return the labs' launch files, each with its package."""
    return sorted((path.parts[-3], path.name) for path in LABS.glob("*/launch/*"))


def launch_files(package: str) -> list[str]:
    """Return the names of a package's launch files; [] if there is no such package."""
    try:
        return [path.name for path in _launch_files(package_folder(package))]
    except UsageError:
        return []


def find_files(words: Sequence[str]) -> list[Path]:
    """Return the launch files for ``[PACKAGE] FILE...``.

    Raises:
        InvalidFile: There is no such file.
        UsageError: There is no such package.
    """
    first, *rest = words
    if is_there(Path(first)):
        if missing := next((word for word in rest if not is_there(Path(word))), ""):
            raise InvalidFile(f"there is no launch file {missing}")
        return list(map(Path, words))
    if not rest:
        return [_find_alone(first)]
    folder = package_folder(first)
    return [_find_in(folder, first, name) for name in rest]


def _find_alone(word: str) -> Path:
    """Return a local file, one of the labs', or the only launch file of a package."""
    names = _spellings(word)
    space = workspace(Path.cwd()).packages
    own = (package.folder / "launch" for package in space if not package.is_noted)
    for name, place in product(names, (Path(), Path("launch"), *own)):
        if is_there(place / name):
            return place / name
    if Path(word).is_dir() and not is_package(word):
        raise InvalidFile(f"{word} is a folder, not a launch file")
    known = {name: package for package, name in lab_files()}
    if name := next((name for name in names if name in known), ""):
        return _find_in(package_folder(known[name]), known[name], name)
    for name, package in product(names, space):
        if is_there(package.folder / "launch" / name):
            return package.folder / "launch" / name
    if is_package(word):
        return _only_file(package_folder(word), word)
    here = [path.name for path in (*Path().glob("*"), *Path("launch").glob("*"))]
    here = [name for name in here if name.endswith(SUFFIXES)]
    hint = did_you_mean(word, [*known, *here]) or f"those of the labs: {', '.join(known)}"
    raise InvalidFile(f"there is no launch file {word}", hint)


def _find_in(folder: Path, package: str, name: str) -> Path:
    wanted = _spellings(name)
    for spelling in wanted:  # usual places of launch files come first
        for place in (folder / "launch" / spelling, folder / spelling):
            if place.is_file():
                return place
    for path in files_below(folder):
        if path.name in wanted and path.is_file():
            return path
    known = [path.name for path in _launch_files(folder)]
    hint = did_you_mean(name, known) or (f"it has {', '.join(known)}" if known else "")
    raise InvalidFile(f"there is no launch file {name} in the package {package}", hint)


def _only_file(folder: Path, package: str) -> Path:
    files = _launch_files(folder)
    if len(files) == 1:
        return files[0]
    names = ", ".join(path.name for path in files)
    hint = f"it has {names}" if files else "it has none in a folder launch"
    raise InvalidFile(f"the file of the package {package} is missing", hint)


def _launch_files(folder: Path) -> list[Path]:
    files = files_below(folder)
    return [path for path in files if path.suffix in SUFFIXES and path.parent.name == "launch"]


def _spellings(name: str) -> list[str]:
    return [name, *(f"{name}{suffix}" for suffix in SUFFIXES)]
