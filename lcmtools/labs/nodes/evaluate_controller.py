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


class ErrorStatistics:
    """Root mean square of the errors so far.

    Attributes:
        samples: Their number.
        last: The newest.
    """

    def __init__(self) -> None:
        self.samples = 0
        self.last = 0.0
        self._sum_of_squares = 0.0

    def add(self, error: float) -> None:
        """Count one more."""
        self.samples += 1
        self.last = error
        self._sum_of_squares += error * error

    def average(self) -> float:
        """Return the square root of the mean of the squares; 0 when there are none."""
        return math.sqrt(self._sum_of_squares / max(1, self.samples))


class EvaluateController(Node):
    """Publishes the errors of a controller."""

    def __init__(self) -> None:
        super().__init__("evaluate_controller")
        self._errors = ErrorStatistics()
        self._desired: Twist | None = None
        self._stat = self.create_publisher(ControllerEvaluationStat, "evaluation_stat")
        # a deep queue: each message is one sample, also when the computer is busy for a second
        self.create_subscription(Odometry, "odometry", self._take_odometry, 100)
        self.create_subscription(Twist, "desired_velocity", self._take_desired_velocity, 1)

    def _take_desired_velocity(self, twist: Twist) -> None:
        self._desired = twist

    def _take_odometry(self, odometry: Odometry) -> None:
        if self._desired is None:
            return
        error = _error(odometry.twist.twist, self._desired)
        if not math.isfinite(error):  # one such error would spoil the average for ever
            self.get_logger().warning("a velocity is not finite: sample ignored", once=True)
            return
        self._errors.add(error)
        self._publish()

    def _publish(self) -> None:
        message = ControllerEvaluationStat()
        message.samples = self._errors.samples
        message.last_error = self._errors.last
        message.average_error = self._errors.average()
        self._stat.publish(message)


def _error(measured: Twist, desired: Twist) -> float:
    """Return the distance of two velocities, 1 m/s counting as much as 1 rad/s."""
    return math.hypot(measured.linear.x - desired.linear.x, measured.angular.z - desired.angular.z)


def main(args: Sequence[str] | None = None) -> None:
    """Measure until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(EvaluateController())
        lcmtools.shutdown()
