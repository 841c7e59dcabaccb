"""The small values that world files are made of: poses, colours, names, other files."""

from collections.abc import Callable, Mapping
from typing import TypeVar

from lcmtools.errors import InvalidFile, InvalidName
from lcmtools.names import did_you_mean, resolve_namespace
from lcmtools_sim.pose import Pose
from lcmtools_sim.shapes import Color
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.files import beside, read_file

Value = TypeVar("Value")


def value(
    keys: Mapping[str, Item], name: str, read: Callable[[Item], Value], default: Value
) -> Value:
    """What a key says; ``default`` where it is not there."""
    return read(keys[name]) if name in keys else default


def pose(item: Item, standing: float = 0.0) -> Pose:
    """A pose from [x, y, yaw], then at the height ``standing``, or from all six numbers."""
    values = item.items(3, 6)
    if len(values) == 3:  # noqa: PLR2004 - x, y, yaw
        x, y, yaw = values
        return Pose(x.number(), y.number(), standing, yaw=yaw.angle())
    lengths = [number.number() for number in values[:3]]
    return Pose(*lengths, *[angle.angle() for angle in values[3:]])


def length(item: Item) -> float:
    """The side or radius of something [m]."""
    return item.number(1e-3, 1e4)


def friction(item: Item) -> float:
    """A Coulomb coefficient."""
    return item.number(0, 10)


def mass(item: Item) -> float:
    """A mass [kg]; 0 for what stands for ever."""
    return item.number(0, 1e5)


def color(item: Item) -> Color:
    """Red, green and blue, 0 to 1."""
    red, green, blue = (part.number(0, 1) for part in item.items(3))
    return red, green, blue


def namespace(item: Item) -> str:
    """A robot's namespace, global."""
    try:
        return resolve_namespace(item.text())
    except InvalidName as error:
        raise item.error(error.what, error.hint) from None


def named_file(item: Item) -> tuple[str, str]:
    """The text of a file that is named relative to this one, and what messages call it.

    Raises:
        InvalidFile: It cannot be read.
    """
    path = beside(item.source, item.text())
    try:
        return read_file(path), str(path)
    except InvalidFile as error:
        raise item.error(error.what, error.hint) from None


def one_of(item: Item, known: Mapping[str, Value], what: str) -> Value:
    """What a word stands for.

    Raises:
        InvalidFile: It stands for nothing; with what may have been meant.
    """
    word = item.text()
    if word not in known:
        hint = did_you_mean(word, known) or f"known {what}s: {', '.join(known)}"
        raise item.error(f"unknown {what} '{word}'", hint)
    return known[word]
