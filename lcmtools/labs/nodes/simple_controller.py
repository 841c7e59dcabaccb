"""Make the Husky drive at a desired velocity, by the efforts of its wheels.

Subscribes:
    odometry              nav_msgs/Odometry       the velocity measured
    desired_velocity      geometry_msgs/Twist     the velocity desired: linear.x, angular.z

Publishes:
    controlled_velocity   sensor_msgs/JointState  effort of [left, right], each in [-1, 1],
                                                  whenever one of the two comes

Parameters, from 0 to 1000, which may change while it runs:
    kp   1.0   effort per speed error [s/m]
    ki   6.7   effort per speed error and second [1/m]

Example:
    lcmtools run sim --world husky
    lcmtools run simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd
    lcmtools pub /husky0/desired_velocity geometry_msgs/Twist "linear: [0.1, 0, 0]"
    lcmtools param set /husky0/simple_controller kp 0.5
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.labs.nodes.velocity_control import Gains, Velocity, VelocityControl
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

MAX_GAIN = 1000.0  # far beyond what is of use


class SimpleController(Node):
    """Closes the loop from odometry to wheel effort."""

    def __init__(self) -> None:
        super().__init__("simple_controller")
        usual = Gains()
        for name, usually, meaning in (
            ("kp", usual.kp, "effort per speed error [s/m]"),
            ("ki", usual.ki, "effort per speed error and second [1/m]"),
        ):
            self.declare_parameter(name, usually, meaning, minimum=0.0, maximum=MAX_GAIN)
        self._control = VelocityControl(usual)
        self._desired: Velocity | None = None
        self._measured: Velocity | None = None
        self._time = 0
        self._effort = self.create_publisher(JointState, "controlled_velocity")
        # of both only the newest counts: an old one that waited would act too late
        self.create_subscription(Odometry, "odometry", self._odometry_callback, 1)
        self.create_subscription(Twist, "desired_velocity", self._desired_velocity_callback, 1)

    def stop(self) -> None:
        """Stop the robot, if it has been driven: it would go on with the last effort."""
        if self._desired and self._measured:
            self._publish(0.0, 0.0)

    def _odometry_callback(self, odometry: Odometry) -> None:
        twist, stamp = odometry.twist.twist, odometry.header.stamp
        measured = Velocity(twist.linear.x, twist.angular.z)
        if not measured.is_finite():
            self.get_logger().warning(f"odometry ignored: {measured}", once=True)
            return
        self._measured = measured
        # a stamp of 0 means that the sender has no clock; the time of reception counts
        self._time = stamp.sec * 10**9 + stamp.nsec or self.get_clock().now()
        self._update()

    def _desired_velocity_callback(self, twist: Twist) -> None:
        desired = Velocity(twist.linear.x, twist.angular.z)
        if not desired.is_finite():
            self.get_logger().warning(f"desired_velocity ignored: {desired}", once=True)
            return
        self._desired = desired
        self._update()

    def _update(self) -> None:
        if self._desired and self._measured:
            self._control.gains = Gains(self._gain("kp"), self._gain("ki"))
            self._publish(*self._control.efforts(self._desired, self._measured, self._time))

    def _gain(self, name: str) -> float:
        """Return a gain as it is now: parameters may be changed while the node runs."""
        value = self.get_parameter(name).value
        assert isinstance(value, float)  # as its default is
        return value

    def _publish(self, left: float, right: float) -> None:
        message = JointState()
        message.header.stamp.sec, message.header.stamp.nsec = divmod(self._time, 10**9)
        message.name = ["left", "right"]
        message.effort = [left, right]
        self._effort.publish(message)


def main(args: Sequence[str] | None = None) -> None:
    """Control the robot until Ctrl-C, then stop it."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        controller = SimpleController()
        lcmtools.spin(controller)
        controller.stop()
        lcmtools.shutdown()
