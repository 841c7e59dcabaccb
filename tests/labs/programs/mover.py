# lab check dolly --mover
# expects: once | rate of commands | one command came, and no other for
# expects: timer | commands the robot | a period of 500 s; if 500 ms are meant, write 0.5

import sys
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

FAULT = sys.argv[1]
lcmtools.init()
node = Node("moving_robot")
publisher = node.create_publisher(Twist, "/dolly/cmd_vel")
twist = Twist()
twist.linear.x, twist.angular.z = 0.5, 0.0 if FAULT == "velocity" else 0.3


def move():
    if FAULT != "once" or node.get_clock().now() < start + 10**9:
        publisher.publish(twist)


start = node.get_clock().now()
node.create_timer(500.0 if FAULT == "timer" else 0.5, move)
lcmtools.spin(node)
