"""A pinhole camera without distortion: the rays of its pixels, and the pixels that solids cover.

Only geometry in the optical frame: z into the scene, x to the right, y down (REP-103). Pixel (i, j)
is column i, row j, and integers are the pixels' centres; the picture reaches half a pixel further.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lcmtools.types.sensor_msgs import CameraInfo
from lcmtools_sim.geometry import Quaternion, multiply
from lcmtools_sim.vision.solids import SPHERE, Floats, Solids

OPTICAL: Quaternion = (-0.5, 0.5, -0.5, 0.5)
"""The optical frame in a camera's own frame (x forward, y left, z up; REP-103)."""
_SLACK = 1e-3  # [pixels] tolerance for rounding
_CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_EDGES = np.array([(i, i + step) for step in (1, 2, 4) for i in range(8) if not i & step])
"""For each edge of a cube, the indices of its two corners."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera's intrinsics; pixels are square; ValueError if they cannot make a picture."""

    width: int  # [pixels]
    height: int  # [pixels]
    field_of_view: float  # from the left to the right edge of the picture [rad], between 0 and pi

    def __post_init__(self) -> None:
        """Refuse nonsense, such as degrees."""
        if self.width < 1 or self.height < 1:
            raise ValueError(f"a picture of {self.width} x {self.height} pixels")
        if not 0 < self.field_of_view < math.pi:
            raise ValueError(f"a field of view of {self.field_of_view} rad")

    @property
    def focal_length(self) -> float:
        """The focal length [pixels], for columns and rows."""
        return self.width / 2 / math.tan(self.field_of_view / 2)

    @property
    def centre(self) -> tuple[float, float]:
        """Column and row of the optical axis: the middle of the picture."""
        return (self.width - 1) / 2, (self.height - 1) / 2

    def slopes(self) -> tuple[Floats, Floats]:
        """The rays: pixel (i, j) looks along (x[i], y[j], 1). Shapes (width,), (height,)."""
        column, row = self.centre
        return (
            (np.arange(self.width, dtype=np.float64) - column) / self.focal_length,
            (np.arange(self.height, dtype=np.float64) - row) / self.focal_length,
        )

    def info(self) -> CameraInfo:
        """Return the sensor_msgs/CameraInfo of every picture, with an empty header."""
        focal, (column, row) = self.focal_length, self.centre
        message = CameraInfo()
        message.width, message.height = self.width, self.height
        message.distortion_model = "plumb_bob"
        message.D = [0.0] * 5
        message.K = _row_major((focal, 0, column), (0, focal, row), (0, 0, 1))
        message.R = _row_major((1, 0, 0), (0, 1, 0), (0, 0, 1))
        message.P = _row_major((focal, 0, column, 0), (0, focal, row, 0), (0, 0, 1, 0))
        return message


def _row_major(*rows: Sequence[float]) -> list[float]:
    return [float(value) for row in rows for value in row]


def optical(rotation: Quaternion) -> Quaternion:
    """Return the rotation of a camera's optical frame from that of its own frame."""
    return multiply(rotation, OPTICAL)


class PixelBounds(NamedTuple):
    """The pixels that a solid can cover: rows top..bottom-1, columns left..right-1."""

    number: int  # number of the solid in its group
    nearest: float  # least depth of its bounding box [m]; 0 or less behind the camera
    left: int
    right: int
    top: int
    bottom: int


def pixel_bounds(solids: Solids, camera: Camera) -> list[PixelBounds]:
    """Return the bounds of all solids (in the optical frame) in view, the nearest first.

    Solids behind the camera or outside the picture have none.
    """
    corners = corners_of(solids)
    depths = corners[:, :, 2]
    nearest, furthest = depths.min(axis=1), depths.max(axis=1)
    lowest, highest = _slope_ranges(corners)
    centre = np.array(camera.centre)
    ends = np.array((camera.width, camera.height))
    first = np.ceil(np.clip(lowest * camera.focal_length + centre - _SLACK, 0, ends))
    last = np.floor(np.clip(highest * camera.focal_length + centre + _SLACK, -1, ends - 1))
    # A body that the engine has lost (NaN) also fails these comparisons.
    in_view = (furthest > 0) & (first <= last).all(axis=1)
    numbers = np.flatnonzero(in_view)
    numbers = numbers[np.argsort(nearest[numbers], kind="stable")]
    edges = np.stack((first, last + 1), axis=-1)[numbers].astype(int).reshape(-1, 4)
    rows = zip(numbers.tolist(), nearest[numbers].tolist(), edges.tolist(), strict=True)
    return [PixelBounds(number, near, *edge) for number, near, edge in rows]


def corners_of(solids: Solids) -> Floats:
    """The corners of the bounding boxes [m]: (n, 8, 3). A sphere's box is aligned with the view."""
    upright = (solids.kinds == SPHERE)[:, None, None]
    turns = np.where(upright, np.eye(3), solids.axes.transpose(0, 2, 1))
    offsets: Floats = (_CUBE * solids.half_sizes[:, None, :]) @ turns
    return offsets + solids.centres[:, None, :]


def _slope_ranges(corners: Floats) -> tuple[Floats, Floats]:
    """Return least and greatest x/z and y/z of each box's part before the camera, (n, 2) each.

    On a convex body, the extremes of x/z are at corners; if the plane z = 0 cuts the body, they are
    on that cut, where x/z is infinite with the sign of x.
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
    """Least and greatest x and y [m] of the boxes' cuts with the plane z = 0, (n, 2) each."""
    start, end = corners[:, _EDGES[:, 0]], corners[:, _EDGES[:, 1]]
    cut = (start[:, :, 2:] > 0) != (end[:, :, 2:] > 0)
    span = np.where(cut, start[:, :, 2:] - end[:, :, 2:], 1.0)
    points = start + (end - start) * (start[:, :, 2:] / span)
    least = np.where(cut, points, np.inf)[:, :, :2].min(axis=1)
    greatest = np.where(cut, points, -np.inf)[:, :, :2].max(axis=1)
    return least, greatest
