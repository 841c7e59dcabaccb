"""Pictures of the world from above, or from behind a robot."""

import math

import numpy as np

from lcmtools_sim.geometry import Frame, Quaternion, Vector, add, from_euler, rotate, yaw_of
from lcmtools_sim.vision.camera import Camera, corners_of, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.messages import png_file
from lcmtools_sim.vision.render import render
from lcmtools_sim.vision.solids import Floats, Solids

_FIELD_OF_VIEW = math.radians(60)
_DOWN: Quaternion = (1.0, 0.0, 0.0, 0.0)
"""The rotation of an optical frame that looks down, with the world's x to the right."""
_MARGIN = 1.15
_LEAST_EXTENT = 3.0  # [m]
_BEHIND: Vector = (-3.0, 0.0, 1.8)  # [m] the eye behind a robot, in a frame with its heading
_TILT = math.radians(22)


def snapshot(solids: Solids, width: int, height: int, robot: Frame | None = None) -> bytes:
    """Return a PNG file of the whole world from above (x right, y up), or from behind a robot.

    ``solids`` are all shapes and ``robot`` is the robot's base_link, in the world.
    """
    camera = Camera(width, height, _FIELD_OF_VIEW)
    if robot is None:
        eye, view = _above(corners_of(solids).reshape(-1, 3), camera), _DOWN
    else:
        heading = yaw_of(robot.rotation)
        eye = add(robot.position, rotate(_BEHIND, from_euler(0.0, 0.0, heading)))
        view = optical(from_euler(0.0, _TILT, heading))
    return png_file(color_image(render(solids, camera, eye, view)))


def _above(corners: Floats, camera: Camera) -> Vector:
    """The eye of a camera that looks down and sees all these points (n, 3), even high ones."""
    finite = corners[np.isfinite(corners).all(axis=1)]  # except bodies that the engine has lost
    points = finite if len(finite) else np.zeros((1, 3))
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    slope = camera.focal_length / np.array((camera.width, camera.height)) * 2 * _MARGIN
    reach = (np.abs(points - middle)[:, :2] * slope).max(axis=1)
    least = _LEAST_EXTENT / 2 * slope.max()
    height = max((points[:, 2] + reach).max(), high[2] + least)
    return float(middle[0]), float(middle[1]), float(height)
