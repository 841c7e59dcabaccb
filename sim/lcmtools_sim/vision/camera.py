"""A pinhole camera without distortion: which pixel looks where.

Only geometry in the optical frame: z into the scene, x to the right, y down (REP-103). Pixel (i, j)
is column i, row j, and integers are the pixels' centres; the picture reaches half a pixel further.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lcmtools.types.sensor_msgs import CameraInfo
from lcmtools_sim.rotation import Quaternion
from lcmtools_sim.vision.solids import Floats

OPTICAL: Quaternion = (-0.5, 0.5, -0.5, 0.5)
"""The optical frame in a camera's own frame (x forward, y left, z up; REP-103)."""


@dataclass(frozen=True, slots=True)
class Camera:
    """Its picture's size and opening; pixels are square.

    Attributes:
        width: [pixels]
        height: [pixels]
        field_of_view: From the left to the right edge of the picture [rad], between 0 and pi.

    Raises:
        ValueError: It could not make a picture.
    """

    width: int
    height: int
    field_of_view: float

    def __post_init__(self) -> None:
        """Refuse what would give nonsense, such as degrees."""
        if self.width < 1 or self.height < 1:
            raise ValueError(f"a picture of {self.width} x {self.height} pixels")
        if not 0 < self.field_of_view < math.pi:
            raise ValueError(f"a field of view of {self.field_of_view} rad")

    @property
    def focal_length(self) -> float:
        """[pixels], of columns and of rows."""
        return self.width / 2 / math.tan(self.field_of_view / 2)

    @property
    def centre(self) -> tuple[float, float]:
        """Column and row of the optical axis: the middle of the picture."""
        return (self.width - 1) / 2, (self.height - 1) / 2

    def slopes(self) -> tuple[Floats, Floats]:
        """The rays: pixel (i, j) looks along (x[i], y[j], 1). Of shapes (width,), (height,)."""
        column, row = self.centre
        return (
            (np.arange(self.width, dtype=np.float64) - column) / self.focal_length,
            (np.arange(self.height, dtype=np.float64) - row) / self.focal_length,
        )

    def rays(self) -> Floats:
        """Every pixel's ray in the optical frame, its z being 1: (height, width, 3)."""
        x, y = self.slopes()
        return np.stack(np.broadcast_arrays(x, y[:, None], 1.0), axis=-1)

    def project(self, points: npt.ArrayLike) -> Floats:
        """Columns and rows (..., 2) where points (..., 3) [m] of the optical frame appear.

        NaN where a point is not in front of the camera.
        """
        x, y, z = np.moveaxis(np.asarray(points, np.float64), -1, 0)
        forward = np.where(z > 0, z, np.nan)
        slopes = np.stack((x / forward, y / forward), axis=-1)
        pixels: Floats = slopes * self.focal_length + np.array(self.centre)
        return pixels

    def frustum(self, near: float) -> tuple[float, float, float, float]:
        """Where the picture's edges are at distance ``near`` [m]: left, right, bottom, top.

        As OpenGL's glFrustum takes it (y up): another renderer then has exactly the same pixels.
        """
        half_width = near * self.width / 2 / self.focal_length
        half_height = near * self.height / 2 / self.focal_length
        return -half_width, half_width, -half_height, half_height

    def info(self) -> CameraInfo:
        """The sensor_msgs/CameraInfo of every picture; its header is empty."""
        focal, (column, row) = self.focal_length, self.centre
        message = CameraInfo()
        message.width, message.height = self.width, self.height
        message.distortion_model = "plumb_bob"
        message.D = [0.0] * 5
        message.K = _flat((focal, 0, column), (0, focal, row), (0, 0, 1))
        message.R = _flat((1, 0, 0), (0, 1, 0), (0, 0, 1))
        message.P = _flat((focal, 0, column, 0), (0, focal, row, 0), (0, 0, 1, 0))
        return message


def optical(rotation: Quaternion) -> Quaternion:
    """The rotation of the optical frame of a camera whose own frame is turned so."""
    x, y, z, w = rotation
    a, b, c, d = OPTICAL
    return (
        w * a + x * d + y * c - z * b,
        w * b - x * c + y * d + z * a,
        w * c + x * b - y * a + z * d,
        w * d - x * a - y * b - z * c,
    )


def _flat(*rows: Sequence[float]) -> list[float]:
    """A matrix row by row."""
    return [float(value) for row in rows for value in row]
