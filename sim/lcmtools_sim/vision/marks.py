"""Lines on the ground in colour pictures, looked up for each pixel in a map of small cells."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from lcmtools_sim.shapes import Line
from lcmtools_sim.vision.solids import Floats

_CELL, _MOST_CELLS = 0.01, 2000  # size of a cell [m], and most cells per side
NOTHING = -1


class Marks:
    """A map of lines on the plane z = 0."""

    def __init__(self, lines: Sequence[Line]) -> None:
        self.colors = np.array([line.color for line in lines])  # (n, 3), the lines' colours
        widest = max(line.width for line in lines)
        points = np.concatenate([line.points for line in lines])
        self._low = points.min(axis=0) - widest
        extent = points.max(axis=0) + widest - self._low
        self._cell = max(_CELL, extent.max() / _MOST_CELLS)
        self._map = np.full(np.ceil(extent / self._cell).astype(int) + 1, NOTHING, np.int16)
        for number, line in enumerate(lines):
            self._map[tuple(self._cells(_brush(line, self._cell)).T)] = number

    def at(self, places: Floats) -> npt.NDArray[np.int16]:
        """Return the number of the line at each place (n, 2) [m], or NOTHING."""
        cells = self._cells(places)
        inside = ((cells >= 0) & (cells < self._map.shape)).all(axis=1)
        found = np.full(len(places), NOTHING, np.int16)
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
