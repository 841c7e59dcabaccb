"""The values of world files with their bounds and units, and access to other files.

Every error names the file and the line. Must not know the meaning of keys, worlds or robots.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, TypeAlias, TypeVar

from lcmtools.errors import InvalidFile, InvalidName
from lcmtools.folders import read_text
from lcmtools.formats.typed import Item, Within
from lcmtools.names import did_you_mean
from lcmtools.packages.ros_packages import ros_packages
from lcmtools_sim.geometry import Pose, Vector
from lcmtools_sim.shapes import Color

_LARGEST_BYTES = 20_000_000
_SCHEME = "model://"
_PACKAGE_SCHEME = "package://"
_PATHS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")

Value = TypeVar("Value")
Length: TypeAlias = Annotated[float, Within(1e-3, 1e4)]  # the side or radius of something [m]
Size: TypeAlias = Annotated[Vector, Within(1e-3, 1e4)]  # along x, y and z [m]
Rgb: TypeAlias = Annotated[Color, Within(0, 1)]
Friction: TypeAlias = Annotated[float, Within(0, 10)]  # a Coulomb coefficient
Mass: TypeAlias = Annotated[float, Within(0, 1e5)]  # [kg]; 0 for what does not move


def pose(item: Item, height: float = 0.0) -> Pose:
    """Read a pose from [x, y, yaw], then at this height, or from all six numbers."""
    values = item.items(3, 6)
    if len(values) == 3:  # noqa: PLR2004 - x, y, yaw
        x, y, yaw = values
        return Pose(x.number(), y.number(), height, yaw=yaw.angle())
    lengths = [number.number() for number in values[:3]]
    return Pose(*lengths, *[angle.angle() for angle in values[3:]])


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
