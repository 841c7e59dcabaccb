"""Rays one by one against what geometry says."""

import math

import numpy as np
import pytest

from lcmtools_sim.rotation import from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Shape, Sphere
from lcmtools_sim.vision.rays import cast
from lcmtools_sim.vision.solids import solids_of

INF = math.inf


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
def test_a_ray_goes_to_the_first_surface(
    shape: Shape,
    origin: tuple[float, ...],
    direction: tuple[float, ...],
    distance: float,
) -> None:
    position, rotation = (3.0, -2.0, 1.0), from_euler(0.3, -0.7, 2.0)
    body = solids_of([Part(shape)])

    plain = cast(body, origin, [direction])
    moved = body.placed(position, rotation)
    start = solids_of([Part(shape, origin)]).placed(position, rotation).centres[0]
    along = solids_of([Part(shape, direction)]).placed((0, 0, 0), rotation).centres[0]

    assert plain == pytest.approx([distance], abs=1e-12)
    assert cast(moved, start, [along]) == pytest.approx([distance], abs=1e-9)


def test_rays_meet_the_ground_from_above_only() -> None:
    ground = solids_of([], (0.5, 0.5, 0.5))
    down = [(1, 0, -1), (0, 0, -1), (1, 0, 0), (0, 0, 1)]

    assert cast(ground, (0, 0, 2), down) == pytest.approx([2 * math.sqrt(2), 2, INF, INF])
    assert np.isinf(cast(ground, (0, 0, -2), down)).all()


def test_what_is_further_than_the_longest_ray_is_not_hit() -> None:
    wall = solids_of([Part(Cuboid((2, 90, 90)), (5, 0, 0))])
    rays = [(1, 0, 0), (1, 1, 0)]

    assert cast(wall, (0, 0, 0), rays, longest=5).tolist() == [4, INF]
    assert cast(wall, [(0, 0, 0), (3, 0, 0)], rays, longest=5) == pytest.approx([4, math.sqrt(2)])


def test_a_laser_in_a_square_room_measures_the_walls() -> None:
    walls = [((2.1, 0, 0), (0.2, 5, 1)), ((-2.1, 0, 0), (0.2, 5, 1))]
    walls += [((0, 2.1, 0), (5, 0.2, 1)), ((0, -2.1, 0), (5, 0.2, 1))]
    room = solids_of([Part(Cuboid(size), place) for place, size in walls])
    angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    rays = np.stack((np.cos(angles), np.sin(angles), np.zeros(360)), axis=-1)
    expected = 2 / np.maximum(np.abs(rays[:, 0]), np.abs(rays[:, 1]))

    np.testing.assert_allclose(cast(room, (0, 0, 0), rays), expected, rtol=1e-12)
