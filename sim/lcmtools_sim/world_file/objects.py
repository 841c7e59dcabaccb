"""The entries of ``objects``: all immovable and movable objects."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from lcmtools_sim.geometry import ORIGIN, Frame, Pose
from lcmtools_sim.scene import FRICTION, WOOD, SceneObject
from lcmtools_sim.shapes import (
    GREY,
    Cuboid,
    Cylinder,
    Part,
    Shape,
    Sphere,
    centre_of_mass,
    inertials_of,
)
from lcmtools_sim.world_file import values
from lcmtools_sim.world_file.sdf import read_sdf
from lcmtools_sim.world_file.values import Item, value

_COMMON_KEYS = ("type", "name", "pose", "mass", "friction", "color")
_LEG = 0.05  # [m] thickness of a table's legs
_TOP = 0.03  # [m] thickness of a table's top


def read_objects(item: Item, notes: list[str]) -> tuple[SceneObject, ...]:
    """Read all entries of ``objects``; ``notes`` gets notes on ignored content of their files."""
    return tuple(found for entry in item.items() for found in _read(entry, notes))


def _read(item: Item, notes: list[str]) -> Sequence[SceneObject]:
    read = values.one_of(item.field("type"), {**_READERS, "sdf": None}, "type")
    if read:
        return read(item)
    # the content of a Gazebo file, relative to the pose
    keys = item.fields(("type", "file", "pose"), required=["file"])
    found = read_sdf(*values.named_file(keys["file"]), value(keys, "pose", values.pose, ORIGIN))
    notes += [note for note in found.notes if note not in notes]
    return found.objects


def _fields(item: Item, *required: str) -> dict[str, Item]:
    return item.fields((*_COMMON_KEYS, *required), required=[*required, "pose"])


def _box(item: Item) -> list[SceneObject]:
    keys = _fields(item, "size")
    size = values.triple(values.length)(keys["size"])
    return [_solid(keys, item, Cuboid(size), size[2])]


def _cylinder(item: Item) -> list[SceneObject]:
    keys = _fields(item, "radius", "height")
    height = values.length(keys["height"])
    return [_solid(keys, item, Cylinder(values.length(keys["radius"]), height), height)]


def _sphere(item: Item) -> list[SceneObject]:
    keys = _fields(item, "radius")
    radius = values.length(keys["radius"])
    return [_solid(keys, item, Sphere(radius), 2 * radius)]


def _solid(keys: Mapping[str, Item], item: Item, shape: Shape, height: float) -> SceneObject:
    """Return an object of one part; a pose of three numbers puts it on the ground."""
    part = Part(shape, color=value(keys, "color", values.color, WOOD))
    return _object(keys, item, (part,), values.pose(keys["pose"], height / 2))


def _object(
    keys: Mapping[str, Item], item: Item, parts: tuple[Part, ...], place: Pose
) -> SceneObject:
    return SceneObject(
        name=value(keys, "name", Item.text, item.name),
        parts=parts,
        pose=place,
        mass=value(keys, "mass", values.number(0, 1e5), 0.0),
        friction=value(keys, "friction", values.friction, FRICTION),
        where=f"{item.source}:{item.line}",
    )


def _table(item: Item) -> list[SceneObject]:
    """Read a table: a top and four legs as one body; the pose is its middle's."""
    keys = _fields(item, "size")
    long, wide, high = values.triple(values.length)(keys["size"])
    if min(long, wide) < 2 * _LEG or high <= _TOP:
        raise keys["size"].error(f"'size' is too small for a table with legs of {_LEG} m")
    look = value(keys, "color", values.color, WOOD)
    top = Part(Cuboid((long, wide, _TOP)), (0.0, 0.0, (high - _TOP) / 2), color=look)
    leg = Cuboid((_LEG, _LEG, high - _TOP))
    x, y = (long - _LEG) / 2, (wide - _LEG) / 2
    corners = ((x, y), (x, -y), (-x, y), (-x, -y))
    parts = (top, *(Part(leg, (*corner, -_TOP / 2), color=look) for corner in corners))
    centre = Frame(centre_of_mass(inertials_of(parts, 1.0))[1])
    place = values.pose(keys["pose"], high / 2).frame.place(centre)
    inside = centre.inverse()
    return [_object(keys, item, tuple(part.placed(*inside) for part in parts), place.pose())]


def _walls(item: Item) -> list[SceneObject]:
    """Read a wall along a polyline, in pieces that are half a thickness longer at both ends."""
    allowed = ("type", "name", "points", "closed", "height", "thickness", "friction", "color")
    keys = item.fields(allowed, required=["points"])
    corners = keys["points"].items()
    if len(corners) < 2:  # noqa: PLR2004 - the ends of a wall
        raise keys["points"].error("'points' must have at least 2 elements")
    pairs = list(pairwise(corners))
    if value(keys, "closed", Item.flag, default=False):
        pairs.append((corners[-1], corners[0]))
    name = value(keys, "name", Item.text, item.name)
    height = value(keys, "height", values.number(1e-2, 1e3), 1.0)
    thickness = value(keys, "thickness", values.number(1e-2, 1e3), 0.2)
    rough = value(keys, "friction", values.friction, FRICTION)
    look = value(keys, "color", values.color, GREY)
    found = []
    for start, end in pairs:
        long, place = _piece(start, end, height)
        part = Part(Cuboid((long + thickness, thickness, height)), color=look)
        found.append(SceneObject(name, (part,), place, friction=rough))
    return found


def _piece(start: Item, end: Item, height: float) -> tuple[float, Pose]:
    """Return the distance of two points [m], and the pose of the wall between them."""
    x0, y0 = (coordinate.number() for coordinate in start.items(2))
    x1, y1 = (coordinate.number() for coordinate in end.items(2))
    long = math.hypot(x1 - x0, y1 - y0)
    if long == 0:
        raise end.error(f"'{end.name}' is the same point as '{start.name}'")
    yaw = math.atan2(y1 - y0, x1 - x0)
    return long, Pose((x0 + x1) / 2, (y0 + y1) / 2, height / 2, yaw=yaw)


_READERS: dict[str, Callable[[Item], list[SceneObject]]] = {
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "table": _table,
    "walls": _walls,
}
