"""Pictures of the world for people: from above, or from behind a robot."""

import math

import numpy as np

from lcmtools_sim.rotation import Quaternion, Vector, add, from_euler, turn, yaw_of
from lcmtools_sim.shapes import Color, Part
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.depth import look
from lcmtools_sim.vision.png import encode_png
from lcmtools_sim.vision.solids import solids_of

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
    places = np.array([part.position for part in parts] or [(0.0, 0.0, 0.0)])
    low, high = places.min(axis=0), places.max(axis=0)
    middle = (low + high) / 2
    extent = np.maximum(high - low, _LEAST_EXTENT) * _MARGIN
    camera = Camera(width, height, _FIELD_OF_VIEW)
    needed = max(extent[0] / width, extent[1] / height) * camera.focal_length
    eye = (float(middle[0]), float(middle[1]), float(high[2] + needed))
    return _picture(parts, ground, camera, eye, _DOWN)


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
