"""An inertial sensor measures gravity, the motors, and the circle. m/s^2, rad/s, metres."""

import math
from dataclasses import replace

import numpy as np
import pytest
from fixtures.simulations import messages_on

from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.sensors.motion import ImuSettings
from lcmtools_sim.sensors.sensor import SensorMount

G = 9.81


@pytest.fixture
def place(simulate):
    """Makes a simulation of one Husky with one IMU at a pose in base_link, at every step."""

    def make(
        mounted=Pose(),  # noqa: B008 - a value
        start=Pose(),  # noqa: B008 - a value
        *,
        seed=0,
        gravity=G,
        settings=ImuSettings(),  # noqa: B008 - a value
    ):
        mount = SensorMount("imu", "imu", 240.0, mounted, settings=settings)
        robot = RobotPlacement(replace(HUSKY, sensors=(mount,)), "/h", start)
        return simulate(scene=Scene("imu", seed=seed, gravity=gravity, robots=(robot,)))

    return make


def xyz(vector):
    return vector.x, vector.y, vector.z


def felt(message):
    return xyz(message.linear_acceleration)


@pytest.mark.parametrize("gravity", [9.81, 1.62])
def test_at_rest_it_feels_what_holds_it_up_and_no_turning(place, gravity):
    message = messages_on("/h/imu", place(gravity=gravity), 1.0)[-1]
    assert felt(message) == pytest.approx((0, 0, gravity), abs=0.01)
    assert xyz(message.angular_velocity) == pytest.approx((0, 0, 0), abs=1e-6)
    assert message.header.frame_id == "h/imu_link"


def test_it_starts_at_rest_and_does_not_fall_onto_the_ground_first(place):
    for message in messages_on("/h/imu", place(), 0.1):
        assert felt(message) == pytest.approx((0.0, 0.0, G), abs=0.01)


@pytest.mark.parametrize("gravity", [G, 1.62])
def test_on_a_slope_it_feels_the_same_along_its_tilted_axes(simulate, gravity):
    tilt = 0.15  # nose down
    top = 0.5 / math.cos(tilt) + 0.001
    ramp = box("ramp", (20, 8, 1), Pose(pitch=tilt), friction=1.0)
    mount = SensorMount("imu", "imu", 240.0, settings=ImuSettings())
    start = Pose(z=top, pitch=tilt)
    robot = RobotPlacement(replace(HUSKY, sensors=(mount,)), "/h", start)
    scene = Scene("slope", gravity=gravity, objects=(ramp,), robots=(robot,))
    message = messages_on("/h/imu", simulate(scene=scene), 2.0)[-1]
    expected = -gravity * math.sin(tilt), 0.0, gravity * math.cos(tilt)
    assert felt(message) == pytest.approx(expected, abs=0.002)
    assert xyz(message.angular_velocity) == pytest.approx((0, 0, 0), abs=1e-3)


@pytest.mark.parametrize(
    ("turned", "expected"),
    [
        (Pose(roll=math.pi), (0, 0, -G)),
        (Pose(pitch=math.pi / 2), (-G, 0, 0)),  # its x axis points down
        (Pose(roll=math.pi / 2), (0, G, 0)),
        (Pose(roll=0.3), (0, G * math.sin(0.3), G * math.cos(0.3))),
    ],
)
def test_a_turned_sensor_feels_it_along_its_own_axes(place, turned, expected):
    assert felt(messages_on("/h/imu", place(turned), 1.0)[-1]) == pytest.approx(expected, abs=0.01)


def test_speeding_up_is_felt_forward_and_braking_backward(place, twist):
    simulation = place()
    simulation.robots[0].command(twist(1.0, 0.0))
    faster = messages_on("/h/imu", simulation, 0.1)[-1]
    messages_on("/h/imu", simulation, 2.0)
    steady = messages_on("/h/imu", simulation, 0.1)[-1]
    simulation.robots[0].command(twist(0.0, 0.0))
    slower = messages_on("/h/imu", simulation, 0.1)[-1]
    assert felt(faster) == pytest.approx((3.0, 0, G), abs=0.05)
    assert felt(steady) == pytest.approx((0, 0, G), abs=0.02)
    assert felt(slower) == pytest.approx((-3.0, 0, G), abs=0.05)


@pytest.mark.parametrize(("forward", "turn_rate"), [(0.5, 0.3), (1.0, -1.0), (0.0, 2.0)])
@pytest.mark.parametrize("lever", [(0.0, 0.0), (0.4, 0.0), (0.2, -0.3)])
def test_on_a_circle_it_feels_the_centripetal_acceleration_of_where_it_is(
    place, twist, forward, turn_rate, lever
):
    x, y = lever
    simulation = place(Pose(x, y, 0.2))
    simulation.robots[0].command(twist(forward, turn_rate))
    messages_on("/h/imu", simulation, 2.0)
    messages = messages_on("/h/imu", simulation, 1.0)
    mean = np.mean([felt(message) for message in messages], axis=0)
    expected = (-(turn_rate**2) * x, forward * turn_rate - turn_rate**2 * y, G)
    assert mean == pytest.approx(expected, abs=0.01 * max(1.0, abs(forward * turn_rate)))
    assert messages[-1].angular_velocity.z == pytest.approx(turn_rate, rel=0.001)


def test_beginning_to_turn_is_felt_across_a_lever(place, twist):
    simulation = place(Pose(0.4, 0.0, 0.0))
    simulation.robots[0].command(twist(0.0, 2.0))
    messages = messages_on("/h/imu", simulation, 0.2)
    rates = [message.angular_velocity.z for message in messages]
    euler = (rates[24] - rates[23]) * 240 * 0.4
    assert euler > 1.0
    assert felt(messages[24])[1] == pytest.approx(euler, rel=0.02)


def test_the_orientation_is_that_of_the_sensor_in_the_world(place):
    message = messages_on("/h/imu", place(Pose(yaw=0.5), Pose(3, 4, 0, yaw=0.7)), 0.5)[-1]
    turned = message.orientation
    assert (turned.x, turned.y) == pytest.approx((0, 0), abs=1e-4)
    assert 2 * math.atan2(turned.z, turned.w) == pytest.approx(1.2, abs=1e-4)


def test_falling_it_feels_nothing(place):
    message = messages_on("/h/imu", place(start=Pose(0, 0, 5)), 0.5)[-1]
    assert felt(message) == pytest.approx((0, 0, 0), abs=0.01)


def test_its_noise_has_the_deviations_that_are_asked_for_and_says_them(place):
    messages = messages_on("/h/imu", place(settings=ImuSettings(0.02, 0.3)), 10.0)[240:]
    accelerations = np.array([felt(message) for message in messages]) - (0, 0, G)
    rates = np.array([xyz(message.angular_velocity) for message in messages])
    assert accelerations.std(axis=0) == pytest.approx([0.3] * 3, rel=0.06)
    assert rates.std(axis=0) == pytest.approx([0.02] * 3, rel=0.06)
    assert abs(accelerations.mean(axis=0)).max() < 4 * 0.3 / math.sqrt(len(messages))
    assert abs(rates.mean(axis=0)).max() < 4 * 0.02 / math.sqrt(len(messages))
    one_after_another = np.corrcoef(accelerations[1:, 0], accelerations[:-1, 0])[0, 1]
    assert abs(one_after_another) < 0.1  # white
    assert messages[0].linear_acceleration_covariance[::4] == pytest.approx((0.09,) * 3)
    assert messages[0].angular_velocity_covariance[::4] == pytest.approx((0.0004,) * 3)
