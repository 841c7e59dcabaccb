"""Follow a path with the Pioneer, by pure pursuit.

Subscribes:
    /path             nav_msgs/Path        the path, in the frame world; followed from its start
    /ground_truth     nav_msgs/Odometry    the robot's pose in world

Publishes:
    /RosAria/cmd_vel  geometry_msgs/Twist  with each pose, once there is a path; 0 at its end

The robot drives along the circle to the point of the path that is 0.4 m ahead of it (R. Coulter,
Implementation of the Pure Pursuit Path Tracking Algorithm, 1992).

Example:
    lcmtools run sim --world pioneer
    lcmtools run path_follower
"""

import math
from collections.abc import Iterator, Sequence
from itertools import chain, pairwise, starmap

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path

SPEED = 0.4  # [m/s]
LOOKAHEAD = 0.4
"""Distance of the point that the robot drives to [m]: less follows closer, and swings more."""
MOST_SKIPPED = 2 * LOOKAHEAD
"""Length of the path in which its nearest point is searched [m]: a path may come back to a place,
and the robot stays on its own part of it."""
SPACING = 0.1  # distance of two points, at most [m]: points are added to a path that has fewer

Point = tuple[float, float]


class Pursuit:
    """The place on a path of (x, y) [m], and the curvature to drive at, as plain mathematics."""

    def __init__(self, points: Sequence[Point]) -> None:
        self._points = [*chain.from_iterable(starmap(_piece, pairwise(points))), points[-1]]
        self.nearest = 0  # the number of the nearest point, also of those added; it never goes back

    def advance(self, place: Point) -> None:
        """Advance to the point closest to the robot."""
        near, length = self.nearest, 0.0
        for number in range(self.nearest + 1, len(self._points)):
            length += math.dist(self._points[number - 1], self._points[number])
            if length > MOST_SKIPPED:
                break
            if math.dist(self._points[number], place) <= math.dist(self._points[near], place):
                near = number
        self.nearest = near

    @property
    def is_over(self) -> bool:
        """True at the end of the path."""
        return self.nearest >= len(self._points) - 1

    def curvature(self, place: Point, heading: float) -> float:
        """Return the curvature of the circle to the point ahead [1/m], positive to the left."""
        ahead = self._points[self.nearest :]
        target = next((p for p in ahead if math.dist(p, place) >= LOOKAHEAD), ahead[-1])
        angle = math.atan2(target[1] - place[1], target[0] - place[0]) - heading
        return 2 * math.sin(angle) / max(math.dist(target, place), LOOKAHEAD)


def _piece(start: Point, end: Point) -> Iterator[Point]:
    """Interpolate from the start to before the end, with at most a thousand points."""
    count = math.ceil(max(1.0, min(1000.0, math.dist(start, end) / SPACING)))
    for number in range(count):
        part = number / count
        yield start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])


class PathFollower(Node):
    """Drives along the newest path, from its start."""

    def __init__(self) -> None:
        super().__init__("path_follower")
        self._pursuit: Pursuit | None = None
        self._velocity = self.create_publisher(Twist, "/RosAria/cmd_vel")
        self.create_subscription(Path, "/path", self._path_callback, 1)
        self.create_subscription(Odometry, "/ground_truth", self._odometry_callback, 1)

    def stop(self) -> None:
        """Stop the robot: it would go on with its last command."""
        self._velocity.publish(Twist())

    def _path_callback(self, path: Path) -> None:
        if path.poses and self._pursuit is None:  # it may be repeated for others
            points = [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses]
            self._pursuit = Pursuit(points)
            self.get_logger().info(f"following a path of {len(points)} points")

    def _odometry_callback(self, odometry: Odometry) -> None:
        if self._pursuit is None or self._pursuit.is_over:
            return
        position, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        place, heading = (position.x, position.y), 2 * math.atan2(turn.z, turn.w)
        self._pursuit.advance(place)
        twist = Twist()
        if self._pursuit.is_over:
            self.get_logger().info("at the end of the path")
        else:
            twist.linear.x = SPEED
            twist.angular.z = SPEED * self._pursuit.curvature(place, heading)
        self._velocity.publish(twist)


def main(args: Sequence[str] | None = None) -> None:
    """Follow the path until Ctrl-C, then stop the robot."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        follower = PathFollower()
        lcmtools.spin(follower)
        follower.stop()
        lcmtools.shutdown()
