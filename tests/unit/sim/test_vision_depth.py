"""Depth pictures against what geometry says, and against rays cast one by one."""

import math

import numpy as np
import pytest
from fixtures.plain_rays import cast, project, rays_of
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.vision.camera import Camera, optical, pixel_bounds
from lcmtools_sim.vision.render import GROUND, SKY, render
from lcmtools_sim.vision.solids import joined, matrix, solids_of

CAMERA = Camera(161, 121, math.radians(57))  # odd, so that a pixel looks along the axis
MIDDLE = (60, 80)  # its row and column
AHEAD = optical((0.0, 0.0, 0.0, 1.0))  # along the world's x axis
EYE = (0.0, 0.0, 0.3)
GREY = (0.5, 0.5, 0.5)
MILLIMETRE = 1e-3
FAR = 8.0  # [m]


def depth_of(*parts, eye=EYE, rotation=AHEAD):
    return render(solids_of(parts), CAMERA, eye, rotation).depth


def truth(solids, camera, eye, rotation):
    """The depth by float64 rays, one a pixel."""
    rays = rays_of(camera).reshape(-1, 3)
    distances = cast(solids, eye, rays @ matrix(rotation).T)
    return (distances / np.linalg.norm(rays, axis=1)).reshape(camera.height, camera.width)


def test_a_flat_wall_has_the_same_depth_in_every_pixel():
    depth = depth_of(Part(Cuboid((0.2, 50, 50)), (3.1, 0, 0)))
    assert depth.dtype == np.float32
    assert depth.shape == (121, 161)
    np.testing.assert_allclose(depth, 3.0, atol=1e-6)


@pytest.mark.parametrize("angle", [-1.0, -0.4, 0.3, 0.7])
def test_an_oblique_wall_is_a_plane(angle):
    # The face's plane: n.p = s with n = (cos, sin) of the angle and s = 2 cos(angle).
    normal = np.array((math.cos(angle), math.sin(angle)))
    centre = normal * (2 * normal[0] + 0.5)
    wall = Part(Cuboid((1, 90, 90)), (*centre, 0.0), from_euler(0, 0, angle))
    x, _ = CAMERA.slopes()
    forward = normal[0] - x * normal[1]  # n.ray, the column's ray being (1, -x)
    expected = np.broadcast_to(2 * normal[0] / forward, (121, 161))
    depth = depth_of(wall)
    assert depth[MIDDLE] == pytest.approx(2.0, abs=1e-6)
    np.testing.assert_allclose(depth[expected < 8], expected[expected < 8], atol=1e-5)


def test_the_floor_of_a_level_camera_is_its_height_by_the_slope_of_the_row():
    depth = render(solids_of([], GREY), CAMERA, EYE, AHEAD).depth
    rows = np.arange(61, 121)
    expected = 0.3 * CAMERA.focal_length / (rows - 60)
    np.testing.assert_allclose(depth[61:], np.tile(expected[:, None], 161), rtol=1e-6)
    assert np.isinf(depth[:61]).all()


def test_the_floor_is_not_seen_from_below():
    depth = render(solids_of([], GREY), CAMERA, (0, 0, -1), optical(from_euler(0, -0.5, 0))).depth
    assert np.isinf(depth).all()


def test_a_box_covers_the_pixels_between_its_projected_corners():
    box = Part(Cuboid((1, 0.8, 0.4)), (2.5, 0.3, 0.3))
    left, right = project(CAMERA, [(-0.7, 0, 2), (0.1, 0, 2)])[:, 0]
    top, bottom = project(CAMERA, [(0, -0.2, 2), (0, 0.2, 2)])[:, 1]
    rows, columns = np.nonzero(np.isfinite(depth_of(box)))
    assert columns.min() == math.ceil(left)
    assert columns.max() == math.floor(right)
    assert rows.min() == math.ceil(top)
    assert rows.max() == math.floor(bottom)


def test_the_middle_of_a_ball_is_nearest():
    depth = depth_of(Part(Sphere(0.5), (3, 0, 0.3)))
    assert depth[MIDDLE] == pytest.approx(2.5, abs=1e-6)
    assert depth.min() == depth[MIDDLE]
    silhouette = math.tan(math.asin(0.5 / 3)) * CAMERA.focal_length
    assert np.isfinite(depth[60]).sum() == 2 * math.floor(silhouette) + 1


def test_the_side_of_a_standing_cylinder_is_the_same_in_every_row():
    depth = depth_of(Part(Cylinder(0.5, 40), (3, 0, 0.3)))
    np.testing.assert_allclose(depth[:, 80], 2.5, atol=1e-6)
    assert (depth == depth[60]).all()


def test_the_cap_of_a_lying_cylinder_is_flat_and_round():
    depth = depth_of(Part(Cylinder(0.5, 1), (3, 0, 0.3), from_euler(0, math.pi / 2, 0)))
    radius = 0.5 / 2.5 * CAMERA.focal_length
    row, column = np.mgrid[:121, :161]
    from_axis = np.hypot(row - 60, column - 80)
    np.testing.assert_allclose(depth[from_axis < radius - 0.01], 2.5, atol=1e-6)
    assert np.isinf(depth[from_axis > radius + 0.01]).all()


@pytest.mark.parametrize("shape", [Cuboid((1, 1, 1)), Cylinder(0.5, 1), Sphere(0.5)])
def test_a_solid_is_not_seen_from_within(shape):
    wall = Part(Cuboid((0.2, 50, 50)), (3.1, 0, 0))
    np.testing.assert_allclose(depth_of(Part(shape, EYE), wall), 3.0, atol=1e-6)


@pytest.mark.parametrize("shape", [Cuboid((1, 1, 1)), Cylinder(0.5, 1), Sphere(0.5)])
def test_a_solid_behind_is_not_seen(shape):
    assert np.isinf(depth_of(Part(shape, (-2, 0, 0.3)))).all()


def test_a_wall_beside_that_reaches_behind_is_seen_to_where_it_ends():
    # Its face is 1 m to the left; the column's ray (1, -x) meets it at depth -1 / x.
    depth = depth_of(Part(Cuboid((20, 0.2, 50)), (0, 1.1, 0)))
    x, _ = CAMERA.slopes()
    expected = np.where(x < -0.1, -1 / np.where(x == 0, 1, x), np.inf)
    np.testing.assert_allclose(depth, np.tile(expected, (121, 1)), rtol=1e-6)


def test_the_nearest_solid_covers_the_others_in_any_order():
    parts = [Part(Cuboid((0.2, 9, 9)), (4, 0, 0)), Part(Sphere(0.3), (2, 0, 0.3))]
    for order, ball in ((parts, 1), (parts[::-1], 0)):
        sight = render(solids_of(order, GREY), CAMERA, EYE, AHEAD)
        assert sight.solid[MIDDLE] == ball
        assert sight.solid[0, 0] == 1 - ball
        assert sight.depth[MIDDLE] == pytest.approx(1.7, abs=1e-6)
    assert render(solids_of([], GREY), CAMERA, EYE, AHEAD).solid[0, 0] == SKY
    assert render(solids_of([], GREY), CAMERA, EYE, AHEAD).solid[-1, 0] == GROUND


def test_a_group_that_is_placed_is_seen_where_it_is():
    walls = solids_of([Part(Cuboid((0.2, 9, 9)), (6, 0, 0))], GREY)
    robot = solids_of([Part(Cylinder(0.2, 0.4), (0.3, 0, 0.1), from_euler(0.2, 0, 0))])
    rotation = from_euler(0.1, 0.2, 2.0)
    turn = matrix(rotation)
    world = joined(walls, robot.placed((3, 0.2, 0.3), rotation))
    assert len(world) == 2
    assert world.ground == GREY
    np.testing.assert_allclose(world.centres[1], turn @ (0.3, 0, 0.1) + (3, 0.2, 0.3))
    np.testing.assert_allclose(world.axes[1], turn @ matrix(from_euler(0.2, 0, 0)), atol=1e-12)
    back = world.seen_from((3, 0.2, 0.3), rotation)
    np.testing.assert_allclose(back.centres[1], (0.3, 0, 0.1), atol=1e-12)


def test_an_empty_world_is_all_sky():
    sight = render(solids_of([]), CAMERA, EYE, AHEAD)
    assert np.isinf(sight.depth).all()
    assert (sight.solid == SKY).all()


@pytest.mark.parametrize("lost", [math.nan, math.inf, 1e300])
@pytest.mark.parametrize("shape", [Cuboid((1, 1, 1)), Cylinder(0.5, 1), Sphere(0.5)])
def test_a_body_that_is_lost_is_not_seen_and_hides_nothing(shape, lost):
    wall = Part(Cuboid((0.2, 50, 50)), (3.1, 0, 0))
    np.testing.assert_allclose(depth_of(Part(shape, (lost, 0, 0)), wall), 3.0, atol=1e-6)


# Cameras and solids anywhere: turned, inside, crossing the image plane, below the ground.

coordinates = st.integers(-300, 300).map(lambda centimetres: centimetres / 100)
angles = st.floats(-math.pi, math.pi)
positions = st.tuples(coordinates, coordinates, coordinates)
rotations = st.builds(from_euler, angles, angles, angles)
sizes = st.integers(1, 40).map(lambda steps: steps / 20)
shapes = st.one_of(
    st.builds(Cuboid, st.tuples(sizes, sizes, sizes)),
    st.builds(Cylinder, sizes, sizes),
    st.builds(Sphere, sizes),
)
worlds = st.lists(st.builds(Part, shapes, positions, rotations), max_size=6)
SMALL = Camera(48, 36, 1.2)


@settings(max_examples=60, deadline=None)
@given(worlds, positions, rotations)
def test_any_picture_is_what_rays_cast_one_by_one_see(parts, eye, rotation):
    solids = solids_of(parts, GREY)
    depth = render(solids, SMALL, eye, rotation).depth
    alone = render(solids, SMALL, eye, rotation, only_depth=True).depth
    np.testing.assert_array_equal(alone, depth)
    expected = truth(solids, SMALL, eye, rotation)
    # At the very edge of a solid a ray that touches it may go either way.
    is_near = (depth <= FAR) | (expected <= FAR)
    assert (~np.isclose(depth, expected, rtol=0, atol=MILLIMETRE))[is_near].sum() <= 5


@settings(max_examples=60, deadline=None)
@given(worlds, positions, rotations)
def test_an_outline_holds_every_pixel_of_its_solid(parts, eye, rotation):
    found = {}
    for outline in pixel_bounds(solids_of(parts).seen_from(eye, rotation), SMALL):
        found[outline.number] = outline
    for number, part in enumerate(parts):
        rows, columns = np.nonzero(np.isfinite(truth(solids_of([part]), SMALL, eye, rotation)))
        if len(rows):
            outline = found[number]
            assert outline.top <= rows.min()
            assert rows.max() < outline.bottom
            assert outline.left <= columns.min()
            assert columns.max() < outline.right


def test_float32_is_good_to_a_hundredth_of_a_millimetre_within_8_metres():
    random = np.random.default_rng(4)
    errors = []
    for _ in range(6):
        shapes = [Cuboid((0.6, 0.9, 0.4)), Cylinder(0.3, 0.9), Sphere(0.4)] * 4
        places = random.uniform((1, -3, 0), (8, 3, 1.5), (12, 3))
        turns = random.uniform(-3, 3, (12, 3))
        solids = solids_of(
            [
                Part(shape, tuple(place), from_euler(*turn))
                for shape, place, turn in zip(shapes, places, turns, strict=True)
            ],
            GREY,
        )
        depth = render(solids, CAMERA, EYE, AHEAD).depth
        expected = truth(solids, CAMERA, EYE, AHEAD)
        both = (depth <= FAR) & (expected <= FAR)
        errors.append(np.abs(depth[both] - expected[both]))
        assert ((depth <= FAR) != (expected <= FAR)).mean() < 2e-4  # edges
    error = np.sort(np.concatenate(errors))
    assert np.median(error) < 1e-6
    assert error[int(0.999 * len(error))] < 1e-5
    assert error[int(0.9999 * len(error))] < MILLIMETRE
