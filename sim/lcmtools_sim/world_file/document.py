"""The values of a YAML document with the types that its reader expects of them.

Every error names the file and the line. Must not know what the keys mean, worlds and robots.
"""

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import TypeVar

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_yaml import Node, read_file
from lcmtools.names import did_you_mean

Number = TypeVar("Number", int, float)


@dataclass(frozen=True, slots=True)
class Item:
    """One value of the document: a scalar, a list or a mapping.

    Its readers raise InvalidFile, with file and line, for a value of another kind.

    Attributes:
        name: Its place in the document, for errors ("pose", "size[2]").
        source: The file that it comes from, for errors.
        node: The value as read.
    """

    name: str
    source: str
    node: Node

    @property
    def line(self) -> int:
        """The line in which the value begins, from 1."""
        return self.node.line

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """Return the error for this value, to be raised by the caller."""
        return InvalidFile(f"{self.source}:{self.line}: {reason}", hint)

    def text(self) -> str:
        """Return the scalar as it is written."""
        if not isinstance(self.node.value, str):
            raise self.error(f"'{self.name}' must be one word or number, not a {self._kind()}")
        text = " ".join(self.node.value.split())  # it may be written over several lines
        if not text:
            raise self.error(f"'{self.name}' has no value")
        if not text.isprintable():
            raise self.error(f"'{self.name}' has characters that cannot be shown")
        return text

    def number(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return a finite number within the bounds; a fraction such as 1/240 is one too."""
        return self._bounded(self._parsed(_parse_number, "a number"), minimum, maximum)

    def angle(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return an angle [rad] within the bounds; "90 deg" is one too."""
        if not self.text().endswith("deg"):
            return self.number(minimum, maximum)
        return self._bounded(self._parsed(_parse_degrees, "an angle"), minimum, maximum)

    def integer(self, minimum: int, maximum: int) -> int:
        """Return a whole number within the bounds."""
        return self._bounded(self._parsed(int, "a whole number"), minimum, maximum)

    def flag(self) -> bool:
        """Return True or False."""
        text = self.text()
        if text.lower() not in ("true", "false"):
            raise self.error(f"'{self.name}' must be true or false, not '{text}'")
        return text.lower() == "true"

    def items(self, *lengths: int) -> list["Item"]:
        """Return the elements of a list, of one of these lengths, if any are given."""
        nodes = self.node.value
        if not isinstance(nodes, list):
            raise self.error(f"'{self.name}' must be a list, not a {self._kind()}")
        if lengths and len(nodes) not in lengths:
            wanted = " or ".join(map(str, lengths))
            raise self.error(f"'{self.name}' must have {wanted} elements, not {len(nodes)}")
        return [Item(f"{self.name}[{i}]", self.source, node) for i, node in enumerate(nodes)]

    def fields(self, known: Collection[str], required: Collection[str] = ()) -> dict[str, "Item"]:
        """Return the values of a mapping by key, in the order of the file."""
        mapping = self._mapping()
        for written, node in mapping.items():
            key = Item("key", self.source, Node(written, node.key_line))
            if (name := key.text()) not in known:
                hint = did_you_mean(name, known) or f"known keys: {', '.join(known)}"
                raise key.error(f"unknown key '{name}' in '{self.name}'", hint)
        for name in required:
            if name not in mapping:
                raise self.error(f"'{self.name}' lacks the key '{name}'")
        return {name: Item(name, self.source, node) for name, node in mapping.items()}

    def field(self, name: str) -> "Item":
        """Return one value of a mapping; the others are not checked."""
        mapping = self._mapping()
        if name not in mapping:
            raise self.error(f"'{self.name}' lacks the key '{name}'")
        return Item(name, self.source, mapping[name])

    def _mapping(self) -> dict[str, Node]:
        if not isinstance(self.node.value, dict):
            raise self.error(f"'{self.name}' must be a mapping (key: value), not a {self._kind()}")
        return self.node.value

    def _parsed(self, parse: Callable[[str], Number], kind: str) -> Number:
        text = self.text()
        try:
            return parse(text)
        except (ValueError, ZeroDivisionError):
            raise self.error(f"'{self.name}' must be {kind}, not '{text}'") from None

    def _bounded(self, value: Number, minimum: float, maximum: float) -> Number:
        if minimum <= value <= maximum:  # refuses NaN too
            return value
        raise self.error(
            f"'{self.name}' must be between {minimum:g} and {maximum:g}, not {value:g}"
        )

    def _kind(self) -> str:
        kinds: dict[type, str] = {list: "list", dict: "mapping"}
        return kinds.get(type(self.node.value), "single value")


def load(text: str, source: str, name: str) -> Item:
    """Return the root of a YAML document; errors name it ``name``.

    Raises:
        InvalidFile: The text is no YAML, or holds no or several documents.
    """
    node = read_file(text, source)
    if node is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return Item(name, source, node)


def _parse_number(text: str) -> float:
    numerator, slash, denominator = text.partition("/")
    return float(numerator) / float(denominator) if slash else float(text)


def _parse_degrees(text: str) -> float:
    return math.radians(float(text.removesuffix("deg")))
