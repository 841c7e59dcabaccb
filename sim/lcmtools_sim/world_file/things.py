"""The entries of ``objects``: what stands around, or can be pushed."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from lcmtools_sim.pose import ORIGIN, Pose
from lcmtools_sim.rotation import Vector
from lcmtools_sim.scene import FRICTION, WOOD, Thing
from lcmtools_sim.shapes import GREY, Cuboid, Cylinder, Part, Shape, Sphere
from lcmtools_sim.weight import centre_of
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.frames import Frame, frame_of
from lcmtools_sim.world_file.sdf import read_sdf
from lcmtools_sim.world_file.values import (
    color,
    friction,
    length,
    mass,
    named_file,
    one_of,
    pose,
    value,
)

_COMMON_KEYS = ("type", "name", "pose", "mass", "friction", "color")
_LEG = 0.05
"""[m] Thickness of a table's legs."""
_TOP = 0.03
"""[m] Thickness of a table's top."""


def read_things(item: Item, notes: list[str]) -> tuple[Thing, ...]:
    """Everything that ``objects`` lists; ``notes`` gets what was left out of their files.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    return tuple(thing for entry in item.items() for thing in _things(entry, notes))


def _things(item: Item, notes: list[str]) -> Sequence[Thing]:
    kind = one_of(item.field("type"), {**_READERS, "sdf": None}, "type")
    return kind(item) if kind else _sdf(item, notes)


def _sdf(item: Item, notes: list[str]) -> Sequence[Thing]:
    """What stands in a file of Gazebo, about the pose."""
    keys = item.fields(("type", "file", "pose"), required=["file"])
    found = read_sdf(*named_file(keys["file"]), value(keys, "pose", pose, ORIGIN))
    notes += [note for note in found.notes if note not in notes]
    return found.things


def _box(item: Item) -> list[Thing]:
    keys = item.fields((*_COMMON_KEYS, "size"), required=["size", "pose"])
    size = _size(keys["size"])
    return [_solid(keys, item, Cuboid(size), size[2])]


def _cylinder(item: Item) -> list[Thing]:
    keys = item.fields((*_COMMON_KEYS, "radius", "height"), required=["radius", "height", "pose"])
    height = length(keys["height"])
    return [_solid(keys, item, Cylinder(length(keys["radius"]), height), height)]


def _sphere(item: Item) -> list[Thing]:
    keys = item.fields((*_COMMON_KEYS, "radius"), required=["radius", "pose"])
    radius = length(keys["radius"])
    return [_solid(keys, item, Sphere(radius), 2 * radius)]


def _solid(keys: Mapping[str, Item], item: Item, shape: Shape, height: float) -> Thing:
    """A thing of one part; a pose of three numbers stands it on the ground."""
    part = Part(shape, color=value(keys, "color", color, WOOD))
    return _thing(keys, item, (part,), pose(keys["pose"], height / 2))


def _thing(keys: Mapping[str, Item], item: Item, parts: tuple[Part, ...], place: Pose) -> Thing:
    return Thing(
        name=value(keys, "name", Item.text, item.name),
        parts=parts,
        pose=place,
        mass=value(keys, "mass", mass, 0.0),
        friction=value(keys, "friction", friction, FRICTION),
        where=f"{item.source}:{item.line}",
    )


def _table(item: Item) -> list[Thing]:
    """A table: a top and four legs as one body; the pose is that of its middle."""
    keys = item.fields((*_COMMON_KEYS, "size"), required=["size", "pose"])
    long, wide, high = _size(keys["size"])
    if min(long, wide) < 2 * _LEG or high <= _TOP:
        raise keys["size"].error(f"'size' is too small for a table with legs of {_LEG} m")
    look = value(keys, "color", color, WOOD)
    top = Part(Cuboid((long, wide, _TOP)), (0.0, 0.0, (high - _TOP) / 2), color=look)
    leg = Cuboid((_LEG, _LEG, high - _TOP))
    x, y = (long - _LEG) / 2, (wide - _LEG) / 2
    corners = ((x, y), (x, -y), (-x, y), (-x, -y))
    legs = [Part(leg, (*corner, -_TOP / 2), color=look) for corner in corners]
    parts = (top, *legs)
    centre = Frame(centre_of(parts))
    place = frame_of(pose(keys["pose"], high / 2)).place(centre)
    inside = centre.inverse()
    return [_thing(keys, item, tuple(inside.part(part) for part in parts), place.pose())]


def _walls(item: Item) -> list[Thing]:
    """A wall along a polyline, piece by piece."""
    known = ("type", "name", "points", "closed", "height", "thickness", "friction", "color")
    keys = item.fields(known, required=["points"])
    corners = keys["points"].items()
    if len(corners) < 2:  # noqa: PLR2004 - the ends of a wall
        raise keys["points"].error("'points' must have at least 2 elements")
    pairs = list(pairwise(corners))
    if value(keys, "closed", Item.flag, default=False):
        pairs.append((corners[-1], corners[0]))
    name = value(keys, "name", Item.text, item.name)
    height = value(keys, "height", lambda key: key.number(1e-2, 1e3), 1.0)
    thickness = value(keys, "thickness", lambda key: key.number(1e-2, 1e3), 0.2)
    rough = value(keys, "friction", friction, FRICTION)
    look = value(keys, "color", color, GREY)
    pieces = [_piece(start, end, height, thickness) for start, end in pairs]
    return [
        Thing(name, (Part(Cuboid(size), color=look),), place, friction=rough)
        for size, place in pieces
    ]


def _piece(start: Item, end: Item, height: float, thickness: float) -> tuple[Vector, Pose]:
    """Size and pose of the wall between two points, half a thickness longer at both ends."""
    x0, y0 = (coordinate.number() for coordinate in start.items(2))
    x1, y1 = (coordinate.number() for coordinate in end.items(2))
    long = math.hypot(x1 - x0, y1 - y0)
    if long == 0:
        raise end.error(f"'{end.name}' is the same point as '{start.name}'")
    place = Pose((x0 + x1) / 2, (y0 + y1) / 2, height / 2, yaw=math.atan2(y1 - y0, x1 - x0))
    return (long + thickness, thickness, height), place


def _size(item: Item) -> Vector:
    long, wide, high = (length(side) for side in item.items(3))
    return long, wide, high


_READERS: dict[str, Callable[[Item], list[Thing]]] = {
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "table": _table,
    "walls": _walls,
}
