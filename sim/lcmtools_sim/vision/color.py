"""The picture of a colour camera: the solids' colours in simple light, registered with the depth.

The light is a sun with a fixed direction, without shadows. Shading is Lambert's, wrapped round so
that faces in shade still differ from each other (J. Mitchell et al., Shading in Valve's Source
Engine, SIGGRAPH 2006: half Lambert). Lines on the ground are looked up in a map of small cells.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from lcmtools_sim.shapes import Color, Line
from lcmtools_sim.vision.camera import PixelBounds
from lcmtools_sim.vision.render import GROUND, Rendering
from lcmtools_sim.vision.solids import CUBOID, CYLINDER, Floats
from lcmtools_sim.vision.surfaces import evaluate, surfaces

Pixels = npt.NDArray[np.uint8]
SKY_COLOR: Color = (0.68, 0.80, 0.92)
SUN = np.array((-0.4, -0.6, 1.0)) / np.linalg.norm((-0.4, -0.6, 1.0))  # towards it, in the world
AMBIENT = 0.35  # brightness of faces away from the sun; faces towards it have 1
_UP = np.array((0.0, 0.0, 1.0))
_CELL, _MOST_CELLS = 0.01, 2000  # of the map of lines: size of a cell [m], and most cells per side
_NO_LINE = -1
_ON_CAP = 1 + 1e-5  # a pixel is on a cap whose inverse depth is at most this many times its own


def color_image(view: Rendering) -> Pixels:
    """Return the picture: (height, width, 3) uint8, red, green, blue."""
    picture = np.empty((*view.depth.shape, 4), np.uint8)
    packed = picture.view(np.uint32)[:, :, 0]
    floor = _lit(np.array(view.solids.ground or SKY_COLOR), _UP)
    packed[:] = np.where(view.solid == GROUND, _packed(floor), _packed(np.array(SKY_COLOR)))
    if lines := marks_of(view.solids.lines):
        _draw_lines(packed, view, lines)
    for bounds in view.bounds:
        area = slice(bounds.top, bounds.bottom), slice(bounds.left, bounds.right)
        mask = view.solid[area] == bounds.number
        if not mask.any():
            continue
        if view.solids.kinds[bounds.number] == CUBOID:
            np.copyto(packed[area], _cuboid(view, bounds), where=mask)
        else:
            picture[area][mask] = _bytes(_round(view, bounds, mask))
    return np.ascontiguousarray(picture[:, :, :3])


class Marks:
    """A map of lines on the plane z = 0."""

    def __init__(self, lines: Sequence[Line]) -> None:
        self.colors = np.array([line.color for line in lines])  # (n, 3), the lines' colours
        widest = max(line.width for line in lines)
        points = np.concatenate([line.points for line in lines])
        self._low = points.min(axis=0) - widest
        extent = points.max(axis=0) + widest - self._low
        self._cell = max(_CELL, extent.max() / _MOST_CELLS)
        self._map = np.full(np.ceil(extent / self._cell).astype(int) + 1, _NO_LINE, np.int16)
        for number, line in enumerate(lines):
            self._map[tuple(self._cells(_brush(line, self._cell)).T)] = number

    def at(self, places: Floats) -> npt.NDArray[np.int16]:
        """Return the number of the line at each place (n, 2) [m], or _NO_LINE."""
        cells = self._cells(places)
        inside = ((cells >= 0) & (cells < self._map.shape)).all(axis=1)
        found = np.full(len(places), _NO_LINE, np.int16)
        found[inside] = self._map[tuple(cells[inside].T)]
        return found

    def _cells(self, places: Floats) -> npt.NDArray[np.int64]:
        cells: npt.NDArray[np.int64] = np.floor((places - self._low) / self._cell).astype(np.int64)
        return cells


@lru_cache
def marks_of(lines: tuple[Line, ...]) -> Marks | None:
    """Return the map of some lines; None without any."""
    return Marks(lines) if lines else None


def _brush(line: Line, step: float) -> Floats:
    """Return places (n, 2) that cover a line, at most a step apart."""
    points = np.array(line.points)
    lengths = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    along = np.arange(0.0, lengths[-1] + step / 2, step / 2)
    middle = np.stack([np.interp(along, lengths, points[:, i]) for i in (0, 1)], axis=-1)
    side = np.arange(-line.width / 2, line.width / 2 + step / 4, step / 2)
    disc = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    disc = disc[np.linalg.norm(disc, axis=1) <= line.width / 2]
    places: Floats = (middle[:, None] + disc[None]).reshape(-1, 2)
    return places


def _draw_lines(packed: npt.NDArray[np.uint32], view: Rendering, lines: Marks) -> None:
    rows, columns = np.nonzero(view.solid == GROUND)
    x, y = view.camera.slopes()
    rays = np.stack((x[columns], y[rows], np.ones(len(rows))), axis=-1)
    depth = view.depth[rows, columns]
    places = np.array(view.eye[:2]) + (rays @ view.turn[:2].T) * depth[:, None]
    numbers = lines.at(places)
    colors = _bytes(_lit(lines.colors, np.broadcast_to(_UP, lines.colors.shape))).view(np.uint32)
    seen = numbers != _NO_LINE
    packed[rows[seen], columns[seen]] = colors[numbers[seen], 0]


def _cuboid(view: Rendering, bounds: PixelBounds) -> npt.NDArray[np.uint32]:
    """Return a cuboid's packed colours within its bounds: those of its nearest face."""
    seen = surfaces(view.solids, bounds.number)
    assert seen is not None  # because it is in the picture
    color = view.solids.colors[bounds.number]
    x, y = _slopes(view, bounds)
    colors = np.full((len(y), len(x)), _packed(_lit(color, _normal(view, seen.front[0]))))
    nearest = evaluate(seen.front[0], x, y)
    for form in seen.front[1:]:
        other = evaluate(form, x, y)
        shade = _packed(_lit(color, _normal(view, form)))
        np.copyto(colors, shade, where=other < nearest)
        np.minimum(nearest, other, out=nearest)
    return colors


def _round(view: Rendering, bounds: PixelBounds, mask: npt.NDArray[np.bool_]) -> Floats:
    """Return the colours of the pixels of a sphere or cylinder, (n, 3)."""
    solids, number = view.solids, bounds.number
    x, y = _slopes(view, bounds)
    rows, columns = np.nonzero(mask)
    depth = view.depth[rows + bounds.top, columns + bounds.left]
    rays = np.stack((x[columns], y[rows], np.ones(len(rows))), axis=-1)
    normals = rays * depth[:, None] - solids.centres[number]
    if solids.kinds[number] == CYLINDER:
        axis = solids.axes[number][:, 2]
        normals -= np.outer(normals @ axis, axis)
    normals = normals @ view.turn.T / solids.half_sizes[number, 0]
    seen = surfaces(solids, number)
    for form in seen.front if seen else ():
        normals[(rays @ form) * depth <= _ON_CAP] = _normal(view, form)
    return _lit(solids.colors[number], normals)


def _slopes(view: Rendering, bounds: PixelBounds) -> tuple[Floats, Floats]:
    x, y = view.camera.slopes()
    return x[bounds.left : bounds.right], y[bounds.top : bounds.bottom]


def _normal(view: Rendering, form: Floats) -> Floats:
    """Return the normal of a face's plane, in the world, pointing towards the eye."""
    normal: Floats = -view.turn @ form
    return normal / np.linalg.norm(normal)


def _lit(color: Floats, normals: Floats) -> Floats:
    """Return a colour on surfaces with these normals (..., 3) in the world."""
    facing = (1 + normals @ SUN) / 2
    lit: Floats = (AMBIENT + (1 - AMBIENT) * facing)[..., None] * color
    return lit


def _bytes(colors: Floats) -> Pixels:
    """Return colours (..., 3) from 0 to 1 as (..., 4) bytes, the last one unused."""
    levels = np.rint(np.clip(colors, 0, 1) * 255).astype(np.uint8)
    return np.concatenate((levels, np.zeros((*levels.shape[:-1], 1), np.uint8)), axis=-1)


def _packed(color: Floats) -> np.uint32:
    """Return a colour's four bytes as one number, in memory order."""
    return np.uint32(_bytes(color).view(np.uint32)[0])
