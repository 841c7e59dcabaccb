"""Make the Husky drive at a desired velocity, by the efforts of its wheels (skeleton).

    lcmtools run sim --world husky
    python simple_controller.py __ns:=/husky0 controlled_velocity:=velocity_cmd
    lcmtools pub /husky0/desired_velocity geometry_msgs/Twist "linear: [0.1, 0, 0]"
    lcmtools wtf

The topics' names have no slash in front: with __ns:=/husky0 they are below /husky0.
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState


class SimpleController(Node):
    """Controls the velocity of a robot with wheels at its two sides."""

    def __init__(self) -> None:
        super().__init__("simple_controller")
        self.desired = Twist()  # the velocity desired; 0 at first
        self.publisher = self.create_publisher(JointState, "controlled_velocity")
        self.create_subscription(Odometry, "odometry", self.odometry_callback, 1)
        self.create_subscription(Twist, "desired_velocity", self.desired_velocity_callback, 1)

    def desired_velocity_callback(self, twist: Twist) -> None:
        """Take a new desired velocity."""
        # TODO 1: keep it for odometry_callback.
        del twist  # remove this line

    def odometry_callback(self, odometry: Odometry) -> None:
        """Compare how the robot moves with how it should, and command the wheels."""
        # TODO 2: compute the errors: desired minus measured, for the forward speed
        # odometry.twist.twist.linear.x [m/s] and the turn rate odometry.twist.twist.angular.z
        # [rad/s].
        del odometry  # remove this line

        # TODO 3: from the errors, compute the efforts of the left and the right wheels, each from
        # -1 (full power backward) to 1. Both wheels together change the speed, their difference
        # the turn rate: to turn left, the right wheels have to be the faster ones. Begin with a
        # proportional controller (effort = gain * error). Does the robot get as fast as it
        # should? Add what is missing: the sum of the errors so far, times a small gain.
        left, right = 0.0, 0.0
        self.publish_efforts(left, right)

    def publish_efforts(self, left: float, right: float) -> None:
        """Command the wheels: each effort from -1 to 1."""
        message = JointState()
        message.name = ["left", "right"]
        message.effort = [left, right]
        self.publisher.publish(message)


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    controller = SimpleController()
    lcmtools.spin(controller)
    controller.publish_efforts(0.0, 0.0)  # or the robot goes on with the last ones
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
