"""Users' type files: on LCMTOOLS_TYPE_PATH, in the workspace and in installed packages.

Belongs here: finding and reading them. Must not know their content.
"""

import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from lcmtools.folders import LARGEST
from lcmtools.messages.type_source import Problem
from lcmtools.packages.workspace import ROS_FOLDERS

VARIABLE = "LCMTOOLS_TYPE_PATH"
"""Folders with .lcm files, also in subfolders, separated by ':'."""
GROUPS = ("lcmtools.nodes", "lcmtools.messages")
"""The entry points by which an installed package shows that it may have .lcm files."""

_SUFFIXES = (".lcm", *(f".{kind}" for kind in ROS_FOLDERS))
_MOST_FOLDERS = 2000  # a user may name the home folder
_OTHER_FOLDERS = {"node_modules", "site-packages", "venv"}
_BUILT = {"build", "dist"}


class LcmFile(NamedTuple):
    """A file as it was read, with its full path."""

    where: str
    content: bytes
    package: str = ""  # of a ROS file, which does not name it

    @property
    def path(self) -> Path:
        """Its path; not stored, as making thousands takes as long as reading the files."""
        return Path(self.where)


def variable_folders(environment: Mapping[str, str]) -> list[Path]:
    """Return the folders in the variable."""
    words = environment.get(VARIABLE, "").split(":")
    return [Path(word).expanduser().absolute() for word in words if word]


def installed_folders() -> list[Path]:
    """Return the folders of installed packages that may have .lcm files; imports none of them."""
    from importlib.metadata import entry_points

    modules: dict[str, None] = {}
    for group in GROUPS:
        modules.update(dict.fromkeys(one.module.split(".")[0] for one in entry_points(group=group)))
    return [
        place
        for module in sorted(modules)
        if module not in ("lcmtools", "lcmtools_sim")
        for place in module_folders(module)
    ]


def module_folders(module: str) -> list[Path]:
    """Return the folders of an installed Python package, without importing it."""
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):
        return []
    return list(map(Path, (spec and spec.submodule_search_locations) or ()))


def shipped_folder() -> Path:
    """Return the folder of the .lcm files of the shipped types."""
    package = Path(__file__).parents[1]
    installed = package / "lcm_files"
    return installed if installed.is_dir() else package.parent / "lcm_types"


def is_type_file(path: Path) -> bool:
    """Return True for a relative path of a type file, as logs store it with a type."""
    is_plain = not path.is_absolute() and "\0" not in str(path)
    return is_plain and bool(path.stem) and path.suffix in _SUFFIXES


def read_folders(folders: Sequence[Path]) -> tuple[list[LcmFile], list[Problem]]:
    """Return the type files below folders, each once, sorted by folder, and the problems."""
    files: dict[str, LcmFile] = {}
    problems: list[Problem] = []
    for folder in dict.fromkeys(folders):
        if not folder.is_dir():
            problems.append(Problem(str(folder), 0, "there is no such folder", f"see {VARIABLE}"))
            continue
        for path in _paths(str(folder)):
            one = path if isinstance(path, Problem) else files.get(path) or _read(path)
            if isinstance(one, LcmFile):
                files[one.where] = one
            elif one not in problems:
                problems.append(one)
    return list(files.values()), problems


def _paths(folder: str) -> Iterator[str | Problem]:
    """Yield the type files below a folder; if it is very large, only the first ones, and why.

    Folders called build and dist come last: they usually have copies of files, maybe old ones.
    """
    roots, known = [folder], set()
    places = ((root, *one) for root in roots for one in os.walk(root))  # roots are added meanwhile
    for count, (root, place, folders, names) in enumerate(places):
        if count >= _MOST_FOLDERS:
            what = f"it has more than {_MOST_FOLDERS} folders, and the others are not searched"
            yield Problem(root, 0, what, f"name those with type files in {VARIABLE}")
            return
        roots += [f"{place}/{one}" for one in sorted(_BUILT & set(folders))]
        others = _BUILT | _OTHER_FOLDERS
        folders[:] = sorted(one for one in folders if one[0] != "." and one not in others)
        for name in sorted(one for one in names if one.endswith(_SUFFIXES)):
            end = place.rpartition("/")[2], name
            if root == folder or end not in known:
                known.add(end)
                yield f"{place}/{name}"


def _read(path: str) -> LcmFile | Problem:
    try:
        package = "" if path.endswith(".lcm") else _ros_package(path)
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # of a FIFO, without a wait
        try:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                return Problem(path, 0, "this is not a file")
            if status.st_size > LARGEST:
                what = f"a {Path(path).suffix} file must have less than {LARGEST} bytes"
                return Problem(path, 0, what)
            return LcmFile(path, os.read(descriptor, status.st_size), package)
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        return Problem(path, 0, "this link leads nowhere")
    except OSError as error:
        return Problem(path, 0, f"cannot be read: {error.strerror}")


def _ros_package(path: str) -> str:
    from lcmtools.packages.ros_files import package_of

    return package_of(Path(path))
