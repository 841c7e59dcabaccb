"""The words after ``lcmtools launch``, and reading a launch file into elements."""

import os
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lcmtools.arguments import misspelt
from lcmtools.errors import InvalidFile, UsageError, os_errors_as
from lcmtools.folders import LARGEST, read_bytes
from lcmtools.formats.strict_xml import Element, read_xml
from lcmtools.launch.packages import LABS
from lcmtools.names import resolve, resolve_namespace

_ASSIGNMENT = re.compile(r"([^\s:=]+):=(.*)", re.DOTALL)
# ROS's special names that mean nothing with LCM; accepted so that old command lines work
_MEANINGLESS = ("__log", "__ip", "__hostname", "__master")


@dataclass(frozen=True, slots=True)
class CommandLine:
    """Package and files, their arguments, and the full namespace for everything."""

    places: tuple[str, ...]
    arguments: Mapping[str, str]
    namespace: str


def read_words(words: Sequence[str], flag: str | None, default: str) -> CommandLine:
    """Parse the words, given ``--ns`` and the default namespace; UsageError if wrong or no file."""
    places: list[str] = []
    arguments: dict[str, str] = {}
    namespace = flag
    for word in words:
        assignment = _ASSIGNMENT.fullmatch(word)
        if not assignment:
            hint = misspelt(words, word, of_node=False) if places else ""
            if hint and not Path(word).exists():
                raise UsageError(f"{word}: this is not an argument", hint)
            places.append(word)
            continue
        name, text = assignment.groups()
        if name == "__ns":
            namespace = text or namespace
        elif name not in _MEANINGLESS:
            _check_name(name, word)
            arguments[name] = text
    if not places:
        raise UsageError("the launch file is missing", "lcmtools launch --list shows the labs'")
    base = resolve_namespace(default)
    return CommandLine(tuple(places), arguments, resolve(namespace, base) if namespace else base)


def _check_name(name: str, word: str) -> None:
    if name.startswith("__"):
        raise UsageError(f"{word}: a launch takes __ns:= only", "name nodes in the file")
    if name[0] in "~/" or "/" in name:
        hint = "remaps are written in the launch file"
        raise UsageError(f"{word}: '{name}' is not the name of an argument", hint)


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
