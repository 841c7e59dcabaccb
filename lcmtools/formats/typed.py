"""Strict reading of YAML and JSON into dataclasses and arguments, by their annotations.

    @dataclass
    class Mount:
        topic: str
        rate: Annotated[float, Within(1e-3, 1e4)] = 50.0  # [Hz]
        pose: Annotated[Pose, read_pose] = ORIGIN  # a function that reads an Item

    mount = read(Mount, item)

A key without a default is required, and an unknown one refused. A value whose annotation is a text
stays as it is. Must not know the meaning of keys.
"""

import math
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, is_dataclass, replace
from functools import cache
from inspect import Parameter, signature
from typing import (
    TYPE_CHECKING,
    Any,
    TypeAlias,
    TypeVar,
    get_args,
    get_origin,
)

from lcmtools.errors import InvalidFile, LcmtoolsError
from lcmtools.formats.strict_yaml import YamlNode, read_file
from lcmtools.names import did_you_mean

if TYPE_CHECKING:
    from typing_extensions import Self

Number = TypeVar("Number", int, float)
T = TypeVar("T")
_Node: TypeAlias = Any  # of a document, as its parser returns it
_Hint: TypeAlias = Any  # a type as annotations have it, or the bounds or function beside it


@dataclass(frozen=True, slots=True)
class Within:
    """The bounds of a number, or of those in a tuple; angles [rad] may be written as "90 deg"."""

    lowest: float = -math.inf
    highest: float = math.inf
    unit: str = ""
    above: str = ""  # the name of a field that must be less


@dataclass(frozen=True, slots=True)
class Item:
    """One value of a YAML document: a scalar, a list or a mapping.

    Its readers raise InvalidFile, with file and line, for a value of the wrong type.
    """

    name: str  # its place in the document, for errors ("pose", "size[2]")
    source: str  # the file that it comes from, for errors
    node: _Node  # the value as the parser returns it: a Node

    @property
    def line(self) -> int:
        """The line in which the value begins, from 1."""
        return int(self.node.line)

    @property
    def content(self) -> object:
        """Scalars as written; lists and mappings of nodes."""
        return self.node.value

    def error(self, reason: str, hint: str = "") -> LcmtoolsError:
        """Return the error for this value, to be raised by the caller."""
        return InvalidFile(f"{self.source}:{self.line}: {reason}", hint)

    def text(self) -> str:
        """Return the scalar as it is written."""
        if not isinstance(self.content, str):
            raise self.error(f"'{self.name}' must be one word or number, not a {self._kind()}")
        text = " ".join(self.content.split())  # it may extend over several lines
        if not text:
            raise self.error(f"'{self.name}' has no value")
        if not text.isprintable():
            raise self.error(f"'{self.name}' has characters that cannot be shown")
        return text

    def number(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return a finite number within the bounds; a fraction such as 1/240 is allowed."""
        return self._bounded(self.parsed(_parse_number, "a number"), minimum, maximum)

    def angle(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return an angle [rad] within the bounds; "90 deg" is allowed."""
        if not self.text().endswith("deg"):
            return self.number(minimum, maximum)
        degrees = self.parsed(lambda text: float(text.removesuffix("deg")), "an angle")
        return self._bounded(math.radians(degrees), minimum, maximum)

    def integer(self, minimum: float, maximum: float) -> int:
        """Return an integer within the bounds."""
        return self._bounded(self.parsed(int, "a whole number"), minimum, maximum)

    def flag(self) -> bool:
        """Return True or False."""
        text = self.text()
        if text.lower() not in ("true", "false"):
            raise self.error(f"'{self.name}' must be true or false, not '{text}'")
        return text.lower() == "true"

    def items(self, *lengths: int) -> list["Self"]:
        """Return the elements of a list, with one of these lengths, if any are given."""
        nodes = self.content
        if not isinstance(nodes, list):
            raise self.error(f"'{self.name}' must be a list, not a {self._kind()}")
        if lengths and len(nodes) not in lengths:
            wanted = " or ".join(map(str, lengths))
            raise self.error(f"'{self.name}' must have {wanted} elements, not {len(nodes)}")
        return [replace(self, name=f"{self.name}[{i}]", node=one) for i, one in enumerate(nodes)]

    def fields(self, allowed: Collection[str], required: Iterable[str] = ()) -> dict[str, "Self"]:
        """Return the values of a mapping by key, in the order of the file."""
        mapping = self._mapping()
        for written, node in mapping.items():
            key = self._key(written, node)
            if (name := key.text()) not in allowed:
                raise key.error(f"unknown key '{name}' in '{self.name}'", _key_hint(name, allowed))
        for name in required:
            self.field(name)
        return self.mapping()

    def mapping(self) -> dict[str, "Self"]:
        """Return the values of a mapping with any keys."""
        found = self._mapping().items()
        return {name: replace(self, name=name, node=node) for name, node in found}

    def field(self, name: str) -> "Self":
        """Return one value of a mapping; the others are not checked."""
        mapping = self._mapping()
        if name not in mapping:
            raise self.error(f"'{self.name}' lacks the key '{name}'")
        return replace(self, name=name, node=mapping[name])

    def parsed(self, parse: Callable[[str], Number], kind: str) -> Number:
        """Return a scalar as a number, of a kind for errors ("an angle")."""
        text = self.text()
        try:
            return parse(text)
        except (ValueError, ZeroDivisionError):
            raise self.error(f"'{self.name}' must be {kind}, not '{text}'") from None

    def _key(self, written: str, node: _Node) -> "Self":
        return replace(self, name="key", node=YamlNode(written, node.key_line))

    def _mapping(self) -> dict[str, Any]:
        if not isinstance(self.content, dict):
            raise self.error(f"'{self.name}' must be a mapping (key: value), not a {self._kind()}")
        return self.content

    def _bounded(self, value: Number, minimum: float, maximum: float) -> Number:
        if minimum <= value <= maximum and abs(value) <= sys.float_info.max:  # also refuses NaN
            return value
        shown = f"{value:g}" if abs(value) <= sys.float_info.max else f"{value}"
        raise self.error(f"'{self.name}' must be between {minimum:g} and {maximum:g}, not {shown}")

    def _kind(self) -> str:
        kinds: dict[type, str] = {list: "list", dict: "mapping"}
        return kinds.get(type(self.content), "single value")


def load(text: str, source: str, name: str) -> Item:
    """Return the root, called ``name``, of the text; InvalidFile unless it is one YAML document."""
    node = read_file(text, source)
    if node is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return Item(name, source, node)


def read(make: Callable[..., T], item: Item) -> T:
    """Return a dataclass, or a function's result, with the values of a mapping as arguments."""
    (given,) = arguments(item, make)
    return make(**given)


def arguments(item: Item, *makers: Callable[..., object]) -> list[dict[str, Any]]:
    """Return the values of a mapping as arguments of each dataclass or function that has the key.

    Of other functions and classes than dataclasses, these are the arguments by keyword only.
    """
    hints = [_hints(one) for one in makers]
    required = [name for known in hints for name, (_, is_required) in known.items() if is_required]
    keys = item.fields(list(dict.fromkeys(name for known in hints for name in known)), required)
    return [
        {name: _value(one, known[name][0]) for name, one in keys.items() if name in known}
        for known in hints
    ]


def bounds(make: Callable[..., object]) -> Mapping[str, Within]:
    """Return the bounds of a dataclass's numbers by name."""
    found = {name: _about(hint)[1] for name, (hint, _) in _hints(make).items()}
    return {name: about for name, about in found.items() if isinstance(about, Within)}


@cache
def _hints(make: Callable[..., object]) -> Mapping[str, tuple[_Hint, bool]]:
    """Return the annotations of arguments by name, and True for those without a default."""
    return {
        name: (one.annotation, one.default is Parameter.empty)
        for name, one in signature(make).parameters.items()
        if is_dataclass(make) or one.kind is Parameter.KEYWORD_ONLY
    }


def _value(item: Item, hint: _Hint, outer: Within | None = None) -> object:
    """Return a value as its annotation describes it, or the one of the tuple around it."""
    kind, about = _about(hint)
    if callable(about):
        return about(item)
    within = about or outer or Within()
    read_float = item.angle if within.unit == "rad" else item.number
    plain: dict[object, Callable[[], object]] = {
        bool: item.flag,
        float: lambda: read_float(within.lowest, within.highest),
        int: lambda: item.integer(within.lowest, within.highest),
        str: item.text,
        tuple: lambda: tuple(_elements(item, get_args(kind), within)),
    }
    origin: object = get_origin(kind)
    if make := plain.get(origin or kind):
        return make()
    if not isinstance(kind, type):
        return item.content
    return item if issubclass(kind, Item) else read(kind, item)


def _elements(item: Item, kinds: tuple[_Hint, ...], within: Within) -> Iterator[object]:
    if kinds[-1] is ...:
        yield from (_value(one, kinds[0], within) for one in item.items())
    else:
        found = item.items(len(kinds))
        yield from (_value(one, kind, within) for one, kind in zip(found, kinds, strict=True))


def _about(hint: _Hint) -> tuple[_Hint, _Hint]:
    """Return an annotated type, and its bounds or function, None without; ``X | None`` is X."""
    kinds = get_args(hint)
    if hasattr(hint, "__metadata__"):
        return kinds
    return _about(kinds[0]) if type(None) in kinds else (hint, None)


def _key_hint(name: str, allowed: Collection[str]) -> str:
    """Return a hint at the keys that contain a name ("noise"), else the most similar, else all."""
    if longer := [key for key in allowed if name in key.split("_")]:
        return f"did you mean {' or '.join(longer)}?"
    return did_you_mean(name, allowed) or f"known keys: {', '.join(allowed)}"


def _parse_number(text: str) -> float:
    numerator, slash, denominator = text.partition("/")
    return float(numerator) / float(denominator) if slash else float(text)
