"""A scan is what the textbook's rays say, one by one, whatever stands around and moves."""

import math

import numpy as np
import pytest

from lcmtools_sim.rotation import Vector, axes, from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.vision.rays import cast
from lcmtools_sim.vision.scan import Scannable, scan, scannable
from lcmtools_sim.vision.solids import Floats, joined, matrix, solids_of

LONGEST = 10.0


def circle(rotation: tuple[float, float, float, float]) -> tuple[Floats, Vector]:
    """Rays all around in the plane of a turned sensor, and its normal."""
    angles = np.linspace(-math.pi, math.pi, 721)
    rays = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=1)
    return rays @ matrix(rotation).T, axes(rotation)[2]


def clutter(random: np.random.Generator, count: int) -> list[Part]:
    parts = []
    for number in range(count):
        a, b, c = random.uniform(0.1, 1.5, 3).tolist()
        shape = (Cuboid((a, b, c)), Cuboid((a, b, 4 * c)), Cylinder(a / 2, b), Sphere(a / 2))[
            number % 4
        ]
        x, y, z = random.uniform((-9, -9, 0), (9, 9, 2)).tolist()
        turned = from_euler(*random.uniform(-1, 1, 3).tolist())
        parts.append(Part(shape, (x, y, z), turned if number % 3 else (0.0, 0.0, 0.0, 1.0)))
    return parts


@pytest.mark.parametrize("seed", range(20))
def test_it_agrees_with_single_rays(seed: int) -> None:
    random = np.random.default_rng(seed)
    fixed, body = solids_of(clutter(random, 24), (0, 0, 0)), solids_of(clutter(random, 5))
    pose = (1.0, -2.0, 0.3), from_euler(0.1, 0.2, 2.0)
    tilt = from_euler(*(random.uniform(-0.3, 0.3, 3) * (seed % 2)).tolist())
    rays, up = circle(tilt)
    eye = (0.3, 0.2, 0.4)

    distances = scan([scannable(fixed), scannable(body).placed(*pose)], eye, rays, up, LONGEST)

    expected = cast(joined(fixed, body.placed(*pose)), eye, rays, LONGEST)
    seen = np.isfinite(expected)
    assert seen.mean() > 0.1
    assert (np.isfinite(distances) == seen).mean() > 0.998  # rays along an edge may miss it
    both = seen & np.isfinite(distances)
    assert np.quantile(np.abs(distances[both] - expected[both]), 0.995) < 1e-9


def look(*groups: Scannable, eye: Vector = (0.0, 0.0, 0.5)) -> Floats:
    rays, up = circle((0.0, 0.0, 0.0, 1.0))
    return scan(groups, eye, rays, up, LONGEST)


def test_nothing_is_infinitely_far() -> None:
    assert np.isposinf(look(scannable(solids_of([])))).all()


def test_a_box_around_the_eye_is_not_seen_and_what_is_behind_it_is() -> None:
    housing = Part(Cuboid((0.4, 0.4, 0.4)), (0.0, 0.0, 0.5))
    wall = Part(Cuboid((0.2, 40.0, 2.0)), (4.1, 0.0, 1.0))

    distances = look(scannable(solids_of([housing, wall])))

    assert distances[360] == pytest.approx(4.0)
    assert np.isposinf(distances[0])


def test_what_is_above_or_below_the_scans_plane_is_not_hit() -> None:
    low = Part(Cuboid((0.2, 4.0, 0.4)), (2.0, 0.0, 0.2))
    high = Part(Cylinder(0.5, 0.4), (3.0, 0.0, 0.8))

    assert np.isposinf(look(scannable(solids_of([low, high])))).all()


def test_the_ground_is_hit_by_rays_that_point_down() -> None:
    rays, up = circle(from_euler(0.0, 0.1, 0.0))

    distances = scan([], (0.0, 0.0, 0.5), rays, up, LONGEST)

    assert distances[360] == pytest.approx(0.5 / math.sin(0.1))
    assert np.isposinf(distances[0])
