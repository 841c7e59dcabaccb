"""The words after ``lcmtools launch``: files, arguments, the namespace.

Belongs here: which word is what.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lcmtools.arguments import misspelt
from lcmtools.errors import UsageError
from lcmtools.names import resolve, resolve_namespace

_ASSIGNMENT = re.compile(r"([^\s:=]+):=(.*)", re.DOTALL)
_MEANINGLESS = ("__log", "__ip", "__hostname", "__master")
"""ROS's own, which mean nothing on LCM; accepted so that old command lines work."""


@dataclass(frozen=True, slots=True)
class Typed:
    """What was typed.

    Attributes:
        places: PACKAGE and FILE, or files.
        arguments: Those of the launch files.
        namespace: The full one that everything is pushed into.
    """

    places: tuple[str, ...]
    arguments: Mapping[str, str]
    namespace: str


def read_words(words: Sequence[str], flag: str | None, usual: str) -> Typed:
    """Sort words out.

    Args:
        words: As typed.
        flag: What ``--ns`` says.
        usual: The namespace where nothing is said.

    Raises:
        UsageError: One of them is wrong, or there is no file.
    """
    places: list[str] = []
    arguments: dict[str, str] = {}
    namespace = flag
    for word in words:
        assignment = _ASSIGNMENT.fullmatch(word)
        if not assignment:
            hint = misspelt(words, word, of_node=False) if places else ""
            if hint and not Path(word).exists():
                raise UsageError(f"{word}: this is no argument", hint)
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
    full = resolve(namespace, resolve_namespace(usual)) if namespace else resolve_namespace(usual)
    return Typed(tuple(places), arguments, full)


def _check_name(name: str, word: str) -> None:
    if name.startswith("__"):
        raise UsageError(f"{word}: a launch takes __ns:= only", "name nodes in the file")
    if name[0] in "~/" or "/" in name:
        raise UsageError(
            f"{word}: '{name}' is no name of an argument", "remaps are written in the launch file"
        )
