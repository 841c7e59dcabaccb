"""A student's controller of the Husky, with the fault that is its first argument."""

import sys

import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

FAULT = sys.argv[1]


class Controller(lcmtools.Node):
    """A proportional controller."""

    def __init__(self):
        super().__init__("mine")
        self.desired = Twist()
        self.efforts = self.create_publisher(JointState, "velocity_cmd")
        self.create_subscription(Twist, "desired_velocity", self.desire)
        self.create_subscription(Odometry, "odometry", self.control)

    def desire(self, twist):
        """Take the desired velocity."""
        self.desired = twist

    def control(self, odometry):
        """Command an effort."""
        speed, turn_rate = odometry.twist.twist.linear.x, odometry.twist.twist.angular.z
        if FAULT == "raises" and speed > 0.3:
            raise ValueError("too fast")
        if FAULT == "open":
            speed = turn_rate = 0.0
        if FAULT == "positive":
            speed = -speed
        forward = 0.8 * (self.desired.linear.x - speed)
        turn = 0.0 if FAULT == "straight" else 0.4 * (self.desired.angular.z - turn_rate)
        forward = -forward if FAULT == "backward" else forward
        if FAULT != "silent":
            self.efforts.publish(JointState(effort=[forward - turn, forward + turn]))


lcmtools.init()
lcmtools.spin(Controller())
