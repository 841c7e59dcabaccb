"""The messages of a running simulation: topics, rates, frames, stamps and values."""

import math
from collections import Counter
from dataclasses import replace

import pytest

from lcmtools.clock import join_stamp
from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.sensor_msgs import Imu, JointState
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.sensors.sensor import SensorMount


def run(simulation, seconds):
    return [simulation.step() for _ in range(round(seconds / simulation.scene.dt))]


def last(steps, topic):
    return next(s for samples in reversed(steps) for s in samples if s.topic == topic)


def stamps(message):
    """All the times that a message carries."""
    if isinstance(message, Clock):
        return [message.clock]
    if isinstance(message, TFMessage):
        return [transform.header.stamp for transform in message.transforms]
    return [message.header.stamp]


def test_rates_are_exact_over_ten_seconds(simulate):
    steps = run(simulate(), 10.0)
    assert Counter(sample.topic for samples in steps for sample in samples) == {
        "/clock": 500,
        "/husky0/odometry": 500,
        "/husky0/wheel_velocities": 500,
        "/husky0/ground_truth": 500,
        "/husky0/imu": 500,
        "/tf": 500,
    }


@pytest.mark.parametrize("dt", [1 / 240, 1 / 1000, 0.004])
def test_each_sensor_keeps_its_own_rate_and_none_comes_twice_a_step(simulate, dt):
    rates = (0.5, 10, 30, 50, 100, 1e4)
    mounts = tuple(SensorMount("odometry", f"at{rate}", rate) for rate in rates)
    robot = RobotPlacement(replace(HUSKY, sensors=mounts), "/h")
    steps = run(simulate(scene=Scene("rates", dt=dt, robots=(robot,))), 10.0)
    found = Counter(sample.topic for samples in steps for sample in samples)
    assert {topic: count for topic, count in found.items() if topic != "/clock"} == {
        f"/h/at{rate}": min(rate * 10, len(steps)) for rate in rates
    }
    for samples in steps:
        assert len({sample.topic for sample in samples}) == len(samples)


def test_a_robot_that_comes_later_keeps_the_rates_and_leaves_the_others_alone(simulate):
    simulation = simulate()
    run(simulation, 1.0)
    late = simulation.add(RobotPlacement(HUSKY, "/late", Pose(0, 5)))
    counts = Counter(s.topic for samples in run(simulation, 2.0) for s in samples)
    assert counts["/late/odometry"] == counts["/husky0/odometry"] == 100
    simulation.remove(late)
    counts = Counter(s.topic for samples in run(simulation, 2.0) for s in samples)
    assert counts["/late/odometry"] == 0
    assert counts["/husky0/odometry"] == 100


def test_topics_without_subscribers_are_not_measured_but_for_those_that_are_always(simulate):
    mounts = (
        SensorMount("odometry", "odometry", 50.0),
        SensorMount("ground_truth", "truth", 50.0, always=True),
        SensorMount("imu", "imu", 50.0),
    )
    robot = RobotPlacement(replace(HUSKY, sensors=mounts), "/h")
    simulation = simulate(scene=Scene("heard", robots=(robot,)))
    simulation.select(lambda topic: Subscribers.KNOWN if topic == "/h/imu" else Subscribers.NONE)
    topics = {sample.topic for samples in run(simulation, 1.0) for sample in samples}
    assert topics == {"/h/imu", "/h/truth"}


def test_without_subscribers_nothing_is_sent(simulate):
    fast = SensorMount("wheel_states", "wheels", 240.0)
    robot = RobotPlacement(replace(HUSKY, sensors=(fast,)), "/h")
    simulation = simulate(scene=Scene("unheard", robots=(robot,)))
    simulation.select(lambda _: Subscribers.NONE)
    assert [samples for samples in run(simulation, 1.0) if samples] == []


def test_a_clock_that_alone_is_subscribed_ticks_at_its_least_rate(simulate):
    simulation = simulate()
    simulation.select(lambda topic: Subscribers.KNOWN if topic == "/clock" else Subscribers.NONE)
    topics = [sample.topic for samples in run(simulation, 1.0) for sample in samples]
    assert topics == ["/clock"] * 50


def test_topics_and_types_are_known_before_the_first_step(simulate):
    assert simulate().topics() == {
        "/clock": Clock,
        "/husky0/odometry": Odometry,
        "/husky0/wheel_velocities": JointState,
        "/husky0/ground_truth": Odometry,
        "/husky0/imu": Imu,
        "/tf": TFMessage,
    }


def test_a_robot_in_the_root_namespace_has_plain_topics_and_frames(simulate):
    simulation = simulate(scene=Scene("root", robots=(RobotPlacement(HUSKY, "/"),)))
    odometry = last(run(simulation, 0.1), "/odometry").message
    assert isinstance(odometry, Odometry)
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")


def test_all_messages_of_a_step_carry_its_time(simulate):
    simulation = simulate()
    for step in range(1, 241):
        for sample in simulation.step():
            message = sample.message
            for stamp in stamps(message):
                assert join_stamp(stamp.sec, stamp.nsec) == round(step * 1e9 / 240)
    assert simulation.time == 1_000_000_000


def test_the_clock_is_never_behind_a_stamp(simulate):
    simulation = simulate(scene=Scene("fine", dt=0.003, robots=(RobotPlacement(HUSKY, "/a"),)))
    for samples in run(simulation, 1.0):
        assert not samples or samples[0].topic == "/clock"


def test_odometry_says_pose_twist_frames_and_covariances(simulate, twist):
    simulation = simulate(pose=Pose(1, 2, 0, yaw=1.0))
    simulation.robots[0].command(twist(0.5, 0.3))
    message = last(run(simulation, 4.0), "/husky0/odometry").message
    assert isinstance(message, Odometry)
    assert message.header.frame_id == "husky0/odom"
    assert message.child_frame_id == "husky0/base_link"
    assert message.twist.twist.linear.x == pytest.approx(0.5, rel=0.001)
    assert message.twist.twist.angular.z == pytest.approx(0.3, rel=0.001)
    assert message.twist.twist.linear.y == 0
    yaw = 2 * math.atan2(message.pose.pose.orientation.z, message.pose.pose.orientation.w)
    assert yaw == pytest.approx(0.3 * 4, abs=0.06)
    diagonal = [message.pose.covariance[i * 7] for i in range(6)]
    assert diagonal == [0.001] * 5 + [0.03]
    assert sum(message.pose.covariance) == pytest.approx(0.035)
    assert message.twist.covariance == message.pose.covariance


def test_ground_truth_is_in_the_world_and_its_twist_in_the_robot(simulate, effort):
    simulation = simulate(pose=Pose(1, 2, 0, yaw=math.pi / 2))
    simulation.robots[0].command(effort(1, 1))
    message = last(run(simulation, 3.0), "/husky0/ground_truth").message
    assert isinstance(message, Odometry)
    assert (message.header.frame_id, message.child_frame_id) == ("world", "husky0/base_link")
    position = message.pose.pose.position
    assert (position.x, position.y, position.z) == pytest.approx((1, 4.8, 0.13228), abs=0.01)
    assert message.pose.pose.orientation.z == pytest.approx(math.sqrt(0.5), abs=1e-3)
    assert message.twist.twist.linear.x == pytest.approx(1.0, rel=0.02)
    assert message.twist.twist.linear.y == pytest.approx(0.0, abs=1e-6)


def test_wheel_velocities_are_left_then_right(simulate, effort):
    simulation = simulate()
    simulation.robots[0].command(effort(0.5, 1.0))
    message = last(run(simulation, 3.0), "/husky0/wheel_velocities").message
    assert isinstance(message, JointState)
    assert message.header.frame_id == "husky0/base_link"
    assert message.name == ["left", "right"]
    assert message.velocity == pytest.approx([3.028, 6.057], rel=0.001)
    assert message.effort == (0.5, 1.0)
    assert message.position[1] == pytest.approx(2 * message.position[0], rel=0.001)


def test_every_message_can_be_encoded(simulate):
    for samples in run(simulate(), 0.1):
        for sample in samples:
            assert len(encode(sample.message)) > 8


@pytest.mark.parametrize(
    "bad",
    [(math.nan, 1.0), (math.inf, math.inf), (1.0,), (1.0, 1.0, 1.0), ()],
)
def test_a_bad_command_changes_nothing_and_the_robot_stays_finite(simulate, effort, bad):
    simulation = simulate()
    robot = simulation.robots[0]
    robot.command(effort(1, 1))
    run(simulation, 2.0)
    message = JointState()
    message.effort = bad
    with pytest.raises(ValueMismatch):
        robot.command(message)
    run(simulation, 1.0)
    state = robot.state(simulation.time)
    assert all(map(math.isfinite, (*state.position, *state.velocity, *state.odometry_pose)))
    assert state.velocity[0] == pytest.approx(1.0, rel=0.02)


def test_absurdly_large_commands_are_obeyed_within_the_limits(simulate, twist):
    simulation = simulate()
    simulation.robots[0].command(twist(1e308, -1e308))
    run(simulation, 3.0)
    state = simulation.robots[0].state(simulation.time)
    assert state.velocity[0] == pytest.approx(1.0, rel=0.02)
    assert state.angular_velocity[2] == pytest.approx(-1.0, rel=0.02)
