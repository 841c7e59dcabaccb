"""A scan is what the textbook's rays say, one by one, whatever stands around and moves."""

import math

import numpy as np
import pytest
from fixtures.plain_rays import cast

from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.vision.scan import Scanner
from lcmtools_sim.vision.solids import joined, matrix, solids_of

LONGEST = 10.0
LEVEL = (0.0, 0.0, 0.0, 1.0)
HERE = (0.0, 0.0, 0.0), LEVEL
EYE = (0.3, 0.2, 0.4)
CIRCLE = np.linspace(-math.pi, math.pi, 721)

ALL = (Cuboid, Cylinder, Sphere)


def clutter(random, count, shapes=ALL):
    """Solids of any size near and far; one in three stands upright."""
    parts = []
    for number in range(count):
        a, b, c = random.uniform(0.1, 1.5, 3).tolist()
        shape = {Cuboid: Cuboid((a, b, 2 * c)), Cylinder: Cylinder(a / 2, b), Sphere: Sphere(a / 2)}
        x, y, z = random.uniform((-9, -9, 0), (9, 9, 2)).tolist()
        turned = from_euler(*random.uniform(-1, 1, 3).tolist())
        kind = shapes[number % len(shapes)]
        parts.append(Part(shape[kind], (x, y, z), turned if number % 4 else LEVEL))
    return parts


def rays(angles, rotation):
    """Directions in the world."""
    return np.stack((np.cos(angles), np.sin(angles), 0 * angles), axis=1) @ matrix(rotation).T


def check(angles, eye, tilt, *groups):
    """Compare a scan with single rays; return it."""
    standing = [(solids, *pose) for solids, *pose in groups]
    distances = Scanner(angles, LONGEST).scan(eye, tilt, standing)
    world = joined(solids_of([], (0, 0, 0)), *(solids.placed(*pose) for solids, *pose in groups))
    expected = cast(world, eye, rays(angles, tilt), LONGEST)
    np.testing.assert_allclose(distances, expected, rtol=0, atol=1e-9)
    return distances


@pytest.mark.parametrize("tilt", [0.0, 1e-7, 0.3, 3.0])
@pytest.mark.parametrize("seed", range(10))
def test_it_agrees_with_single_rays(seed, tilt):
    random = np.random.default_rng(seed)
    fixed, body = solids_of(clutter(random, 24)), solids_of(clutter(random, 5))
    pose = (1.0, -2.0, 0.3), from_euler(0.1, 0.2, 2.0)
    turned = from_euler(*random.uniform(-tilt, tilt, 2).tolist(), float(random.uniform(-3, 3)))
    distances = check(CIRCLE, EYE, turned, (fixed, *HERE), (body, *pose))
    assert np.isfinite(distances).mean() > 0.1


@pytest.mark.parametrize("shape", ALL)
@pytest.mark.parametrize("seed", range(5))
def test_it_agrees_in_a_crowd_where_the_eye_is_inside_of_some(seed, shape):
    random = np.random.default_rng(seed)
    crowd = solids_of(clutter(random, 300, (shape,)))
    eye = tuple(crowd.centres[seed] + crowd.half_sizes[seed] * random.uniform(-0.5, 0.5, 3))
    distances = check(CIRCLE, eye, from_euler(0.1, 0.0, 1.0), (crowd, *HERE))
    assert np.isfinite(distances).mean() > 0.3


@pytest.mark.parametrize("shape", ALL)
def test_it_agrees_where_the_eye_is_above_below_and_beside_a_solid(shape):
    """As the plane meets it: only the top, only a side, both, through the eye's own column."""
    random = np.random.default_rng(0)
    solid = {Cuboid: Cuboid((1, 2, 0.6)), Cylinder: Cylinder(0.7, 0.6), Sphere: Sphere(0.6)}[shape]
    group = solids_of([Part(solid, (0.0, 0.0, 1.0), from_euler(0.2, 0.1, 0.0))])
    hits = 0
    for eye in random.uniform((-2, -2, 0), (2, 2, 3), (200, 3)).tolist():
        tilt = from_euler(*random.uniform(-3, 3, 3).tolist())
        hits += int(np.isfinite(check(CIRCLE, eye, tilt, (group, *HERE))).sum())
    assert hits > 1000


@pytest.mark.parametrize(
    ("first", "last", "count"),
    [
        (-1.0, 1.0, 2),
        (-2 * math.pi, 2 * math.pi, 1441),
        (2 * math.pi, 0.5, 500),
        (3.0, 6.0, 20_000),
        (0.7, 0.7, 3),
        (-6.2, -0.1, 777),
    ],
)
def test_it_agrees_for_any_fan_of_rays(first, last, count):
    random = np.random.default_rng(1)
    world = solids_of(clutter(random, 40))
    distances = check(np.linspace(first, last, count), EYE, LEVEL, (world, *HERE))
    assert count < 5 or 0 < np.isfinite(distances).mean() < 1


def test_a_scanner_sees_what_moves_comes_and_goes():
    random, scanner = np.random.default_rng(2), Scanner(CIRCLE, LONGEST)
    body, other = (solids_of(clutter(random, 6)) for _ in range(2))
    groups = body, other
    for number in range(20):
        pose = tuple(random.uniform(-8, 8, 3).tolist()), from_euler(0, 0.1, 0.3 * number)
        shown = (number % 3 > 0, number % 4 > 0)
        standing = [
            (group, *pose) for group, is_shown in zip(groups, shown, strict=True) if is_shown
        ]
        solids = [
            s.placed(*pose) for s, is_shown in zip((body, other), shown, strict=True) if is_shown
        ]
        distances = scanner.scan(EYE, LEVEL, standing)
        expected = cast(joined(solids_of([]), *solids), EYE, rays(CIRCLE, LEVEL), LONGEST)
        np.testing.assert_allclose(distances, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("angles", [CIRCLE, np.linspace(2.0, -2.0, 300)])
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_many_scanners_together_see_to_the_bit_what_each_alone_sees(angles, tilt):
    random, scanner = np.random.default_rng(3), Scanner(angles, LONGEST)
    bodies = [(solids_of(clutter(random, 24)), *HERE)]
    for number in range(40):
        position = tuple(random.uniform(-20, 20, 3).tolist())
        turn = from_euler(*random.uniform(-3, 3, 3).tolist())
        bodies.append((solids_of(clutter(random, number % 4)), position, turn))
    bodies.append((solids_of(clutter(random, 2)), (math.nan, 0.0, 0.0), LEVEL))
    bodies.append((solids_of(clutter(random, 2)), (math.inf, 0.0, 0.0), LEVEL))
    eyes = random.uniform((-9, -9, 0), (9, 9, 1), (37, 3))
    turns = [from_euler(*random.uniform(-tilt, tilt, 2), yaw) for yaw in range(37)]
    own = np.arange(37) % len(bodies)
    ranges = scanner.scan_batch(eyes.T, np.array(turns).T, bodies, own)
    assert np.isfinite(ranges).mean() > 0.1
    for one, eye, turn, body in zip(ranges, eyes.tolist(), turns, own, strict=True):
        others = [*bodies[:body], *bodies[body + 1 :]]
        np.testing.assert_array_equal(one, scanner.scan(tuple(eye), turn, others))


def look(*parts, eye=(0.0, 0.0, 0.5)):
    return Scanner(CIRCLE, LONGEST).scan(eye, LEVEL, [(solids_of(parts), *HERE)])


def test_nothing_is_infinitely_far():
    assert np.isposinf(look()).all()
    assert np.isposinf(Scanner(CIRCLE, LONGEST).scan(EYE, LEVEL, [])).all()


def test_a_body_that_the_engine_has_lost_is_not_seen():
    lost = (math.nan, 0.0, 0.0), LEVEL
    group = solids_of([Part(Cuboid((1.0, 1.0, 1.0)))])
    assert np.isposinf(Scanner(CIRCLE, LONGEST).scan(EYE, LEVEL, [(group, *lost)])).all()


def test_a_solid_around_the_eye_is_not_seen_and_what_is_behind_it_is():
    wall = Part(Cuboid((0.2, 40.0, 2.0)), (4.1, 0.0, 1.0))
    for shape in (Cuboid((0.4, 0.4, 0.4)), Cylinder(0.2, 0.4), Sphere(0.2)):
        distances = look(Part(shape, (0.0, 0.0, 0.5)), wall)
        assert distances[360] == pytest.approx(4.0)
        assert np.isposinf(distances[0])


@pytest.mark.parametrize("shape", [Cuboid((1.0, 1.0, 1.0)), Cylinder(0.5, 1.0), Sphere(0.5)])
@pytest.mark.parametrize("gap", [0.0, 1e-10, -1e-10])
def test_an_eye_that_touches_a_side_is_inside_it(shape, gap):
    assert np.isposinf(look(Part(shape, (0.5 + gap, 0.0, 0.5)))).all()


def test_an_eye_in_the_plane_of_a_side_looks_along_it():
    row = [Part(Cuboid((1.0, 2.0, 1.0)), (x, 1.0, 0.5)) for x in (0.0, 3.0)]
    assert look(*row)[361] == pytest.approx(2.5, abs=1e-3)


def test_no_ray_slips_through_where_two_boxes_meet():
    """The seam between each two lies exactly in a ray, as does each edge of a box."""
    for size in (0.25, 0.5, 1.0):
        wall = [Part(Cuboid((2.0, size, 1.0)), (5.0, y * size, 0.5)) for y in range(-20, 21)]
        seams = np.sort(np.arctan2((np.arange(-19, 19) + 0.5) * size, 4.0))
        group = solids_of(wall)
        distances = Scanner(seams, LONGEST * 10).scan((0.0, 0.0, 0.5), LEVEL, [(group, *HERE)])
        assert distances == pytest.approx(4 / np.cos(seams), abs=1e-9)


def test_the_edge_of_a_box_towards_the_eye_is_seen():
    for yaw in np.linspace(0.1, 1.4, 27).tolist():
        box = Part(Cuboid((1.0, 1.0, 1.0)), (4.0, 0.0, 0.5), from_euler(0, 0, yaw))
        corner = matrix(from_euler(0, 0, yaw)) @ (-0.5, 0.5, 0.0) + (4.0, 0.0, 0.0)
        angles = np.arctan2(corner[1], corner[0]) + np.array((0.0, 1.0))
        distances = Scanner(angles, LONGEST).scan(
            (0.0, 0.0, 0.5), LEVEL, [(solids_of([box]), *HERE)]
        )
        assert distances[0] == pytest.approx(math.hypot(*corner[:2]), abs=1e-9)


def test_what_is_above_or_below_the_scans_plane_is_not_hit():
    low = Part(Cuboid((0.2, 4.0, 0.4)), (2.0, 0.0, 0.2))
    high = Part(Cylinder(0.5, 0.4), (3.0, 0.0, 0.8))
    assert np.isposinf(look(low, high)).all()


def test_the_longest_distance_counts():
    walls = [Part(Cuboid((0.2, 0.4, 1.0)), (x, 0.0, 0.5)) for x in (10.05, -10.15)]
    distances = look(*walls)
    assert distances[360] == pytest.approx(9.95)
    assert np.isposinf(distances[0])


def test_the_ground_is_hit_by_rays_that_point_down():
    distances = Scanner(CIRCLE, LONGEST).scan((0.0, 0.0, 0.5), from_euler(0.0, 0.1, 0.0), [])
    assert distances[360] == pytest.approx(0.5 / math.sin(0.1))
    assert np.isposinf(distances[0])
