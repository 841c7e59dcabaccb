"""YAML of launch files' parameters, read as by roslaunch: names, and values as text for a node.

Belongs here: YAML 1.1's numbers and booleans (``yes``, ``0o17`` as 017), ``<<``, and rosparam's
angles, ``deg(180)`` and ``rad(pi/2)``. A quoted value stays text. Must not know tags.
"""

import math
import re
from collections.abc import Iterator

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.formats.expression import Expression, ExpressionFault, Language
from lcmtools.formats.operations import CONSTANTS
from lcmtools.formats.strict_yaml import YamlNode, read_file
from lcmtools.messages.setting import guessed, write_setting

_ANGLE = re.compile(r"(deg|rad)\(([^)]*)\)")
_RESOLVED = ("bool", "int", "float")
_RADIANS = Language(
    name="rad",
    example="write for example rad(pi/2)",
    allowed="numbers and pi are",
    longest=200,
    functions={},
)


class _Constants:
    """The names in ``rad()``: pi."""

    def named(self, name: str) -> object:
        if name not in CONSTANTS:
            raise LookupError(f"there is no '{name}'")
        return CONSTANTS[name]

    def attribute(self, owner: object, name: str) -> object:
        raise LookupError(f"{owner} has no field '{name}'")


def read_parameters(text: str, source: str, line: int = 1) -> YamlNode | None:
    """Return the only document of a text that begins at a line of a file; None if it is empty."""
    return read_file("\n" * (line - 1) + text, source, merges_keys=True)


def leaves(node: YamlNode, name: str) -> Iterator[tuple[str, YamlNode]]:
    """Yield each value that is not a mapping with the path of names to it."""
    if isinstance(node.value, dict):
        for key, part in node.value.items():
            yield from leaves(part, f"{name}/{key}" if name else key)
    else:
        yield name, node


def text_of(node: YamlNode, source: str) -> str:
    """Return a value as one line of YAML, as ``read_setting`` accepts it.

    InvalidFile is raised for an angle that is no number, and for binary data.
    """
    value = node.value
    if isinstance(value, list):
        return f"[{', '.join(text_of(part, source) for part in value)}]"
    if isinstance(value, dict):
        parts = (f"{write_setting(key)}: {text_of(part, source)}" for key, part in value.items())
        return f"{{{', '.join(parts)}}}"
    if isinstance(value, bytes):
        what = "binary data is not a value that a parameter can have"
        raise InvalidFile(f"{source}:{node.line}: {what}")
    if node.is_quoted:
        return write_setting(value)
    try:
        return write_setting(_angle(value)) if _ANGLE.fullmatch(value) else _plain(value)
    except (UsageError, ExpressionFault, ValueError) as error:
        raise InvalidFile(f"{source}:{node.line}: {value}: not an angle: {error}") from None


def value_of(node: YamlNode | None) -> object:
    """Return a value as Python's, for JSON."""
    if node is None or node.is_nothing:
        return None
    if isinstance(node.value, list):
        return [value_of(part) for part in node.value]
    if isinstance(node.value, dict):
        return {key: value_of(part) for key, part in node.value.items()}
    return node.value if node.is_quoted or isinstance(node.value, bytes) else guessed(node.value)


def _angle(text: str) -> float:
    """Return an angle [rad]."""
    kind, inside = text[:3], text[4:-1]
    if kind == "deg":
        return math.radians(float(inside))
    return float(str(Expression(inside, _RADIANS).value(_Constants())))


def _plain(text: str) -> str:
    """Return a value without quotes; ``1e3``, text in YAML 1.1, is left to the node's kind."""
    import yaml

    loader = yaml.SafeLoader("")
    tag: str = loader.resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call] # in PyYAML's stubs
    kind = tag.rpartition(":")[2]
    if kind == "null":
        return write_setting(None)
    if kind in _RESOLVED:
        return write_setting(loader.construct_object(yaml.ScalarNode(tag, text)))
    return write_setting(text) if isinstance(guessed(text), str) else text
