"""Nodes in C++ of a package: the executables of its CMakeLists.txt.

Belongs here: reading that file, and what the text of a source tells. Must not know how CMake runs.
"""

import os
import re
from collections.abc import Collection
from pathlib import Path

from lcmtools.errors import LcmtoolsError
from lcmtools.folders import read_bytes

PROJECT = "CMakeLists.txt"
SUFFIXES = (".cpp", ".cc", ".cxx")
"""The suffixes of sources in C++."""

_COMMENT = re.compile(r"#.*")
_EXECUTABLE = re.compile(r"\badd_executable\s*\(\s*([\w.-]+)\s+([^)]*)\)", re.IGNORECASE)
_SOURCE = re.compile(r"\S+\.(?:cpp|cc|cxx)\b")
_MAIN = re.compile(r"\bmain\s*\(")
_GENERATE = re.compile(r"\blcmtools_generate\s*\(\s*([\w.-]+)([^)]*)\)", re.IGNORECASE)
_INCLUDE = re.compile(
    r'^\s*#\s*include\s*[<"]((\w+)/(?:(?:msg|srv)/)?(\w+)\.h(?:pp)?)[>"]', re.MULTILINE
)
_OWN_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"\n]+)"', re.MULTILINE)
_FIRST_COMMENT = re.compile(r"\s*(?://+|/\*+)[\s*]*(.*)")


def cpp_sources(folder: Path) -> dict[str, Path]:
    """Return the main source of each node in C++ of a package's folder, by the node's name."""
    found = {}
    for name, rest in _EXECUTABLE.findall(_COMMENT.sub("", source_text(folder / PROJECT))):
        if source := _SOURCE.search(rest):
            found[name] = folder / source[0].strip('"').removeprefix("${CMAKE_CURRENT_SOURCE_DIR}/")
    return found


def is_cpp(file: Path) -> bool:
    """Return True for a source in C++, even if it is an executable file."""
    return file.suffix in SUFFIXES and file.is_file()


def has_cpp_main(source: Path) -> bool:
    """Return True if a source in C++ has a function main."""
    return bool(_MAIN.search(source_text(source)))


def cpp_summary(source: Path) -> str:
    """Return the first line of the comment that a source begins with, or ""."""
    comment = _FIRST_COMMENT.match(source_text(source))
    return comment[1].removesuffix("*/").strip() if comment else ""


def source_text(path: Path) -> str:
    """Return the text of a source, or of CMakeLists.txt; "" if it cannot be read."""
    try:
        return read_bytes(path).decode("utf-8", "replace")
    except LcmtoolsError:  # what needs the file will report it
        return ""


def included(text: str, known: Collection[str]) -> list[str]:
    """Return the packages of message types, among the known ones, that a source includes.

    The files may have their names in ROS.
    """
    return list(dict.fromkeys(name for _, name, _ in _INCLUDE.findall(text) if name in known))


def parts_of(source: Path) -> list[Path]:
    """Return the files of a node: its main source, the headers that these include, their sources.

    The source of ``pid.hpp`` is ``pid.cpp`` beside it.
    """
    files = [source]
    for file in files:  # grows meanwhile
        names = _OWN_INCLUDE.findall(source_text(file))
        for header in (Path(os.path.normpath(file.parent / name)) for name in names):
            sources = (header.with_suffix(suffix) for suffix in SUFFIXES)
            parts = [header, *(one for one in sources if not has_cpp_main(one))]
            if not is_cpp(header):  # which is not compiled for itself
                files += [one for one in parts if one.is_file() and one not in files]
    return files


def undeclared_sources(folder: Path) -> list[Path]:
    """Return the sources with a main function in a package's folder src that are not nodes."""
    known = cpp_sources(folder).values()
    return [
        one
        for one in sorted((folder / "src").glob("*.cpp"))
        if one not in known and has_cpp_main(one)
    ]


def wrong_include(folder: Path, known: Collection[str]) -> str:
    """Return the likely fault of a package that cannot be compiled: an include; else "".

    ``known`` are the packages of message types.
    """
    project = _COMMENT.sub("", source_text(folder / PROJECT))
    generated = {name: re.findall(r"\w+", types) for name, types in _GENERATE.findall(project)}
    for node, source in cpp_sources(folder).items():
        for path, package, name in _INCLUDE.findall(source_text(source)):
            if instead := _in_place_of_ros(path, package, name, known):
                return f"{source.name} includes <{path}>, as in ROS; here it is <{instead}>"
            if package in known and package not in generated.get(node, []):
                line = f"lcmtools_generate({node} ...)"
                return f"{source.name} includes <{path}>: add {package} to {line}"
    return ""


def _in_place_of_ros(path: str, package: str, name: str, known: Collection[str]) -> str:
    if package in ("ros", "rclcpp"):
        return "lcmtools/node.hpp"
    own = f"{package}/{re.sub(r'(?:^|_)(.)', lambda match: match[1].upper(), name)}.hpp"
    return own if package in known and path != f"{package}/{name}.hpp" else ""
