# lab check pioneer --path
# expects: right | nothing

import math
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.points = None
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel", 1)
        self.create_subscription(Path, "/path", self.take, 1)
        self.create_subscription(Odometry, "/ground_truth", self.drive, 1)

    def take(self, path):
        places = [one.pose.position for one in path.poses]
        self.points = self.points or [(one.x, one.y) for one in places]

    def drive(self, truth):
        if self.points is None:
            return
        pose, twist = truth.pose.pose, Twist()
        here = pose.position.x, pose.position.y
        while self.points and math.dist(self.points[0], here) < 0.25:
            self.points.pop(0)
        if self.points:
            (x, y), heading = self.points[0], 2 * math.atan2(pose.orientation.z, pose.orientation.w)
            error = math.remainder(math.atan2(y - here[1], x - here[0]) - heading, math.tau)
            twist.angular.z = max(-1.5, min(1.5, 2.5 * error))
            twist.linear.x = 0.4 * max(0.0, math.cos(error))
        self.publisher.publish(twist)
        if not self.points:
            lcmtools.shutdown()


lcmtools.init()
lcmtools.spin(Follower())
