"""Pictures of the world for people: from above, or from behind a robot."""

import math

import numpy as np

from lcmtools_sim.rotation import Quaternion, Vector, add, from_euler, turn, yaw_of
from lcmtools_sim.shapes import Color, Part
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.depth import look
from lcmtools_sim.vision.outlines import corners_of
from lcmtools_sim.vision.png import encode_png
from lcmtools_sim.vision.solids import Floats, solids_of

_FIELD_OF_VIEW = math.radians(60)
_DOWN: Quaternion = (1.0, 0.0, 0.0, 0.0)
"""The optical frame that looks down, the world's x to the right."""
_MARGIN = 1.15
_LEAST_EXTENT = 3.0  # [m]
_BEHIND: Vector = (-3.0, 0.0, 1.8)
"""[m] The eye behind a robot, in its own heading."""
_TILT = math.radians(22)


def from_above(parts: list[Part], ground: Color, width: int, height: int) -> bytes:
    """The whole world as a PNG file: x to the right, y up.

    Args:
        parts: All that is there, in the world.
        ground: Its colour.
        width: [pixels]
        height: [pixels]
    """
    camera = Camera(width, height, _FIELD_OF_VIEW)
    eye = _above(corners_of(solids_of(parts)).reshape(-1, 3), camera)
    return _picture(parts, ground, camera, eye, _DOWN)


def _above(corners: Floats, camera: Camera) -> Vector:
    """From where a camera that looks down sees all these points (n, 3), the high ones too."""
    known = corners[np.isfinite(corners).all(axis=1)]  # what the engine has lost is nowhere
    points = known if len(known) else np.zeros((1, 3))
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    slope = camera.focal_length / np.array((camera.width, camera.height)) * 2 * _MARGIN
    reach = (np.abs(points - middle)[:, :2] * slope).max(axis=1)
    least = _LEAST_EXTENT / 2 * slope.max()
    height = max((points[:, 2] + reach).max(), high[2] + least)
    return float(middle[0]), float(middle[1]), float(height)


def from_behind(
    parts: list[Part],
    ground: Color,
    width: int,
    height: int,
    robot: tuple[Vector, Quaternion],
) -> bytes:
    """What is seen from behind and above a robot, as a PNG file.

    Args:
        parts: All that is there, in the world.
        ground: Its colour.
        width: [pixels]
        height: [pixels]
        robot: Position [m] and rotation of its base_link in the world.
    """
    position, rotation = robot
    heading = yaw_of(rotation)
    eye = add(position, turn(_BEHIND, from_euler(0.0, 0.0, heading)))
    view = optical(from_euler(0.0, _TILT, heading))
    return _picture(parts, ground, Camera(width, height, _FIELD_OF_VIEW), eye, view)


def _picture(
    parts: list[Part], ground: Color, camera: Camera, eye: Vector, rotation: Quaternion
) -> bytes:
    return encode_png(color_image(look(solids_of(parts, ground), camera, eye, rotation)))
