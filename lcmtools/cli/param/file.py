"""A file of parameters as its leaves: the path of keys to each value, and its line.

Belongs here: YAML and JSON alike, in the forms of rosparam (nested namespaces), ros2
(``ros__parameters``) and ``lcmtools param dump``. Must not know nodes.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.errors import InvalidFile, ValueMismatch
from lcmtools.messages.documents import parse
from lcmtools.messages.plain import Value

_ROS2_KEY = "ros__parameters"

Path = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Leaf:
    """One value of a file.

    Attributes:
        path: The keys that lead to it.
        value: The value: text, a list or nothing.
        place: File and line, for messages.
    """

    path: Path
    value: Value
    place: str


def leaves(text: str, source: str) -> list[Leaf]:
    """The values in the text of a file.

    Raises:
        InvalidFile: It is no YAML, or no mapping of names to values.
    """
    try:
        documents = list(parse(text))
    except ValueMismatch as mismatch:
        raise InvalidFile(f"{source}: {mismatch.what}", mismatch.hint) from None
    where = _lines(text)
    found: list[Leaf] = []
    for document in documents:
        if not isinstance(document.value, dict):
            raise InvalidFile(
                f"{source}:{document.line}: expected names and values", "for example kp: 0.5"
            )
        for path, value in _flat(document.value, ()):
            names = tuple(key for key in path if key != _ROS2_KEY)
            found.append(Leaf(names, value, f"{source}:{_line(where, path)}"))
    return found


def _flat(value: Value, path: Path) -> Iterator[tuple[Path, Value]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _flat(part, (*path, key))
    else:
        yield path, value


def _line(where: dict[Path, int], path: Path) -> int:
    """The line of a path; of what it stands in, where an alias repeats it."""
    while path and path not in where:
        path = path[:-1]
    return where.get(path, 1)


def _lines(text: str) -> dict[Path, int]:
    """The line of each key, from 1; the last one where documents repeat it."""
    import yaml

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    found: dict[Path, int] = {}
    keys: list[str | None] = []  # of the open mappings; None for a list
    is_key: list[bool] = []  # whether the next scalar of each is a key
    try:
        for event in yaml.parse(text, Loader=loader):
            if isinstance(event, yaml.ScalarEvent) and is_key and is_key[-1]:
                keys[-1], is_key[-1] = event.value, False
                path = tuple(key for key in keys if key is not None)
                found[path] = event.start_mark.line + 1 if event.start_mark else 1
                continue
            if isinstance(event, yaml.CollectionStartEvent):
                is_mapping = isinstance(event, yaml.MappingStartEvent)
                keys.append("" if is_mapping else None)
                is_key.append(is_mapping)
                continue
            if isinstance(event, yaml.CollectionEndEvent):
                keys.pop()
                is_key.pop()
            if is_key and keys[-1] is not None:
                is_key[-1] = True
    except yaml.YAMLError:  # JSON that is no YAML
        return {}
    return found
