"""Single rays of a scan against known answers."""

import math

import numpy as np
import pytest
from fixtures.plain_rays import cast

from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.vision.scan import Scanner
from lcmtools_sim.vision.solids import solids_of

INF = math.inf
FAR_ABOVE = (3.0, -2.0, 100.0)  # out of reach of the ground


@pytest.mark.parametrize(
    ("shape", "origin", "direction", "distance"),
    [
        (Cuboid((2, 4, 6)), (-5, 0, 0), (1, 0, 0), 4),
        (Cuboid((2, 4, 6)), (-5, 1.99, 0), (7, 0, 0), 4),  # the direction's length is no matter
        (Cuboid((2, 4, 6)), (-5, 2.01, 0), (1, 0, 0), INF),
        (Cuboid((2, 4, 6)), (0, 0, 9), (0, 0, -1), 6),
        (Cuboid((2, 4, 6)), (0, 0, 9), (0, 0, 1), INF),
        (Cuboid((2, 4, 6)), (-5, 0, 0), (1, 0.25, 0), 4 * math.hypot(1, 0.25)),
        (Cuboid((2, 4, 6)), (0.5, 0.5, 0.5), (1, 0, 0), INF),  # from within
        (Cylinder(2, 6), (-5, 0, 0), (1, 0, 0), 3),
        (Cylinder(2, 6), (-5, 1.2, 0), (1, 0, 0), 5 - 1.6),
        (Cylinder(2, 6), (-5, 0, 3.1), (1, 0, 0), INF),
        (Cylinder(2, 6), (1.9, 0, 5), (0, 0, -1), 2),
        (Cylinder(2, 6), (2.1, 0, 5), (0, 0, -1), INF),
        (Cylinder(2, 6), (-3, 0, 5), (1, 0, -1), 2 * math.sqrt(2)),
        (Cylinder(2, 6), (0, 0, 0), (0, 0, 1), INF),
        (Sphere(2), (-5, 0, 0), (1, 0, 0), 3),
        (Sphere(2), (-5, 1.2, 0), (1, 0, 0), 5 - 1.6),
        (Sphere(2), (-5, 2.1, 0), (1, 0, 0), INF),
        (Sphere(2), (5, 0, 0), (1, 0, 0), INF),
        (Sphere(2), (1, 0, 0), (1, 0, 0), INF),
    ],
)
def test_a_ray_goes_to_the_first_surface(shape, origin, direction, distance):
    rotation = from_euler(0.3, -0.7, 2.0)
    body = solids_of([Part(shape)])
    start = solids_of([Part(shape, origin)]).placed(FAR_ABOVE, rotation).centres[0]
    x, y, z = solids_of([Part(shape, direction)]).placed((0, 0, 0), rotation).centres[0]
    towards = from_euler(0.0, -math.atan2(z, math.hypot(x, y)), math.atan2(y, x))
    ranges = Scanner(np.array((0.0, 1e-6)), 50.0).scan(
        tuple(start), towards, [(body, FAR_ABOVE, rotation)]
    )
    assert ranges[0] == pytest.approx(distance, abs=1e-9)
    assert cast(body, origin, [direction]) == pytest.approx([distance], abs=1e-12)


def test_a_laser_in_a_square_room_measures_the_walls():
    walls = [((2.1, 0, 1), (0.2, 5, 1)), ((-2.1, 0, 1), (0.2, 5, 1))]
    walls += [((0, 2.1, 1), (5, 0.2, 1)), ((0, -2.1, 1), (5, 0.2, 1))]
    room = solids_of([Part(Cuboid(size), place) for place, size in walls])
    angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    expected = 2 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    ranges = Scanner(angles, 10.0).scan((0, 0, 1), (0, 0, 0, 1), [(room, (0, 0, 0), (0, 0, 0, 1))])
    np.testing.assert_allclose(ranges, expected, rtol=1e-12)
