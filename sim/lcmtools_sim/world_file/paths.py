"""The entries of ``paths``: smooth curves through points, marked on the ground."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

from lcmtools.formats.typed import Item, Within, read
from lcmtools.names import resolve_namespace
from lcmtools_sim.scene import MarkedPath
from lcmtools_sim.shapes import Color, Line
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
