"""Measure how well a controller keeps the desired velocity.

Subscribes:
    odometry           nav_msgs/Odometry      the velocity measured
    desired_velocity   geometry_msgs/Twist    the velocity desired: linear.x, angular.z

Publishes:
    evaluation_stat    air_lab0/ControllerEvaluationStat

For each odometry message after the first desired velocity: samples counts them, last_error is the
length of the difference of (linear.x [m/s], angular.z [rad/s]), and average_error is the square
root of the mean of its squares.

Example:
    lcmtools run evaluate_controller __ns:=/husky0
    lcmtools echo /husky0/evaluation_stat
"""

import math
from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry


class EvaluateController(Node):
    """Publishes the errors of a controller."""

    def __init__(self) -> None:
        super().__init__("evaluate_controller")
        self._samples = 0
        self._sum_of_squares = 0.0
        self._desired: Twist | None = None
        self._stat = self.create_publisher(ControllerEvaluationStat, "evaluation_stat")
        # a deep queue: each message is one sample, also when the computer is busy for a second
        self.create_subscription(Odometry, "odometry", self._odometry_callback, 100)
        self.create_subscription(Twist, "desired_velocity", self._desired_velocity_callback, 1)

    def _desired_velocity_callback(self, twist: Twist) -> None:
        self._desired = twist

    def _odometry_callback(self, odometry: Odometry) -> None:
        if self._desired is None:
            return
        measured, desired = odometry.twist.twist, self._desired
        forward, turn_rate = measured.linear.x, measured.angular.z
        error = math.hypot(forward - desired.linear.x, turn_rate - desired.angular.z)
        if not math.isfinite(error):  # one such error would spoil the average for ever
            self.get_logger().warning("a velocity is not finite: sample ignored", once=True)
            return
        self._samples += 1
        self._sum_of_squares += error * error
        message = ControllerEvaluationStat()
        message.samples = self._samples
        message.last_error = error
        message.average_error = math.sqrt(self._sum_of_squares / self._samples)
        self._stat.publish(message)


def main(args: Sequence[str] | None = None) -> None:
    """Measure until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(EvaluateController())
        lcmtools.shutdown()
