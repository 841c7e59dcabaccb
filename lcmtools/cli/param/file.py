"""A file of parameters as its leaves: the path of keys to each value, and its line.

Belongs here: YAML and JSON alike, in the forms of rosparam (nested namespaces), ros2
(``ros__parameters``) and ``lcmtools param dump``. Must not know nodes.
"""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.errors import InvalidFile, ValueMismatch
from lcmtools.formats.strict_yaml import Node, read_documents
from lcmtools.formats.yaml_problem import BadYaml
from lcmtools.messages.documents import parse
from lcmtools.messages.plain import Value

_ROS2_KEY = "ros__parameters"

Path = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Leaf:
    """A value of a file.

    Attributes:
        path: The keys that lead to it.
        value: The value: text, a list or nothing.
        place: File and line, for messages.
    """

    path: Path
    value: Value
    place: str


def leaves(text: str, source: str) -> list[Leaf]:
    """Return the values in the text of a file.

    Raises:
        InvalidFile: It is no YAML, or no mapping of names to values.
    """
    found: list[Leaf] = []
    for document in _documents(text, source):
        if not isinstance(document.value, dict):
            place = f"{source}:{document.line}"
            raise InvalidFile(f"{place}: expected names and values", "for example kp: 0.5")
        for path, node in _flat(document, ()):
            names = tuple(key for key in path if key != _ROS2_KEY)
            found.append(Leaf(names, node.plain(), f"{source}:{node.key_line}"))
    return found


def _documents(text: str, source: str) -> list[Node]:
    try:
        return [node for node in read_documents(text) if node]
    except BadYaml as bad:
        with contextlib.suppress(ValueMismatch):  # JSON has escapes that YAML does not have
            return [_without_places(document.value) for document in parse(text)]
        raise InvalidFile(f"{source}:{bad.line or 1}: not YAML: {bad.problem}", bad.hint) from None


def _without_places(value: Value) -> Node:
    if isinstance(value, dict):
        return Node({key: _without_places(part) for key, part in value.items()})
    if isinstance(value, list):
        return Node([_without_places(part) for part in value])
    return Node("" if value is None else str(value), is_quoted=value is not None)


def _flat(node: Node, path: Path) -> Iterator[tuple[Path, Node]]:
    if isinstance(node.value, dict):
        for key, part in node.value.items():
            yield from _flat(part, (*path, key))
    else:
        yield path, node
