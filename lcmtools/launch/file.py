"""Reading a launch file into elements, with the reader for its kind."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path

from lcmtools.errors import InvalidFile, os_errors_as
from lcmtools.folders import LARGEST, read_bytes
from lcmtools.formats.strict_xml import Element, read_xml
from lcmtools.launch.packages import LABS

STANDARD_INPUT = "-"


@dataclass(frozen=True, slots=True)
class File:
    """A launch file's content, its full path, and the folder for its relative paths."""

    root: Element
    path: str
    folder: Path


def read_file(path: Path, place: str = "") -> File:
    """Read a launch file, which ``place`` includes; InvalidFile if it cannot be read."""
    before = f"{place}: " if place else ""
    what = f"{before}cannot read {_shown(path)}"
    content = read_bytes(path, what=what)
    full = path.resolve()
    return File(_read(content, _shown(path)), str(full), full.parent)


def read_standard_input() -> File:
    """Read the launch file from a pipe; InvalidFile if standard input is not one."""
    root = _read(sys.stdin.buffer.read(LARGEST + 1), "standard input")
    return File(root, STANDARD_INPUT, Path.cwd())


def _shown(path: Path) -> str:
    """Return a path for errors, short if it is below the current folder or one of the labs'."""
    full = path.resolve()
    for folder in (Path.cwd(), LABS):
        if full.is_relative_to(folder):
            return str(full.relative_to(folder))
    return str(path)


def _read(content: bytes, source: str) -> Element:
    if len(content) > LARGEST:
        raise InvalidFile(f"{source}: more than {LARGEST} bytes, too many for a launch file")
    if source.endswith(".py"):
        hint = "write it in YAML: see the help"
        raise InvalidFile(f"{source} is a program, like the launch files of ROS 2", hint)
    if not content.strip():
        raise InvalidFile(f"{source}:1: the file is empty")
    if _is_xml(content, source):
        root = read_xml(content, source, Element)
        if root.tag == "launch":
            return root
        hint = "put all into <launch></launch>"
        raise root.error(f"expected <launch>, got <{root.tag}>", hint)
    from lcmtools.launch.yaml_file import read_yaml

    with os_errors_as(f"cannot read {source}", kind=InvalidFile):
        return read_yaml(content.decode("utf-8-sig"), source)


def _is_xml(content: bytes, source: str) -> bool:
    suffix = os.path.splitext(source)[1]  # noqa: PTH122 - the name need not be a path
    if suffix in (".yaml", ".yml"):
        return False
    begins = content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    return suffix == ".xml" or begins or b"<launch" in content
