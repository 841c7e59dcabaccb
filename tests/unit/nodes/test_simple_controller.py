"""The controller's node: what it takes, what it publishes and when."""

import math

import pytest

from lcmtools import Parameter
from lcmtools.errors import UsageError
from lcmtools.labs.nodes.simple_controller import SimpleController
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

TOPIC = "/controlled_velocity"


def _twist(forward, turn_rate=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = forward, turn_rate
    return twist


def _odometry(time, forward=0.0, turn_rate=0.0):
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nsec = divmod(round(time * 1e9), 10**9)
    message.twist.twist = _twist(forward, turn_rate)
    return message


def _efforts(bench, topic=TOPIC):
    return [tuple(message.effort) for message in bench.published(topic, JointState)]


@pytest.mark.parametrize(
    ("topic", "message"), [("/odometry", _odometry(1.0)), ("/desired_velocity", _twist(0.5))]
)
def test_controller_is_silent_until_it_has_both_inputs(bench, topic, message):
    controller = bench.start(SimpleController)
    bench.publish(topic, message, message)
    controller.stop()
    assert _efforts(bench) == []


def test_controller_publishes_efforts_of_left_and_right_at_the_odometry_s_time(bench):
    bench.start(SimpleController)
    bench.publish("/odometry", _odometry(12.25))
    bench.publish("/desired_velocity", _twist(0.5))
    (command,) = bench.published(TOPIC, JointState)
    assert command.name == ["left", "right"]
    assert (list(command.position), list(command.velocity)) == ([], [])
    assert tuple(command.effort) == pytest.approx((0.5, 0.5))
    assert (command.header.stamp.sec, command.header.stamp.nsec) == (12, 250_000_000)


def test_turn_to_the_left_is_driven_by_the_right_wheels(bench):
    bench.start(SimpleController)
    bench.publish("/desired_velocity", _twist(0.0, 1.0))
    bench.publish("/odometry", _odometry(1.0))
    assert _efforts(bench) == [pytest.approx((-0.5351, 0.5351))]


def test_controller_integrates_over_the_time_between_stamps(bench):
    bench.start(SimpleController, "_kp:=0", "_ki:=2")
    bench.publish("/desired_velocity", _twist(0.5))
    bench.publish("/odometry", _odometry(1.0), _odometry(1.02), _odometry(1.07))
    lefts = [left for left, _ in _efforts(bench)]
    assert lefts == pytest.approx([0.0, 0.02, 0.07])


def test_odometry_without_stamps_counts_by_the_node_s_clock(bench):
    bench.start(SimpleController, "_kp:=0", "_ki:=2", "_use_sim_time:=true")
    bench.publish("/desired_velocity", _twist(0.5))
    for time in (1.0, 1.05):
        bench.advance_time(time)
        bench.publish("/odometry", _odometry(0.0))
    assert [left for left, _ in _efforts(bench)] == pytest.approx([0.0, 0.05])


def test_namespace_and_remap_connect_the_controller_to_the_robot(bench):
    controller = bench.start(SimpleController, "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    bench.publish("/husky0/odometry", _odometry(1.0))
    bench.publish("/husky0/desired_velocity", _twist(0.1))
    assert controller.name == "/husky0/simple_controller"
    assert _efforts(bench, "/husky0/velocity_cmd") == [pytest.approx((0.1, 0.1))]


def test_desired_velocity_that_is_not_finite_is_refused_with_one_warning(bench, capsys):
    bench.start(SimpleController)
    bench.publish("/odometry", _odometry(1.0))
    bench.publish("/desired_velocity", _twist(0.1), _twist(math.nan), _twist(0.0, math.inf))
    bench.publish("/odometry", _odometry(1.0))
    assert _efforts(bench) == [pytest.approx((0.1, 0.1))] * 2
    warnings = capsys.readouterr().err
    assert warnings.count("\n") == 1
    assert "desired_velocity ignored: linear.x nan m/s, angular.z 0.0 rad/s" in warnings


def test_odometry_that_is_not_finite_is_refused_with_one_warning(bench, capsys):
    bench.start(SimpleController)
    bench.publish("/desired_velocity", _twist(0.1))
    bench.publish("/odometry", _odometry(1.0, math.nan), _odometry(1.1, 0.0, -math.inf))
    assert _efforts(bench) == []
    warnings = capsys.readouterr().err
    assert warnings.count("\n") == 1
    assert "odometry ignored: linear.x nan m/s, angular.z 0.0 rad/s" in warnings


def test_stop_lets_the_robot_stand(bench):
    controller = bench.start(SimpleController)
    bench.publish("/odometry", _odometry(1.0))
    bench.publish("/desired_velocity", _twist(0.5))
    controller.stop()
    assert _efforts(bench)[-1] == (0.0, 0.0)


def test_gain_that_is_no_number_is_refused(bench):
    with pytest.raises(UsageError, match="parameter kp: expected a number, got 'much'"):
        bench.start(SimpleController, "_kp:=much")


def test_changed_gain_counts_from_the_next_message_on(bench):
    controller = bench.start(SimpleController)
    bench.publish("/desired_velocity", _twist(0.5))
    bench.publish("/odometry", _odometry(1.0))
    controller.set_parameters([Parameter("kp", 0.25)])
    bench.publish("/odometry", _odometry(1.0))
    assert [efforts[0] for efforts in _efforts(bench)] == pytest.approx([0.5, 0.125])


@pytest.mark.parametrize("gain", [-0.1, float("nan"), float("inf")])
def test_gain_that_cannot_be_is_refused(bench, gain):
    controller = bench.start(SimpleController)
    (result,) = controller.set_parameters([Parameter("ki", gain)])
    assert not result.successful
    assert controller.get_parameter("ki").value == 6.7
