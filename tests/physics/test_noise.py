"""Every sensor's noise: none unless it is asked for, of the size that is, and one seed, one run."""

import math
from dataclasses import replace

import numpy as np
import pytest

from lcmtools.messages.codec import encode
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.sensors.cameras import DepthCameraSettings
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.motion import (
    GroundTruthSettings,
    ImuSettings,
    OdometrySettings,
    WheelStatesSettings,
)
from lcmtools_sim.sensors.sensor import SensorMount

FRONT = Pose(0.6, 0.0, 0.3)
NOISY = {
    "odometry": SensorMount("odometry", "s", 50, settings=OdometrySettings(0.01, 0.02, 0.03)),
    "wheel_states": SensorMount("wheel_states", "s", 50, settings=WheelStatesSettings(0.01, 0.1)),
    "ground_truth": SensorMount("ground_truth", "s", 50, settings=GroundTruthSettings(0.05, 0.02)),
    "imu": SensorMount("imu", "s", 50, settings=ImuSettings(0.01, 0.1)),
    "laser": SensorMount("laser", "s", 10, FRONT, settings=LaserSettings(noise=0.02)),
    "depth_camera": SensorMount(
        "depth_camera", "s", 10, FRONT, settings=DepthCameraSettings(64, 48, noise=1.4e-3)
    ),
}
WALL = box("wall", (0.2, 30, 3), Pose(4.1, 0, 1.5))


def scene(*mounts, seed=0, count=1):
    robots = tuple(
        RobotPlacement(replace(HUSKY, sensors=mounts), f"/h{i}", Pose(0, 5.0 * i))
        for i in range(count)
    )
    return Scene("noise", seed=seed, objects=(WALL,), robots=robots)


@pytest.fixture
def messages(simulate, twist):
    """The messages of one sensor of a robot that drives a circle."""

    def run(mount, seconds, *, seed=0):
        simulation = simulate(scene=scene(mount, seed=seed))
        simulation.robots[0].command(twist(0.3, 1.0))
        steps = [simulation.step() for _ in range(round(seconds * 240))]
        return [s.message for samples in steps for s in samples if s.topic.startswith("/h0/s")]

    return run


def without_noise(mount):
    if mount.kind == "depth_camera":
        return replace(mount, settings=DepthCameraSettings(64, 48))
    return replace(mount, settings=None)


@pytest.mark.parametrize("kind", NOISY)
def test_one_seed_gives_the_same_bytes_and_another_gives_others(messages, kind):
    first, again, other = (
        [encode(message) for message in messages(NOISY[kind], 0.5, seed=seed)] for seed in (7, 7, 8)
    )
    assert first == again
    assert len(first) == len(other) > 4
    assert first != other


@pytest.mark.parametrize("kind", NOISY)
def test_a_subscriber_that_joins_late_gets_the_same_measurements(simulate, twist, kind):
    def payloads(*, late):
        simulation = simulate(scene=scene(NOISY[kind], seed=7))
        simulation.robots[0].command(twist(0.3, 1.0))
        for start, subscribers in ((True, Subscribers.NONE), (False, Subscribers.KNOWN)):
            simulation.select(lambda _, now=subscribers: now if late else Subscribers.KNOWN)
            steps = [simulation.step() for _ in range(100)]
            assert any(s.topic.startswith("/h0/s") for step in steps for s in step) or start
        return [s.payload for step in steps for s in step if s.topic.startswith("/h0/s")]

    joined, all_the_time = payloads(late=True), payloads(late=False)
    assert len(joined) > 3
    assert joined == all_the_time


@pytest.mark.parametrize("kind", NOISY)
def test_without_noise_the_seed_does_not_matter(messages, kind):
    mount = without_noise(NOISY[kind])
    first, other = (
        [encode(message) for message in messages(mount, 0.3, seed=seed)] for seed in (7, 8)
    )
    assert first == other


def test_encoders_drift_from_the_way_like_a_random_walk(simulate, twist):
    # After 5 m straight on: each side is off by 0.01 sqrt(5) m, so that the forward distance is off
    # by that / sqrt(2) and the heading by that sqrt(2) / track.
    mount = replace(NOISY["odometry"], settings=OdometrySettings(0.01))
    ways, headings = [], []
    simulation = simulate(scene=replace(scene(mount, count=24), objects=()))
    simulation.select(lambda _: Subscribers.NONE)
    for robot in simulation.robots:
        robot.command(twist(1.0, 0.0))
    for _ in range(round(5.35 * 240)):
        simulation.step()
    for robot in simulation.robots:
        state = robot.state(0)
        x, y, yaw = state.odometry_pose
        ways.append(math.hypot(x, y) - state.position[0])
        headings.append(yaw)
    spread = 0.01 * math.sqrt(5)
    assert np.std(headings) == pytest.approx(spread * math.sqrt(2) / HUSKY.drive.track, rel=0.35)
    assert np.std(ways) == pytest.approx(spread / math.sqrt(2), rel=0.35)
    assert abs(np.mean(headings)) < 4 * np.std(headings) / math.sqrt(24)


def test_encoders_at_rest_do_not_drift_and_the_robot_drives_as_without_noise(simulate, twist):
    mount = replace(NOISY["odometry"], settings=OdometrySettings(0.05))
    noisy, exact = (simulate(scene=scene(one)) for one in (mount, replace(mount, settings=None)))
    for simulation in (noisy, exact):
        for _ in range(240):
            simulation.step()
        assert simulation.robots[0].state(0).odometry_pose == (0, 0, 0)
        simulation.robots[0].command(twist(0.3, 1.0))
        for _ in range(480):
            simulation.step()
    first, second = (simulation.robots[0].state(0) for simulation in (noisy, exact))
    assert first.position == second.position
    assert first.odometry_pose != second.odometry_pose
    assert math.dist(first.odometry_pose, second.odometry_pose) < 0.3


def test_odometry_and_the_transform_to_base_link_drift_together(simulate, twist):
    mounts = (
        replace(NOISY["odometry"], topic="odom"),
        SensorMount("transforms", "/tf", 50.0),
    )
    simulation = simulate(scene=scene(*mounts))
    simulation.robots[0].command(twist(0.3, 1.0))
    for _ in range(600):
        samples = {sample.topic: sample.message for sample in simulation.step()}
        if "/tf" in samples:
            pose, transform = samples["/h0/odom"].pose.pose, samples["/tf"].transforms[0].transform
            assert (pose.position.x, pose.position.y) == (
                transform.translation.x,
                transform.translation.y,
            )
            assert pose.orientation.z == transform.rotation.z


def test_white_noise_has_the_deviations_that_are_asked_for(messages):
    runs = {
        kind: (messages(NOISY[kind], 10.0), messages(without_noise(NOISY[kind]), 10.0))
        for kind in ("odometry", "wheel_states", "ground_truth")
    }

    def column(kind, read):
        noisy, exact = ([read(message) for message in run] for run in runs[kind])
        error = np.subtract(noisy, exact)
        assert abs(error.mean()) < 4 * error.std() / math.sqrt(len(error))
        return float(error.std())

    def near(value):
        return pytest.approx(value, rel=0.12)

    assert column("odometry", lambda m: m.twist.twist.linear.x) == near(0.02)
    assert column("odometry", lambda m: m.twist.twist.angular.z) == near(0.03)
    assert column("wheel_states", lambda m: m.position[0]) == near(0.01)
    assert column("wheel_states", lambda m: m.velocity[1]) == near(0.1)
    assert column("ground_truth", lambda m: m.pose.pose.position.x) == near(0.05)
    assert column("ground_truth", lambda m: m.pose.pose.position.z) == near(0.05)


def test_noise_does_not_depend_on_who_listens_to_other_sensors(simulate, twist):
    def heard(wanted):
        simulation = simulate(scene=scene(*(replace(m, topic=k) for k, m in NOISY.items())))
        simulation.select(lambda topic: Subscribers.KNOWN if wanted(topic) else Subscribers.NONE)
        simulation.robots[0].command(twist(0.3, 1.0))
        steps = [simulation.step() for _ in range(120)]
        return [
            encode(s.message)
            for samples in steps
            for s in samples
            if s.topic in ("/h0/laser", "/h0/odometry")
        ]

    assert heard(lambda _: True) == heard(lambda topic: topic in ("/h0/laser", "/h0/odometry"))


def test_the_covariance_of_the_truth_is_that_of_its_noise(messages):
    (first, *_) = messages(NOISY["ground_truth"], 0.1)
    diagonal = [*first.pose.covariance][::7]
    assert diagonal == pytest.approx([0.05**2, 0.05**2, 0.05**2, 0, 0, 0.02**2])
