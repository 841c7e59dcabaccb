"""Where in a picture solids can be: the rectangles of pixels that their bounding boxes cover.

Solids are in the optical frame of the camera. Nothing of their exact shape is known here.
"""

from typing import NamedTuple

import numpy as np

from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.solids import SPHERE, Floats, Solids

_SLACK = 1e-3  # [pixels] for what rounding may have shifted


class Outline(NamedTuple):
    """The pixels that a solid can cover: rows top..bottom-1, columns left..right-1.

    Attributes:
        number: Of the solid in its group.
        nearest: Least depth of its bounding box [m]; 0 or less when it reaches behind the camera.
    """

    number: int
    nearest: float
    left: int
    right: int
    top: int
    bottom: int


def outlines(solids: Solids, camera: Camera, far: float) -> list[Outline]:
    """The outlines of all solids that the camera may see, the nearest first.

    Left out is what lies behind the camera, further than ``far`` [m] or beside the picture.
    """
    corners = corners_of(solids)
    depths = corners[:, :, 2]
    nearest, furthest = depths.min(axis=1), depths.max(axis=1)
    lowest, highest = _slope_ranges(corners)
    centre = np.array(camera.centre)
    ends = np.array((camera.width, camera.height))
    first = np.ceil(np.clip(lowest * camera.focal_length + centre - _SLACK, 0, ends))
    last = np.floor(np.clip(highest * camera.focal_length + centre + _SLACK, -1, ends - 1))
    # A body that the engine has lost (NaN) fails these comparisons, too.
    seen = (furthest > 0) & (nearest <= far) & (first <= last).all(axis=1)
    numbers = np.flatnonzero(seen)
    numbers = numbers[np.argsort(nearest[numbers], kind="stable")]
    bounds = np.stack((first, last + 1), axis=-1)[numbers].astype(int).reshape(-1, 4)
    return [
        Outline(number, near, *bound)
        for number, near, bound in zip(
            numbers.tolist(), nearest[numbers].tolist(), bounds.tolist(), strict=True
        )
    ]


_CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_EDGES = np.array([(i, i + step) for step in (1, 2, 4) for i in range(8) if not i & step])


def corners_of(solids: Solids) -> Floats:
    """The corners of the bounding boxes [m]: (n, 8, 3). A ball's box stands along the view."""
    upright = (solids.kinds == SPHERE)[:, None, None]
    turns = np.where(upright, np.eye(3), solids.axes.transpose(0, 2, 1))
    offsets: Floats = (_CUBE * solids.half_sizes[:, None, :]) @ turns
    return offsets + solids.centres[:, None, :]


def _slope_ranges(corners: Floats) -> tuple[Floats, Floats]:
    """Least and greatest x/z and y/z of what of each box is in front of the camera, (n, 2) each.

    Over a convex body x/z has its extremes at a corner; where the body is cut at z = 0, on that
    cut, where x/z is infinite with the sign of x.
    """
    depths = corners[:, :, 2:]
    ahead = depths > 0
    slopes = np.divide(corners[:, :, :2], depths, where=ahead, out=np.zeros_like(corners[:, :, :2]))
    lowest = np.where(ahead, slopes, np.inf).min(axis=1)
    highest = np.where(ahead, slopes, -np.inf).max(axis=1)
    crossing = np.flatnonzero(ahead.any(axis=(1, 2)) & ~ahead.all(axis=(1, 2)))
    if len(crossing):
        left, right = _cut(corners[crossing])
        lowest[crossing] = np.where(left <= 0, -np.inf, lowest[crossing])
        highest[crossing] = np.where(right >= 0, np.inf, highest[crossing])
    return lowest, highest


def _cut(corners: Floats) -> tuple[Floats, Floats]:
    """Least and greatest x and y [m] where boxes are cut by the plane z = 0, (n, 2) each."""
    start, end = corners[:, _EDGES[:, 0]], corners[:, _EDGES[:, 1]]
    cut = (start[:, :, 2:] > 0) != (end[:, :, 2:] > 0)
    span = np.where(cut, start[:, :, 2:] - end[:, :, 2:], 1.0)
    points = start + (end - start) * (start[:, :, 2:] / span)
    least = np.where(cut, points, np.inf)[:, :, :2].min(axis=1)
    greatest = np.where(cut, points, -np.inf)[:, :, :2].max(axis=1)
    return least, greatest
