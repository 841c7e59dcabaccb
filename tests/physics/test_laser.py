"""A laser measures known distances to walls and things. Metres and radians."""

import math
from dataclasses import replace

import numpy as np
import pytest

from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots.dolly import DOLLY
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import Cylinder, Part

LASER_X = 0.2  # of Dolly's laser in base_link
TOLERANCE = 0.002


def scan(simulation, topic="/dolly/laser_scan"):
    """The next scan."""
    while True:
        for sample in simulation.step():
            if sample.topic == topic:
                assert isinstance(sample.message, LaserScan)
                return sample.message


def angles(message):
    return message.angle_min + np.arange(len(message.ranges)) * message.angle_increment


@pytest.fixture
def world(simulate):
    """Makes a simulation with one Dolly and some things."""

    def make(*things, pose=Pose(), model=DOLLY):  # noqa: B008 - a value
        robots = (RobotPlacement(model, "/dolly", pose),)
        return simulate(scene=Scene("laser", objects=things, robots=robots))

    return make


def test_the_scan_says_what_dollys_laser_is(world):
    message = scan(world())
    assert len(message.ranges) == 200
    assert (message.angle_min, message.angle_max) == (-1.0, 1.0)
    assert message.angle_increment == pytest.approx(2 / 199)
    assert (message.range_min, message.range_max) == pytest.approx((0.05, 10.0))
    assert message.scan_time == pytest.approx(0.01)
    assert message.time_increment == 0
    assert message.header.frame_id == "dolly/laser"


def test_nothing_in_range_is_infinitely_far(world):
    assert set(scan(world()).ranges) == {math.inf}


@pytest.mark.parametrize("yaw", [0.0, 0.3, -0.7])
def test_a_flat_wall_is_at_its_distance_along_every_ray(world, yaw):
    wall = box("wall", (0.2, 40, 2), Pose(4.1, 0, 1))
    message = scan(world(wall, pose=Pose(0, 0, 0, yaw=yaw)))
    eye = LASER_X * math.cos(yaw)
    heading = angles(message) + yaw
    expected = (4.0 - eye) / np.cos(heading)
    seen = (np.cos(heading) > 0) & (expected <= 10.0)
    ranges = np.array(message.ranges)
    assert ranges[seen] == pytest.approx(expected[seen], abs=TOLERANCE)
    assert np.isposinf(ranges[~seen]).all()


def test_a_post_is_seen_as_a_circle(world):
    post = SceneObject("post", (Part(Cylinder(0.3, 2.0)),), Pose(3.2, 0.5, 1.0))
    message = scan(world(post))
    heading, ranges = angles(message), np.array(message.ranges)
    hit = np.isfinite(ranges)
    x, y = LASER_X + ranges * np.cos(heading), ranges * np.sin(heading)
    distance = np.hypot(x[hit] - 3.2, y[hit] - 0.5)
    assert distance == pytest.approx(0.3, abs=0.005)
    width = 2 * math.asin(0.3 / math.hypot(3.0, 0.5))
    assert hit.sum() == pytest.approx(width / message.angle_increment, abs=1)


def test_what_is_too_near_is_minus_infinity_and_the_limits_count(world):
    laser = SensorMount(
        "laser", "laser_scan", 100.0, Pose(LASER_X), settings=LaserSettings(3, -0.1, 0.1, 2.0, 4.0)
    )
    model = replace(DOLLY, sensors=(laser,))

    def middle(distance):
        wall = box("wall", (0.2, 40, 2), Pose(LASER_X + distance + 0.1, 0, 1))
        return float(scan(world(wall, model=model)).ranges[1])

    assert middle(1.9) == -math.inf
    assert middle(2.1) == pytest.approx(2.1, abs=TOLERANCE)
    assert middle(3.9) == pytest.approx(3.9, abs=TOLERANCE)
    assert middle(4.1) == math.inf


def test_noise_has_the_deviation_that_is_asked_for_and_repeats_with_the_seed(world):
    laser = replace(DOLLY.sensors[1], settings=LaserSettings(1000, -0.5, 0.5, 0.05, 10, noise=0.03))
    model = replace(DOLLY, sensors=(laser,))
    wall = box("wall", (0.2, 40, 2), Pose(4.1, 0, 1))
    first, again = (scan(world(wall, model=model)) for _ in range(2))
    error = np.array(first.ranges) - (4.0 - LASER_X) / np.cos(angles(first))
    assert error.std() == pytest.approx(0.03, rel=0.1)
    assert abs(error.mean()) < 0.004
    assert first.ranges == again.ranges


def test_two_lasers_have_noise_of_their_own(simulate):
    laser = replace(DOLLY.sensors[1], settings=LaserSettings(100, -0.5, 0.5, 0.05, 10, noise=0.03))
    model = replace(DOLLY, sensors=(laser,))
    wall = box("wall", (0.2, 90, 2), Pose(4.1, 0, 1))
    robots = (RobotPlacement(model, "/a"), RobotPlacement(model, "/b", Pose(0, 20)))
    simulation = simulate(scene=Scene("two", objects=(wall,), robots=robots))
    assert scan(simulation, "/a/laser_scan").ranges != scan(simulation, "/b/laser_scan").ranges


def test_a_laser_within_the_robots_body_sees_through_it_and_not_other_robots(simulate):
    laser = SensorMount(
        "laser", "scan", 10.0, Pose(0, 0, 0.1), settings=LaserSettings(361, -math.pi, math.pi)
    )
    husky = replace(HUSKY, sensors=(laser,))
    robots = (RobotPlacement(husky, "/a"), RobotPlacement(husky, "/b", Pose(3, 0)))
    simulation = simulate(scene=Scene("two", robots=robots))
    ranges = scan(simulation, "/a/scan").ranges
    front = 3 - HUSKY.body.parts[0].shape.size[0] / 2
    assert ranges[180] == pytest.approx(front, abs=TOLERANCE)
    assert [value for value in ranges if value < front - TOLERANCE] == []
    assert math.isinf(ranges[0])


def test_a_pushed_thing_is_seen_where_it_is(world):
    crate = box("crate", (0.5, 0.5, 0.5), Pose(2.25, 0, 0.25), mass=5)
    simulation = world(crate)
    before = scan(simulation).ranges[100]
    simulation.reset()
    assert before == pytest.approx(2.0 - LASER_X, abs=0.005)
    assert scan(simulation).ranges[100] == before
