"""The picture of a whole world."""

import numpy as np
import pytest

from lcmtools_sim.control import _above
from lcmtools_sim.shapes import Cuboid, Part
from lcmtools_sim.vision.camera import Camera, corners_of
from lcmtools_sim.vision.solids import solids_of


@pytest.mark.parametrize(("width", "height"), [(800, 600), (300, 900)])
def test_from_above_everything_is_in_the_picture_to_its_top(width, height):
    parts = [
        Part(Cuboid((1, 1, 4)), (5, 0, 2)),
        Part(Cuboid((1, 1, 0.5)), (-5, 0, 0.25)),
        Part(Cuboid((0.2, 30, 1)), (0, 0, 0.5)),
    ]
    corners = corners_of(solids_of(parts)).reshape(-1, 3)
    camera = Camera(width, height, 1.0)
    x, y, z = _above(corners, camera)
    depth = z - corners[:, 2]
    across = np.abs(corners[:, 0] - x) / depth * camera.focal_length
    along = np.abs(corners[:, 1] - y) / depth * camera.focal_length
    assert 0.75 < max(2 * across.max() / width, 2 * along.max() / height) < 1.0


def test_a_body_that_is_lost_does_not_spoil_the_picture():
    corners = np.array([(np.nan, 0.0, 0.0), (1.0, 1.0, 1.0)])
    assert np.isfinite(_above(corners, Camera(800, 600, 1.0))).all()
