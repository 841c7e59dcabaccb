# lab check pioneer --path
# expects: atan | drives the path | its turns fit atan(dy/dx)
# expects: exchanged | drives the path | its turns fit atan2(dx, dy)
# expects: degrees | drives the path | its turns fit a heading in degrees
# expects: yaw | drives the path | its turns fit orientation.z in place of the heading

import math, sys
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path

FAULT = sys.argv[1]


class Follower(Node):
    def __init__(self):
        super().__init__("path_follower")
        self.points = []
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel")
        self.create_subscription(Path, "/path", self.take, 1)
        self.create_subscription(Odometry, "/ground_truth", self.drive, 1)

    def take(self, path):
        places = [one.pose.position for one in path.poses]
        self.points = self.points or [(one.x, one.y) for one in places]

    def drive(self, truth):
        pose, twist = truth.pose.pose, Twist()
        x, y, turn = pose.position.x, pose.position.y, pose.orientation
        while self.points[1:] and math.dist(self.points[0], (x, y)) < 0.4:
            self.points.pop(0)
        if self.points:
            dx, dy = self.points[0][0] - x, self.points[0][1] - y
            heading = turn.z if FAULT == "yaw" else 2 * math.atan2(turn.z, turn.w)
            heading = math.degrees(heading) if FAULT == "degrees" else heading
            way = math.atan2(dx, dy) if FAULT == "exchanged" else math.atan2(dy, dx)
            way = math.atan(dy / dx) if FAULT == "atan" else way
            twist.linear.x = 0.4
            twist.angular.z = 2.0 * math.remainder(way - heading, math.tau)
            self.publisher.publish(twist)


lcmtools.init()
lcmtools.spin(Follower())
