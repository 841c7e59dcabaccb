"""The small values of world files: poses, colours, names, other files."""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from lcmtools.errors import InvalidFile, InvalidName
from lcmtools.names import did_you_mean
from lcmtools_sim.geometry import Pose, Vector
from lcmtools_sim.world_file.document import Item

_LARGEST_BYTES = 20_000_000
_SCHEME = "model://"
_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")

Value = TypeVar("Value")


def value(
    keys: Mapping[str, Item], name: str, read: Callable[[Item], Value], default: Value
) -> Value:
    """The value of a key; ``default`` without the key."""
    return read(keys[name]) if name in keys else default


def number(minimum: float, maximum: float) -> Callable[[Item], float]:
    """A reader of numbers within bounds."""
    return lambda item: item.number(minimum, maximum)


length = number(1e-3, 1e4)
"""Reads the side or radius of something [m]."""
friction = number(0, 10)
"""Reads a Coulomb coefficient."""


def pose(item: Item, height: float = 0.0) -> Pose:
    """A pose from [x, y, yaw], then at this height, or from all six numbers."""
    values = item.items(3, 6)
    if len(values) == 3:  # noqa: PLR2004 - x, y, yaw
        x, y, yaw = values
        return Pose(x.number(), y.number(), height, yaw=yaw.angle())
    lengths = [number.number() for number in values[:3]]
    return Pose(*lengths, *[angle.angle() for angle in values[3:]])


def triple(read: Callable[[Item], float]) -> Callable[[Item], Vector]:
    """A reader of lists of three values."""

    def read_triple(item: Item) -> Vector:
        a, b, c = map(read, item.items(3))
        return a, b, c

    return read_triple


color = triple(number(0, 1))
"""Reads red, green and blue, 0 to 1."""


def checked_name(check: Callable[[str], Value]) -> Callable[[Item], Value]:
    """A reader of names: the result of a check that raises InvalidName."""

    def read(item: Item) -> Value:
        try:
            return check(item.text())
        except InvalidName as error:
            raise item.error(error.what, error.hint) from None

    return read


def one_of(item: Item, known: Mapping[str, Value], what: str) -> Value:
    """The value of a word in a table.

    Raises:
        InvalidFile: It is unknown; the hint has the nearest known word.
    """
    word = item.text()
    if word not in known:
        hint = did_you_mean(word, known) or f"known {what}s: {', '.join(known)}"
        raise item.error(f"unknown {what} '{word}'", hint)
    return known[word]


def given_twice(names: Sequence[str]) -> str | None:
    """The first name that is in a list twice."""
    return next((name for name in names if names.count(name) > 1), None)


def named_file(item: Item) -> tuple[str, str]:
    """The text of a file whose path is relative to this one, and its name for messages.

    Raises:
        InvalidFile: It cannot be read.
    """
    path = _beside(item.source, item.text())
    try:
        return read_file(path), str(path)
    except InvalidFile as error:
        raise item.error(error.what, error.hint) from None


def read_file(path: Path) -> str:
    """A file's text.

    Raises:
        InvalidFile: It cannot be read, is no text, or is too large for a description.
    """
    try:
        if path.is_file() and path.stat().st_size > _LARGEST_BYTES:
            raise InvalidFile(f"{path}: is larger than {_LARGEST_BYTES // 1_000_000} MB")
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InvalidFile(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InvalidFile(f"{path}: is not UTF-8 text (byte {error.start})") from None


def find_model(uri: str, source: str) -> Path | None:
    """The SDF file of an include in ``source``; None if there is none.

    model://NAME is searched beside the file, in its folder "models", beside its folder, and in
    Gazebo's model paths; nothing is fetched from the network.
    """
    if uri.startswith(_SCHEME):
        here, name = Path(source).parent, uri.removeprefix(_SCHEME)
        given = (path for key in _PATHS for path in os.environ.get(key, "").split(":") if path)
        folders = [here, here / "models", here.parent, here.parent / "models", *map(Path, given)]
        places = [folder / name for folder in folders]
    elif "://" in uri and not uri.startswith("file://"):
        return None
    else:
        places = [_beside(source, uri.removeprefix("file://"))]
    return next((file for place in places if (file := _model_file(place))), None)


def _beside(source: str, path: str) -> Path:
    return Path(source).parent / Path(path).expanduser()


def _model_file(place: Path) -> Path | None:
    """The file itself, or the SDF file of a model's folder: the newest, if there are several."""
    if place.is_file():
        return place
    plain = place / "model.sdf"
    if plain.is_file():
        return plain
    return max(place.glob("*.sdf"), default=None) if place.is_dir() else None
