"""Drive the Dolly in a circle to the left, 1.67 m in radius and 21 s around.

Publishes:
    /dolly/cmd_vel   geometry_msgs/Twist   0.5 m/s forward and 0.3 rad/s, every 500 ms

Example:
    lcmtools run sim --world dolly
    lcmtools run moving_robot
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.geometry_msgs import Twist

PERIOD = 0.5  # seconds between two commands
FORWARD_SPEED = 0.5  # [m/s]
TURN_RATE = 0.3  # [rad/s], positive to the left


class MovingRobot(Node):
    """Commands the same velocity again and again."""

    def __init__(self) -> None:
        super().__init__("moving_robot")
        self._velocity = self.create_publisher(Twist, "/dolly/cmd_vel", 10)
        self.create_timer(PERIOD, self._command)

    def _command(self) -> None:
        twist = Twist()
        twist.linear.x = FORWARD_SPEED
        twist.angular.z = TURN_RATE
        self.get_logger().info(
            f"Publishing: linear.x {twist.linear.x:.2f} m/s, angular.z {twist.angular.z:.2f} rad/s"
        )
        self._velocity.publish(twist)


def main(args: Sequence[str] | None = None) -> None:
    """Command the robot until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(MovingRobot())
        lcmtools.shutdown()
