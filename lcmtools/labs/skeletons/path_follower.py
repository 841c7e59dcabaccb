"""Follow a path with the Pioneer (skeleton).

Run it with   python path_follower.py   while the simulator runs: lcmtools run sim --world pioneer
Look at the path with   lcmtools sim snapshot world.png   and   lcmtools echo -n 1 '/path/poses[0]'
"""

import math
from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path


class PathFollower(Node):
    """Drives along a path."""

    def __init__(self) -> None:
        super().__init__("path_follower")
        self.points: list[tuple[float, float]] = []  # of the path, in the frame world [m]
        self.next = 0  # the number of the point that the robot drives to
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel")
        self.create_subscription(Path, "/path", self.path_callback, 1)
        self.create_subscription(Odometry, "/ground_truth", self.odometry_callback, 1)

    def path_callback(self, path: Path) -> None:
        """Take the path. This is complete."""
        if not self.points:  # the simulator may repeat it
            self.points = [(one.pose.position.x, one.pose.position.y) for one in path.poses]

    def odometry_callback(self, odometry: Odometry) -> None:
        """Drive to the next point of the path: the robot's true pose comes 50 times a second."""
        if not self.points:
            return
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        heading = 2 * math.atan2(orientation.z, orientation.w)  # [rad], 0 along x
        message = Twist()

        # TODO 1: let self.next go on, as long as the point with this number is nearer to
        # (position.x, position.y) than 0.4 m, but not beyond the last point. At the last one, stop.

        # TODO 2: compute the angle to the next point, as the robot sees it: math.atan2 of the way
        # there, minus the heading. Between which two values can it be? math.remainder(angle,
        # math.tau) brings any angle there.

        # TODO 3: set message.linear.x to 0.4 m/s, and message.angular.z [rad/s] so that the robot
        # turns to the point: the greater the angle, the faster. Which speed keeps to the path best?
        del position, heading  # remove this line

        self.publisher.publish(message)


def main(args: Sequence[str] | None = None) -> None:
    """Follow the path until Ctrl-C."""
    lcmtools.init(args)
    follower = PathFollower()
    lcmtools.spin(follower)
    follower.publisher.publish(Twist())  # or the robot goes on with the last one
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
