"""The node that measures how well a controller does."""

import math

import pytest

from lcmtools.labs.nodes.evaluate_controller import EvaluateController
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry


def _twist(forward, turn_rate):
    twist = Twist()
    twist.linear.x, twist.angular.z = forward, turn_rate
    return twist


def _odometry(forward, turn_rate):
    message = Odometry()
    message.twist.twist = _twist(forward, turn_rate)
    return message


def _stats(bench):
    heard = bench.published("/evaluation_stat", ControllerEvaluationStat)
    return [(stat.samples, stat.last_error, stat.average_error) for stat in heard]


def test_average_is_the_root_of_the_mean_of_squares(bench):
    bench.start(EvaluateController)
    bench.publish("/desired_velocity", _twist(0.0, 0.0))
    bench.publish("/odometry", *(_odometry(error, 0.0) for error in (3.0, 4.0, 0.0, 0.0)))
    assert _stats(bench)[-1] == (4, 0.0, 2.5)


def test_nothing_is_measured_before_the_first_desired_velocity(bench):
    bench.start(EvaluateController)
    bench.publish("/odometry", _odometry(1.0, 0.0), _odometry(1.0, 0.0))
    assert _stats(bench) == []


def test_each_odometry_message_is_one_sample(bench):
    bench.start(EvaluateController)
    bench.publish("/desired_velocity", _twist(0.5, 0.2))
    bench.publish("/odometry", _odometry(0.2, 0.6), _odometry(0.5, 0.2))
    expected = [(1, 0.5, 0.5), (2, 0.0, math.sqrt(0.125))]
    assert _stats(bench) == [pytest.approx(stat) for stat in expected]


def test_error_is_that_to_the_newest_desired_velocity(bench):
    bench.start(EvaluateController)
    bench.publish("/desired_velocity", _twist(0.5, 0.0), _twist(0.0, 0.0))
    bench.publish("/odometry", _odometry(0.3, 0.4))
    assert _stats(bench) == [pytest.approx((1, 0.5, 0.5))]


def test_velocity_that_is_not_finite_does_not_spoil_the_average(bench, capsys):
    bench.start(EvaluateController)
    bench.publish("/desired_velocity", _twist(0.5, 0.0))
    bench.publish(
        "/odometry", _odometry(math.nan, 0.0), _odometry(0.0, math.inf), _odometry(0.4, 0.0)
    )
    assert _stats(bench) == [pytest.approx((1, 0.1, 0.1))]
    assert capsys.readouterr().err.count("a velocity is not finite: sample ignored") == 1
