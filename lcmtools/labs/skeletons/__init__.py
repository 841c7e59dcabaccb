"""The labs' nodes with the interesting part left out, to be filled in: one file a node.

``lcmtools lab skeleton NAME`` copies one. Each runs as it is and does nothing wrong; its TODOs say
what is missing. The answers are the nodes of the same names in the folder above; a file in C++ is
both, and compiles as the skeleton with SKELETON defined.
"""

import re
from pathlib import Path

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.folders import write_whole
from lcmtools.names import did_you_mean
from lcmtools.packages.runnable_nodes import ANSWERS

NAMES = tuple(sorted((*ANSWERS, "listener", "talker")))
CPP_NAMES = tuple(sorted(path.stem for path in Path(__file__).parent.glob("*.cpp")))
"""Those that are there in C++, too."""

_ANSWER = re.compile(r"#ifdef SKELETON\n(.*?)(?:#else\n.*?)?#endif\n", re.DOTALL)
_ADDED = re.compile(r"#ifndef SKELETON\n.*?#endif\n", re.DOTALL)
_COMPILING = re.compile(r"^//     lcmtools msg generate .*\n//     g\+\+ .*\n", re.MULTILINE)


def skeleton_text(name: str, *, is_cpp: bool = False) -> str:
    """Return a node's skeleton, or raise UsageError if there is none with this name."""
    names, language = (CPP_NAMES, " in C++") if is_cpp else (NAMES, "")
    if name not in names:
        hint = did_you_mean(name, names) or f"there are {', '.join(names)}"
        raise UsageError(f"there is no skeleton of '{name}'{language}", hint)
    text = Path(__file__).with_name(name + suffix(is_cpp=is_cpp)).read_text("utf-8")
    return _ANSWER.sub(r"\1", _ADDED.sub("", text)) if is_cpp else text


def in_package(text: str, name: str, package: str) -> str:
    """Return a skeleton's text with the commands that build and run it as a package's node."""
    build = f"//     lcmtools pkg build {package}\n"
    text = _COMPILING.sub(build, text)
    return re.sub(rf"python {name}\.py|\./{name}\b", f"lcmtools run {package} {name}", text)


def suffix(*, is_cpp: bool) -> str:
    """Return the suffix of a skeleton's file."""
    return ".cpp" if is_cpp else ".py"


def copy_skeleton(
    name: str, folder: Path, *, is_cpp: bool = False, overwrite: bool = False
) -> Path:
    """Write a node's skeleton into a folder, created if missing; return the file.

    Raises:
        UsageError: There is no skeleton of that name, or the file already exists.
        LcmtoolsError: It cannot be written.
    """
    text = skeleton_text(name, is_cpp=is_cpp)
    path = folder / (name + suffix(is_cpp=is_cpp))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UsageError(f"{folder} is not a folder", "name a folder to write into") from None
    except OSError as error:
        raise LcmtoolsError(f"cannot write {path}: {error.strerror}") from error
    if path.is_file() and not overwrite:
        raise UsageError(f"{path} already exists", "--force overwrites it")
    write_whole(path, text)
    return path
