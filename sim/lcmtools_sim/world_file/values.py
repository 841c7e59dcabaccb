"""The values of world files, with readers for the expected types, and access to other files.

Every error names the file and the line. Must not know the meaning of keys, worlds or robots.
"""

import math
import os
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from lcmtools.errors import InvalidFile, InvalidName
from lcmtools.folders import read_text
from lcmtools.formats import strict_yaml
from lcmtools.formats.strict_yaml import Node
from lcmtools.names import did_you_mean
from lcmtools.packages.ros_packages import ros_packages
from lcmtools_sim.geometry import Pose, Vector

_LARGEST_BYTES = 20_000_000
_SCHEME = "model://"
_PACKAGE_SCHEME = "package://"
_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")

Number = TypeVar("Number", int, float)
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Item:
    """One value of the document: a scalar, a list or a mapping.

    Its readers raise InvalidFile, with file and line, for a value of the wrong type.
    """

    name: str  # its place in the document, for errors ("pose", "size[2]")
    source: str  # the file that it comes from, for errors
    node: Node  # the value as read

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
        text = " ".join(self.node.value.split())  # it may extend over several lines
        if not text:
            raise self.error(f"'{self.name}' has no value")
        if not text.isprintable():
            raise self.error(f"'{self.name}' has characters that cannot be shown")
        return text

    def number(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return a finite number within the bounds; a fraction such as 1/240 is allowed."""
        return self._bounded(self._parsed(_parse_number, "a number"), minimum, maximum)

    def angle(self, minimum: float = -1e5, maximum: float = 1e5) -> float:
        """Return an angle [rad] within the bounds; "90 deg" is allowed."""
        if not self.text().endswith("deg"):
            return self.number(minimum, maximum)
        degrees = self._parsed(lambda text: float(text.removesuffix("deg")), "an angle")
        return self._bounded(math.radians(degrees), minimum, maximum)

    def integer(self, minimum: int, maximum: int) -> int:
        """Return an integer within the bounds."""
        return self._bounded(self._parsed(int, "a whole number"), minimum, maximum)

    def flag(self) -> bool:
        """Return True or False."""
        text = self.text()
        if text.lower() not in ("true", "false"):
            raise self.error(f"'{self.name}' must be true or false, not '{text}'")
        return text.lower() == "true"

    def items(self, *lengths: int) -> list["Item"]:
        """Return the elements of a list, with one of these lengths, if any are given."""
        nodes = self.node.value
        if not isinstance(nodes, list):
            raise self.error(f"'{self.name}' must be a list, not a {self._kind()}")
        if lengths and len(nodes) not in lengths:
            wanted = " or ".join(map(str, lengths))
            raise self.error(f"'{self.name}' must have {wanted} elements, not {len(nodes)}")
        return [Item(f"{self.name}[{i}]", self.source, node) for i, node in enumerate(nodes)]

    def fields(self, allowed: Collection[str], required: Collection[str] = ()) -> dict[str, "Item"]:
        """Return the values of a mapping by key, in the order of the file."""
        mapping = self._mapping()
        for written, node in mapping.items():
            key = Item("key", self.source, Node(written, node.key_line))
            if (name := key.text()) not in allowed:
                raise key.error(f"unknown key '{name}' in '{self.name}'", _key_hint(name, allowed))
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
        if minimum <= value <= maximum:  # also refuses NaN
            return value
        shown = f"{value:g}" if abs(value) <= sys.float_info.max else f"{value}"
        raise self.error(f"'{self.name}' must be between {minimum:g} and {maximum:g}, not {shown}")

    def _kind(self) -> str:
        kinds: dict[type, str] = {list: "list", dict: "mapping"}
        return kinds.get(type(self.node.value), "single value")


def _key_hint(name: str, allowed: Collection[str]) -> str:
    """Return a hint at the keys that contain a name ("noise"), else the most similar, else all."""
    if longer := [key for key in allowed if name in key.split("_")]:
        return f"did you mean {' or '.join(longer)}?"
    return did_you_mean(name, allowed) or f"known keys: {', '.join(allowed)}"


def load(text: str, source: str, name: str) -> Item:
    """Return the root, called ``name``, of the text; InvalidFile unless it is one YAML document."""
    node = strict_yaml.read_file(text, source)
    if node is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return Item(name, source, node)


def _parse_number(text: str) -> float:
    numerator, slash, denominator = text.partition("/")
    return float(numerator) / float(denominator) if slash else float(text)


def value(
    keys: Mapping[str, Item], name: str, read: Callable[[Item], Value], default: Value
) -> Value:
    """Return the value of a key; ``default`` without the key."""
    return read(keys[name]) if name in keys else default


def number(minimum: float, maximum: float) -> Callable[[Item], float]:
    """Return a reader of numbers within bounds."""
    return lambda item: item.number(minimum, maximum)


length = number(1e-3, 1e4)  # reads the side or radius of something [m]
friction = number(0, 10)  # reads a Coulomb coefficient


def pose(item: Item, height: float = 0.0) -> Pose:
    """Read a pose from [x, y, yaw], then at this height, or from all six numbers."""
    values = item.items(3, 6)
    if len(values) == 3:  # noqa: PLR2004 - x, y, yaw
        x, y, yaw = values
        return Pose(x.number(), y.number(), height, yaw=yaw.angle())
    lengths = [number.number() for number in values[:3]]
    return Pose(*lengths, *[angle.angle() for angle in values[3:]])


def triple(read: Callable[[Item], float]) -> Callable[[Item], Vector]:
    """Return a reader of lists of three values."""

    def read_triple(item: Item) -> Vector:
        a, b, c = map(read, item.items(3))
        return a, b, c

    return read_triple


color = triple(number(0, 1))  # reads red, green and blue, 0 to 1


def checked_name(check: Callable[[str], str | None]) -> Callable[[Item], str]:
    """Return a reader of names, as returned by ``check`` or not refused by it with InvalidName."""

    def read(item: Item) -> str:
        try:
            return check(item.text()) or item.text()
        except InvalidName as error:
            raise item.error(error.what, error.hint) from None

    return read


def one_of(item: Item, table: Mapping[str, Value], what: str) -> Value:
    """Return the value of a word in a table; an unknown word gets the most similar one as hint."""
    word = item.text()
    if word not in table:
        hint = did_you_mean(word, table) or f"known {what}s: {', '.join(table)}"
        raise item.error(f"unknown {what} '{word}'", hint)
    return table[word]


def given_twice(names: Sequence[str]) -> str | None:
    """Return the first name that occurs twice in a list."""
    return next((name for name in names if names.count(name) > 1), None)


def named_file(item: Item) -> tuple[str, str]:
    """Return the text of a file whose path is relative to this one, and its name for messages."""
    path = _beside(item.source, item.text())
    try:
        return read_file(path), str(path)
    except InvalidFile as error:
        raise item.error(error.what, error.hint) from None


def read_file(path: Path) -> str:
    """Read a file's text; InvalidFile if it is not readable text, or too large for a model."""
    return read_text(path, _LARGEST_BYTES)


def find_model(uri: str, source: str) -> Path | None:
    """Return the SDF file of an include in ``source``; None if there is none.

    model://NAME is searched for beside the file, in its folder "models", beside its folder, and in
    Gazebo's model paths, and package://NAME/PATH in the ROS packages near the file and in
    ROS_PACKAGE_PATH; nothing is fetched from the network.
    """
    if uri.startswith(_SCHEME):
        here, name = Path(source).parent, uri.removeprefix(_SCHEME)
        given = (path for key in _PATHS for path in os.environ.get(key, "").split(":") if path)
        folders = [here, here / "models", here.parent, here.parent / "models", *map(Path, given)]
        places = [folder / name for folder in folders]
    elif uri.startswith(_PACKAGE_SCHEME):
        name, _, rest = uri.removeprefix(_PACKAGE_SCHEME).partition("/")
        folder = ros_packages(Path(source).resolve().parent).get(name)
        places = [folder / rest] if folder else []
    elif "://" in uri and not uri.startswith("file://"):
        return None
    else:
        places = [_beside(source, uri.removeprefix("file://"))]
    return next((file for place in places if (file := _model_file(place))), None)


def _beside(source: str, path: str) -> Path:
    return Path(source).parent / Path(path).expanduser()


def _model_file(place: Path) -> Path | None:
    """The file itself, or the SDF file in a model's folder: the newest, if there are several."""
    try:
        place.stat()
    except (OSError, ValueError):  # it is not there, must not be read, or is not a path
        return None
    if place.is_file():
        return place
    plain = place / "model.sdf"
    if plain.is_file():
        return plain
    return max(place.glob("*.sdf"), default=None) if place.is_dir() else None
