"""The words after ``lcmtools launch``: files, arguments, the namespace."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lcmtools.arguments import misspelt
from lcmtools.errors import UsageError
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
