"""A YAML text as a tree that remembers its lines, so that every complaint can name one.

Scalars stay text until the reader says what they are: that way ``1e3`` is a number, ``no`` a
name, and neither depends on the special cases of YAML 1.1. What the keys mean is none of this
module's business; it knows neither worlds nor robots.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass

import yaml

from lcmtools.errors import InvalidFile
from lcmtools.names import did_you_mean

_MERGE = "<<"
"""YAML 1.1's key for the keys of another mapping: readers would have to look elsewhere."""


@dataclass(frozen=True, slots=True)
class Item:
    """One value of the document: a scalar, a list or a mapping.

    Attributes:
        name: Where it stands, for messages ("pose", "size[2]").
        source: The file that it comes from, for messages.
        node: What PyYAML read.
    """

    name: str
    source: str
    node: yaml.Node

    @property
    def line(self) -> int:
        """The line in which the value begins, from 1."""
        return int(self.node.start_mark.line) + 1

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """The error that says what is wrong with this value, to be raised by the caller."""
        return InvalidFile(f"{self.source}:{self.line}: {reason}", hint)

    def text(self) -> str:
        """The scalar as it is written.

        Raises:
            InvalidFile: It is no scalar, empty, or not printable.
        """
        if not isinstance(self.node, yaml.ScalarNode):
            raise self.error(f"'{self.name}' must be one word or number, not a {self._kind()}")
        text = " ".join(self.node.value.split())  # it may be written over several lines
        if not text:
            raise self.error(f"'{self.name}' has no value")
        if not text.isprintable():
            raise self.error(f"'{self.name}' has characters that cannot be shown")
        return text

    def number(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """A finite number within the bounds; a fraction such as 1/240 is one too.

        Raises:
            InvalidFile: It is not a number, or out of bounds.
        """
        text = self.text()
        try:
            value = _parse_number(text)
        except (ValueError, ZeroDivisionError):
            raise self.error(f"'{self.name}' must be a number, not '{text}'") from None
        return self._check_bounds(value, minimum, maximum)

    def angle(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """An angle [rad] within the bounds; "90 deg" is one too.

        Raises:
            InvalidFile: It is no angle, or out of bounds.
        """
        text = self.text()
        if not text.endswith("deg"):
            return self.number(minimum, maximum)
        try:
            degrees = float(text.removesuffix("deg"))
            return self._check_bounds(math.radians(degrees), minimum, maximum)
        except ValueError:
            raise self.error(f"'{self.name}' must be an angle, not '{text}'") from None

    def integer(self, minimum: int, maximum: int) -> int:
        """A whole number within the bounds.

        Raises:
            InvalidFile: It is not a whole number, or out of bounds.
        """
        text = self.text()
        try:
            value = int(text)
        except ValueError:
            raise self.error(f"'{self.name}' must be a whole number, not '{text}'") from None
        self._check_bounds(value, minimum, maximum)
        return value

    def flag(self) -> bool:
        """True or false.

        Raises:
            InvalidFile: It is neither.
        """
        text = self.text()
        if text.lower() not in ("true", "false"):
            raise self.error(f"'{self.name}' must be true or false, not '{text}'")
        return text.lower() == "true"

    def items(self, *lengths: int) -> list["Item"]:
        """The elements of a list, which has one of ``lengths`` where any are given.

        Raises:
            InvalidFile: It is no list, or of another length.
        """
        if not isinstance(self.node, yaml.SequenceNode):
            raise self.error(f"'{self.name}' must be a list, not a {self._kind()}")
        nodes = self.node.value
        if lengths and len(nodes) not in lengths:
            wanted = " or ".join(map(str, lengths))
            raise self.error(f"'{self.name}' must have {wanted} elements, not {len(nodes)}")
        return [Item(f"{self.name}[{i}]", self.source, node) for i, node in enumerate(nodes)]

    def fields(self, known: Collection[str], required: Collection[str] = ()) -> dict[str, "Item"]:
        """The values of a mapping by key, in the order of the file.

        Raises:
            InvalidFile: It is no mapping; a key is unknown, given twice, missing or no scalar.
        """
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"'{self.name}' must be a mapping (key: value), not a {self._kind()}")
        found: dict[str, Item] = {}
        for key_node, value_node in self.node.value:
            key = self._key(key_node)
            name = key.text()
            if name not in known:
                raise key.error(f"unknown key '{name}' in '{self.name}'", _hint(name, known))
            if name in found:
                raise key.error(f"key '{name}' is given twice in '{self.name}'")
            found[name] = Item(name, self.source, value_node)
        for name in required:
            if name not in found:
                raise self.error(f"'{self.name}' lacks the key '{name}'")
        return found

    def field(self, name: str) -> "Item":
        """One value of a mapping, without a look at the others.

        Raises:
            InvalidFile: It is no mapping, or has no such key.
        """
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"'{self.name}' must be a mapping (key: value), not a {self._kind()}")
        for key_node, value_node in self.node.value:
            if self._key(key_node).node.value == name:
                return Item(name, self.source, value_node)
        raise self.error(f"'{self.name}' lacks the key '{name}'")

    def _key(self, node: yaml.Node) -> "Item":
        """One key of a mapping.

        Raises:
            InvalidFile: It is one that takes in another mapping.
        """
        key = Item("key", self.source, node)
        if node.value == _MERGE:
            raise key.error("'<<' does not take in other keys here", "write them out")
        return key

    def _check_bounds(self, value: float, minimum: float, maximum: float) -> float:
        if not minimum <= value <= maximum:  # refuses NaN too
            raise self.error(
                f"'{self.name}' must be between {minimum:g} and {maximum:g}, not {value:g}"
            )
        return value

    def _kind(self) -> str:
        if isinstance(self.node, yaml.SequenceNode):
            return "list"
        return "mapping" if isinstance(self.node, yaml.MappingNode) else "single value"


def load(text: str, source: str, name: str) -> Item:
    """The root of a YAML document; ``name`` is what messages call it.

    Raises:
        InvalidFile: The text is no YAML, or holds no or several documents.
    """
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 1
        raise InvalidFile(f"{source}:{line}: not YAML: {error.problem or error.context}") from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise InvalidFile(f"{source}:{line}: not YAML: {error.reason}") from None
    except RecursionError:
        raise InvalidFile(f"{source}:1: not a {name}: nested too deeply") from None
    if node is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return Item(name, source, node)


def _parse_number(text: str) -> float:
    numerator, slash, denominator = text.partition("/")
    return float(numerator) / float(denominator) if slash else float(text)


def _hint(name: str, known: Collection[str]) -> str:
    return did_you_mean(name, known) or f"known keys: {', '.join(known)}"
