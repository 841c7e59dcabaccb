"""A depth camera on a robot, from the world to its messages: to the millimetre, pixel by pixel."""

import math
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from lcmtools.types.sensor_msgs import CameraInfo, PointCloud2
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.dolly import DOLLY
from lcmtools_sim.robots.pioneer import PIONEER
from lcmtools_sim.scene import RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.shapes import Cuboid, Part

EYE_X, EYE_Z = 0.10, 0.0975 + 0.25
"""[m] Where the Kinect is on a Pioneer at the origin."""
MILLIMETRE = 1e-3


@pytest.fixture
def place(simulate):
    """Makes a simulation of a Pioneer with its Kinect, before some things."""

    def make(*things, pose=Pose(), namespace="/"):  # noqa: B008 - a value
        robots = (RobotPlacement(PIONEER, namespace, pose),)
        return simulate(scene=Scene("depth", objects=things, robots=robots))

    return make


def look(simulation, prefix=""):
    """The next messages of the camera, by their names behind /camera/."""
    start = f"{prefix}/camera/"
    while True:
        found = {s.topic: s.message for s in simulation.step() if s.topic.startswith(start)}
        if found:
            return {topic.removeprefix(start): message for topic, message in found.items()}


def metres(messages):
    message = messages["depth/image"]
    assert message.encoding == "32FC1"
    return np.frombuffer(message.data, "<f4").reshape(message.height, message.width)


def millimetres(messages):
    message = messages["depth/image_raw"]
    assert message.encoding == "16UC1"
    return np.frombuffer(message.data, "<u2").reshape(message.height, message.width)


def cloud(messages):
    message = messages["depth/points"]
    assert isinstance(message, PointCloud2)
    return np.frombuffer(message.data, "<f4").reshape(message.height, message.width, -1)


def row_of(height, depth):
    """The row in which something at this height above the ground appears [m]."""
    return round(239.5 + 589.37 * (EYE_Z - height) / depth)


def wall(distance, yaw=0.0):
    """A wall whose face crosses the optical axis so far from the eye, turned about that point."""
    x, y = 0.1 * math.cos(yaw), 0.1 * math.sin(yaw)
    return box("wall", (0.2, 40, 8), Pose(EYE_X + distance + x, y, 4.0, yaw=yaw))


@pytest.mark.parametrize("distance", [0.6, 2.0, 7.5])
def test_a_flat_wall_has_its_depth_in_every_pixel_that_does_not_see_the_floor(place, distance):
    depth = metres(look(place(wall(distance))))
    rows = np.arange(480) < 239.5 + 589.37 * EYE_Z / distance - 1
    assert depth.shape == (480, 640)
    assert np.abs(depth[rows] - distance).max() < MILLIMETRE


@pytest.mark.parametrize("yaw", [0.5, -0.9])
def test_an_oblique_wall_has_the_depth_of_its_plane_in_every_column(place, yaw):
    depth = metres(look(place(wall(3.0, yaw))))
    # In the optical frame the wall is cos(yaw) z - sin(yaw) x = 3 cos(yaw), x = z (i - cx) / f.
    focal = 320 / math.tan(math.radians(28.5))
    slope = (np.arange(640) - 319.5) / focal
    expected = 3.0 * math.cos(yaw) / (math.cos(yaw) - math.sin(yaw) * slope)
    seen = expected < 8.0
    assert seen.sum() > 400
    assert np.abs(depth[:200][:, seen] - expected[seen]).max() < MILLIMETRE
    assert np.isnan(depth[0][~seen]).all()


def test_the_floors_rows_have_the_depth_that_the_eyes_height_gives(place):
    messages = look(place())
    depth, info = metres(messages), messages["depth/camera_info"]
    assert isinstance(info, CameraInfo)
    rows = np.arange(480)
    with np.errstate(divide="ignore"):
        expected = EYE_Z * info.K[4] / (rows - info.K[5])
    seen = (expected >= 0.5) & (expected <= 8.0)
    assert seen.sum() > 150
    # A row is the more metres the farther it is; the robot stands 10 um in the ground.
    allowed = np.maximum(MILLIMETRE, expected[seen, None] * 2e-4)
    assert (np.abs(depth[seen] - expected[seen, None]) < allowed).all()
    assert np.isnan(depth[:240]).all()


def test_corners_of_a_box_are_in_the_pixels_where_the_camera_info_projects_them(place):
    size, centre = (0.6, 0.8, 0.5), (2.4, 0.3, 0.6)
    messages = look(place(box("box", size, Pose(*centre))))
    depth, info = metres(messages), messages["depth/camera_info"]
    face = centre[0] - size[0] / 2
    above_floor = depth[:300]
    rows, columns = np.nonzero(np.abs(above_floor - (face - EYE_X)) < 0.005)

    def project(y, z):
        forward = face - EYE_X
        x, y_down = -y / forward, (EYE_Z - z) / forward
        return info.P[0] * x + info.P[2], info.P[5] * y_down + info.P[6]

    left, top = project(centre[1] + size[1] / 2, centre[2] + size[2] / 2)
    right, bottom = project(centre[1] - size[1] / 2, centre[2] - size[2] / 2)
    assert (columns.min(), columns.max()) == (math.ceil(left), math.floor(right))
    assert (rows.min(), rows.max()) == (math.ceil(top), math.floor(bottom))


def test_the_camera_info_is_that_of_a_kinect_and_says_so_for_both_pictures(place):
    messages = look(place())
    info = messages["depth/camera_info"]
    focal = 320 / math.tan(math.radians(57) / 2)
    assert (info.width, info.height) == (640, 480)
    assert list(info.K) == pytest.approx([focal, 0, 319.5, 0, focal, 239.5, 0, 0, 1])
    assert list(info.P) == pytest.approx([focal, 0, 319.5, 0, 0, focal, 239.5, 0, 0, 0, 1, 0])
    assert list(info.R) == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert (info.distortion_model, list(info.D)) == ("plumb_bob", [0] * 5)
    assert messages["rgb/camera_info"].K == info.K


def test_all_forms_of_the_depth_are_one_picture(place):
    post = box("box", (0.5, 0.5, 0.5), Pose(1.5, 0.2, 0.25))
    messages = look(place(wall(3.0, 0.4), post))
    depth, points = metres(messages), cloud(messages)
    whole = millimetres(messages)
    assert np.array_equal(whole, np.nan_to_num(np.rint(depth * 1000)).astype("<u2"))
    packed = messages["depth/image_raw/compressed"]
    assert packed.format == "png"
    assert np.array_equal(np.asarray(Image.open(BytesIO(packed.data))), whole)
    assert np.array_equal(points[:, :, 2], depth, equal_nan=True)
    info = messages["depth/camera_info"]
    i, j = np.meshgrid(np.arange(640), np.arange(480))
    x, y = (i - info.K[2]) / info.K[0] * depth, (j - info.K[5]) / info.K[4] * depth
    assert np.nanmax(np.abs(points[:, :, 0] - x)) < 1e-5
    assert np.nanmax(np.abs(points[:, :, 1] - y)) < 1e-5


def test_colour_is_registered_with_depth_and_in_the_points(place):
    red = SceneObject(
        "red", (Part(Cuboid((0.4, 0.6, 0.5)), color=(1.0, 0.0, 0.0)),), Pose(2, 0.2, 0.6)
    )
    messages = look(place(red))
    image = messages["rgb/image_raw"]
    color = np.frombuffer(image.data, np.uint8).reshape(480, 640, 3)
    depth, points = metres(messages), cloud(messages)
    assert image.encoding == "rgb8"
    is_red = (color[:, :, 0] > 60) & (color[:, :, 1] < 30) & (color[:, :, 2] < 30)
    is_box = (np.abs(depth - 1.7) < 0.001) & (np.arange(480)[:, None] < 300)  # not the floor
    assert is_box.sum() > 5000
    assert (is_red & is_box).sum() == is_box.sum()
    packed = points[:, :, 3].copy().view("<u4")
    whole = color.astype(np.uint32)
    assert np.array_equal(packed, whole[:, :, 0] << 16 | whole[:, :, 1] << 8 | whole[:, :, 2])
    png = np.asarray(Image.open(BytesIO(messages["rgb/image_raw/compressed"].data)))
    assert np.array_equal(png, color)


@pytest.mark.parametrize(
    ("distance", "is_seen"), [(0.45, False), (0.51, True), (7.99, True), (8.1, False)]
)
def test_what_is_out_of_range_is_no_reading(place, distance, *, is_seen):
    messages = look(place(wall(distance)))
    middle = metres(messages)[100, 320], millimetres(messages)[100, 320], cloud(messages)[100, 320]
    if is_seen:
        assert middle[0] == pytest.approx(distance, abs=MILLIMETRE)
        assert middle[1] == pytest.approx(distance * 1000, abs=1)
    else:
        assert np.isnan(middle[0])
        assert middle[1] == 0
        assert np.isnan(middle[2][:3]).all()


@pytest.mark.parametrize(("namespace", "prefix"), [("/", ""), ("/p3dx", "p3dx/")])
def test_all_its_messages_have_one_stamp_and_its_optical_frame(place, namespace, prefix):
    simulation = place(namespace=namespace)
    messages = look(simulation, namespace.rstrip("/"))
    assert len(messages) == 8
    headers = [message.header for message in messages.values()]
    assert {header.frame_id for header in headers} == {f"{prefix}camera_depth_optical_frame"}
    stamps = {(header.stamp.sec, header.stamp.nsec) for header in headers}
    assert stamps == {divmod(simulation.time, 10**9)}


def test_it_moves_with_the_robot(place, twist):
    simulation = place(wall(6.0))
    simulation.robots[0].command(twist(1.0, 0.0))
    simulation.select(lambda _: Subscribers.NONE)
    for _ in range(960):
        simulation.step()
    simulation.select(lambda _: Subscribers.KNOWN)
    depth = metres(look(simulation))
    driven = simulation.robots[0].state(0).position[0]
    assert driven > 2
    assert np.abs(depth[100] - (6.0 - driven)).max() < MILLIMETRE


def test_a_turn_of_the_robot_turns_what_it_sees(place):
    depth = metres(look(place(wall(3.0), pose=Pose(yaw=math.pi))))
    assert np.isnan(depth[:200]).all()


def test_it_sees_another_robot_and_a_box_that_was_moved(simulate):
    crate = box("crate", (0.4, 0.4, 0.6), Pose(3.0, -0.8, 0.3), mass=5)
    robots = (
        RobotPlacement(PIONEER, "/a"),
        RobotPlacement(DOLLY, "/b", Pose(3.0, 0.5)),
    )
    simulation = simulate(scene=Scene("two", objects=(crate,), robots=robots))
    before = metres(look(simulation, "/a"))
    # Dolly's chassis begins 0.8 m behind its axle.
    assert np.nanmin(before[row_of(0.225, 2.1), 100:320]) == pytest.approx(
        3.0 - 0.8 - EYE_X, abs=MILLIMETRE
    )
    assert np.nanmin(before[row_of(0.5, 2.7), 330:]) == pytest.approx(
        2.8 - EYE_X, abs=2 * MILLIMETRE
    )
    simulation.robots[1].place(Pose(5.0, 0.5))
    after = metres(look(simulation, "/a"))
    assert np.nanmin(after[row_of(0.225, 4.1), 200:320]) == pytest.approx(4.1, abs=0.002)


def test_the_robots_own_body_is_not_in_its_pictures(simulate):
    low = replace(PIONEER.sensors[3], pose=Pose(0.0, 0.0, 0.05))
    assert low.kind == "depth_camera"
    robots = (RobotPlacement(replace(PIONEER, sensors=(low,)), "/"),)
    things = (wall(2.0 - EYE_X),)
    depth = metres(look(simulate(scene=Scene("low", objects=things, robots=robots))))
    assert np.abs(depth[:230] - 2.0).max() < MILLIMETRE
