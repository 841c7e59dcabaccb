"""The entries of ``objects``, immovable and movable, and of ``paths``, curves on the ground."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, TypeAlias

from lcmtools.formats.typed import Item, Within, read
from lcmtools.names import resolve_namespace
from lcmtools_sim.geometry import ORIGIN, Frame, Pose
from lcmtools_sim.scene import FRICTION, WOOD, MarkedPath, SceneObject
from lcmtools_sim.shapes import (
    GREY,
    Color,
    Cuboid,
    Cylinder,
    Line,
    Part,
    Shape,
    Sphere,
    centre_of_mass,
    inertials_of,
)
from lcmtools_sim.world_file import values
from lcmtools_sim.world_file.sdf import read_sdf
from lcmtools_sim.world_file.values import Rgb, checked_name

_SPACING = 0.1  # [m]
_BLUE: Color = (0.15, 0.3, 0.8)
Points = list[tuple[float, float]]


def read_paths(item: Item) -> tuple[MarkedPath, ...]:
    """Read all entries of ``paths``."""
    paths: list[MarkedPath] = []
    for entry in item.items():
        path = _path(entry)
        if path.topic in [other.topic for other in paths]:
            raise entry.error(f"two paths have the topic '{path.topic}'")
        paths.append(path)
    return tuple(paths)


@dataclass(frozen=True, slots=True)
class _Entry:
    points: Item
    topic: Annotated[str, checked_name(resolve_namespace)] = "/path"
    closed: bool = False
    width: Annotated[float, Within(0.01, 10)] = 0.05  # [m]
    color: Rgb = _BLUE


def _path(item: Item) -> MarkedPath:
    entry = read(_Entry, item)
    corners = [(x.number(), y.number()) for x, y in (p.items(2) for p in entry.points.items())]
    if entry.closed:
        corners += corners[:1]
    if len(corners) < 2:  # noqa: PLR2004 - the ends of a path
        raise entry.points.error("'points' must have at least 2 elements")
    if any(start == end for start, end in pairwise(corners)):
        raise entry.points.error("two points in succession are the same")
    return MarkedPath(entry.topic, Line(tuple(_curve(corners)), entry.width, entry.color))


def _curve(corners: Points) -> Points:
    """Return a Catmull-Rom spline through all corners, closed if the last one is the first.

    Source: E. Catmull, R. Rom, A class of local interpolating splines, 1974.
    """
    before, after = _reflected(corners[1], corners[0]), _reflected(corners[-2], corners[-1])
    if corners[0] == corners[-1]:
        before, after = corners[-2], corners[1]
    around = [before, *corners, after]
    points = [corners[0]]
    for a, b, c, d in zip(around, around[1:], around[2:], around[3:], strict=False):
        count = math.ceil(math.dist(b, c) / _SPACING)
        for t in (step / count for step in range(1, count + 1)):
            weights = (
                (2 * t * t - t - t**3) / 2,
                (2 - 5 * t * t + 3 * t**3) / 2,
                (t + 4 * t * t - 3 * t**3) / 2,
                (t**3 - t * t) / 2,
            )
            x, y = (
                sum(w * p[i] for w, p in zip(weights, (a, b, c, d), strict=True)) for i in (0, 1)
            )
            points.append((x, y))
    return points


def _reflected(point: tuple[float, float], at: tuple[float, float]) -> tuple[float, float]:
    return 2 * at[0] - point[0], 2 * at[1] - point[1]


_LEG = 0.05  # [m] thickness of a table's legs
_TOP = 0.03  # [m] thickness of a table's top
_Thick: TypeAlias = Annotated[float, Within(1e-2, 1e3)]  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Named(ABC):
    type: str
    name: str = ""

    @abstractmethod
    def objects(self, item: Item) -> Sequence[SceneObject]:
        """Return what the entry stands for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Body(_Named):
    pose: Item
    mass: values.Mass = 0.0
    friction: values.Friction = FRICTION
    color: values.Rgb = WOOD

    def at(self, place: Pose, item: Item, *parts: Part) -> SceneObject:
        """Return an object with these parts."""
        name, where = self.name or item.name, f"{item.source}:{item.line}"
        return SceneObject(name, parts, place, self.mass, self.friction, where)

    def solid(self, item: Item, shape: Shape, height: float) -> SceneObject:
        """Return an object of one part; a pose of three numbers puts it on the ground."""
        part = Part(shape, color=self.color)
        return self.at(values.pose(self.pose, height / 2), item, part)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Box(_Body):
    size: values.Size

    def objects(self, item: Item) -> list[SceneObject]:
        return [self.solid(item, Cuboid(self.size), self.size[2])]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Cylinder(_Body):
    radius: values.Length
    height: values.Length

    def objects(self, item: Item) -> list[SceneObject]:
        return [self.solid(item, Cylinder(self.radius, self.height), self.height)]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sphere(_Body):
    radius: values.Length

    def objects(self, item: Item) -> list[SceneObject]:
        return [self.solid(item, Sphere(self.radius), 2 * self.radius)]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Table(_Body):
    """A top and four legs as one body; the pose is its middle's."""

    size: values.Size

    def objects(self, item: Item) -> list[SceneObject]:
        long, wide, high = self.size
        if min(long, wide) < 2 * _LEG or high <= _TOP:
            raise item.field("size").error(f"'size' is too small for a table with legs of {_LEG} m")
        top = Part(Cuboid((long, wide, _TOP)), (0.0, 0.0, (high - _TOP) / 2), color=self.color)
        leg = Cuboid((_LEG, _LEG, high - _TOP))
        x, y = (long - _LEG) / 2, (wide - _LEG) / 2
        corners = ((x, y), (x, -y), (-x, y), (-x, -y))
        parts = (top, *(Part(leg, (*corner, -_TOP / 2), color=self.color) for corner in corners))
        centre = Frame(centre_of_mass(inertials_of(parts, 1.0))[1])
        place = values.pose(self.pose, high / 2).frame.place(centre)
        inside = centre.inverse()
        return [self.at(place.pose(), item, *(part.placed(*inside) for part in parts))]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Walls(_Named):
    """A wall along a polyline, in pieces that are half a thickness longer at both ends."""

    points: Item
    closed: bool = False
    height: _Thick = 1.0
    thickness: _Thick = 0.2
    friction: values.Friction = FRICTION
    color: values.Rgb = GREY

    def objects(self, item: Item) -> list[SceneObject]:
        corners = self.points.items()
        if len(corners) < 2:  # noqa: PLR2004 - the ends of a wall
            raise self.points.error("'points' must have at least 2 elements")
        found = []
        for start, end in pairwise([*corners, *corners[: self.closed]]):
            long, place = _piece(start, end, self.height)
            shape = Cuboid((long + self.thickness, self.thickness, self.height))
            name, part = self.name or item.name, Part(shape, color=self.color)
            found.append(SceneObject(name, (part,), place, friction=self.friction))
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _File:
    """The content of a Gazebo file, relative to the pose."""

    type: str
    file: Item
    pose: Annotated[Pose, values.pose] = ORIGIN


_KINDS: dict[str, type[_Named]] = {
    "box": _Box,
    "cylinder": _Cylinder,
    "sphere": _Sphere,
    "table": _Table,
    "walls": _Walls,
}


def read_objects(item: Item, notes: list[str]) -> tuple[SceneObject, ...]:
    """Read all entries of ``objects``; ``notes`` gets notes on ignored content of their files."""
    return tuple(found for entry in item.items() for found in _read(entry, notes))


def _read(item: Item, notes: list[str]) -> Sequence[SceneObject]:
    kind = values.one_of(item.field("type"), {**_KINDS, "sdf": None}, "type")
    if kind:
        return read(kind, item).objects(item)
    entry = read(_File, item)
    found = read_sdf(*values.named_file(entry.file), entry.pose)
    notes += [note for note in found.notes if note not in notes]
    return found.objects


def _piece(start: Item, end: Item, height: float) -> tuple[float, Pose]:
    """Return the distance of two points [m], and the pose of the wall between them."""
    x0, y0 = (coordinate.number() for coordinate in start.items(2))
    x1, y1 = (coordinate.number() for coordinate in end.items(2))
    long = math.hypot(x1 - x0, y1 - y0)
    if long == 0:
        raise end.error(f"'{end.name}' is the same point as '{start.name}'")
    yaw = math.atan2(y1 - y0, x1 - x0)
    return long, Pose((x0 + x1) / 2, (y0 + y1) / 2, height / 2, yaw=yaw)
