"""JointState and Twist as commands of a Husky, and those that are refused."""

import math

import pytest

from lcmtools.errors import ValueMismatch
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import String
from lcmtools_sim.drive import body_velocity
from lcmtools_sim.robot import interpret
from lcmtools_sim.robots.husky import HUSKY

NAN = math.nan
FOUR = ["front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"]
KNOWN = (
    "known names: left, front_left_wheel, rear_left_wheel, right, front_right_wheel,"
    " rear_right_wheel"
)


def joints(name=(), effort=(), velocity=()):
    message = JointState()
    message.name, message.effort, message.velocity = list(name), effort, velocity
    return message


def twist(forward, turn_rate):
    message = Twist()
    message.linear.x, message.angular.z = forward, turn_rate
    return message


@pytest.mark.parametrize(
    ("message", "left", "right"),
    [
        (joints(["left", "right"], effort=[1, 1]), 1, 1),
        (joints(["right", "left"], effort=[0.25, -0.5]), -0.5, 0.25),
        (joints(effort=[0.1, 0.2]), 0.1, 0.2),
        (joints(effort=[7, -7]), 1, -1),
        (joints(FOUR, effort=[0.2, 0.6, 0.4, 0.8]), 0.3, 0.7),
        (joints(["front_right_wheel", "left"], effort=[0.5, 0.1]), 0.1, 0.5),
        (joints(effort=[0.5, 0.5], velocity=[1, 1]), 0.5, 0.5),
        (joints(velocity=[2, 4]), 2 * 0.1651, 4 * 0.1651),
        (twist(0.5, 0), 0.5, 0.5),
        (twist(0, 1), -0.535125, 0.535125),
        (twist(0.5, 0.3), 0.5 - 0.1605375, 0.5 + 0.1605375),
    ],
)
def test_a_command_asks_for_side_speeds(message, left, right):
    assert interpret(message, HUSKY)[0] == pytest.approx((left, right), abs=1e-12)


@pytest.mark.parametrize(
    ("asked", "obeyed"),
    [
        ((2, 0), (1, 0)),
        ((0, -5), (0, -2)),
        ((2, 1), (1, 0.5)),
        ((0.5, 4), (0.25, 2)),
        ((-3, 3), (-1, 1)),
        ((1, 2), (1, 2)),
        ((1e300, 1e300), (1, 1)),
    ],
)
def test_a_twist_above_the_limits_keeps_its_circle(asked, obeyed):
    speeds, _ = interpret(twist(*asked), HUSKY)
    assert body_velocity(*speeds, HUSKY.drive.track) == pytest.approx(obeyed)


def test_wheel_speeds_above_the_limits_keep_their_circle():
    speeds, _ = interpret(joints(velocity=[60, 30]), HUSKY)
    forward, turn_rate = body_velocity(*speeds, HUSKY.drive.track)
    assert speeds.left / speeds.right == pytest.approx(2)
    assert forward == pytest.approx(1)
    assert abs(turn_rate) <= 2


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (joints(), "neither effort nor velocity is given; for example effort: [1, 1]"),
        (
            joints(["left", "right"]),
            "neither effort nor velocity is given; for example effort: [1, 1]",
        ),
        (
            joints(["left", "right"], effort=[1]),
            "effort has the wrong length: 1 instead of 2 (left, right)",
        ),
        (joints(effort=[1, 1, 1]), "effort has the wrong length: 3 instead of 2 (left, right)"),
        (joints(velocity=[1]), "velocity has the wrong length: 1 instead of 2 (left, right)"),
        (joints(["left", "left"], effort=[1, 1]), "a name is given twice in ['left', 'left']"),
        (joints(["left", "wing"], effort=[1, 1]), f"unknown wheel 'wing'; {KNOWN}"),
        (joints(["left"], effort=[1]), "no value for the side of 'right'; give both sides"),
        (joints(effort=[1, NAN]), "effort[1] is nan, which is not a finite number"),
        (joints(velocity=[-math.inf, 1]), "velocity[0] is -inf, which is not a finite number"),
        (twist(NAN, 0), "linear.x is nan, which is not a finite number"),
        (twist(0, math.inf), "angular.z is inf, which is not a finite number"),
        (String(), "a String is not a command; send a JointState or a Twist"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_the_reason(message, reason):
    with pytest.raises(ValueMismatch) as caught:
        interpret(message, HUSKY)
    assert str(caught.value) == reason


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (joints(effort=[1, -1]), ""),
        (joints(effort=[1.0000001, 0]), ""),
        (joints(effort=[0, 5]), "effort[1] is 5, the limit 1"),
        (joints(effort=[-1.5, 0]), "effort[0] is -1.5, the limit 1"),
        (joints(velocity=[6, 6]), ""),
        (joints(velocity=[50, 50]), "the speed of the wheels is 8.255 m/s, the limit 1 m/s"),
        (
            joints(velocity=[-50, 50]),
            "the turn rate of the wheels is 15.43 rad/s, the limit 2 rad/s",
        ),
        (twist(1, -2), ""),
        (twist(-5, 0), "linear.x is -5 m/s, the limit 1 m/s"),
        (twist(0.5, 2.5), "angular.z is 2.5 rad/s, the limit 2 rad/s"),
    ],
)
def test_what_is_beyond_the_limits_is_named(message, reason):
    assert interpret(message, HUSKY)[1] == reason
