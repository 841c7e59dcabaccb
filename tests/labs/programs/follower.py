# lab check pioneer --path
# expects: busy | drives the path | its callback of /ground_truth runs for 0.
# expects: ended | drives the path | it gets no farther than (

import sys, time
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

FAULT = sys.argv[1]
lcmtools.init()
node = Node("path_follower")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel")
twist = Twist()


def drive(odometry):
    twist.linear.x = 0.4
    publisher.publish(twist)
    if FAULT == "busy":
        time.sleep(0.5)
    elif odometry.pose.pose.position.x > 0.0:
        lcmtools.shutdown()


node.create_subscription(Odometry, "/ground_truth", drive, 1)
lcmtools.spin(node)
