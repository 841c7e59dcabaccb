# lab check husky --controller
# expects: raised | commands the robot | AttributeError
# expects: topic | commands the robot | start it with velocity_comand:=velocity_cmd
# expects: subscription | commands the robot | /odometry, and not to /husky0/odometry: it begins with
# expects: slash-remap | commands the robot | __ns:=/husky0 nor controlled_velocity:=velocity_cmd
# expects: slash-input | drive at 0.1 m/s | does not apply: write 'desired_velocity'
# expects: publish | commands the robot | publish() is never called
# expects: spin | commands the robot | does it call spin(node)
# expects: died | drive at 0.1 m/s | the program died: it ended with code 1: no more efforts
# expects: ignored | drive at 0.1 m/s | unknown wheel 'l'
# expects: field | drive at 0.5 m/s | its commands are in velocity
# expects: seldom | drive at 0.1 m/s | commands come too seldom,
# expects: zero | drive at 0.1 m/s | its commands are all 0
# expects: speed-sign | drive at 0.1 m/s | wrong sign of speed (-1.00 m/s instead of +0.1)
# expects: turn-sign | turn at 0.3 rad/s | wrong sign of turn
# expects: busy | drive at 0.1 m/s | its callback of /husky0/odometry runs for 0.
# expects: endless | drive at 0.1 m/s | its callback of /husky0/odometry runs for
# expects: sleeps | callbacks return at once | its callback of /husky0/desired_velocity runs for
# expects: sometimes | raises no exception | callback of /husky0/odometry raised
# expects: clock | nothing
# expects: twice | nothing | 2 nodes have the name /husky0/simple_controller

import sys, time
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

FAULT = sys.argv[1]


class Controller(Node):
    def __init__(self):
        super().__init__("simple_controller")
        output = "velocity_comand" if FAULT == "topic" else "controlled_velocity"
        output = "/controlled_velocity" if FAULT == "slash-remap" else output
        source = "/odometry" if FAULT == "subscription" else "odometry"
        goal = "/desired_velocity" if FAULT == "slash-input" else "desired_velocity"
        self.publisher = self.create_publisher(JointState, output)
        self.create_subscription(Odometry, source, self.take_odometry, 1)
        self.create_subscription(Twist, goal, self.take_desired, 1)
        self.desired = Twist()
        self.count = self.driving = 0
        self.last = 0.0
        self.left = self.right = 0.0

    def take_desired(self, twist):
        self.desired = twist
        if FAULT == "sleeps":
            time.sleep(0.3)

    def take_odometry(self, odometry):
        self.count += 1
        if FAULT == "clock" and time.monotonic() - self.last < 0.06:
            return
        self.last = time.monotonic()
        if FAULT == "busy":
            time.sleep(0.5)
        while FAULT == "endless" and self.desired.linear.x:
            pass
        forward = self.desired.linear.x - odometry.twist.twist.linear.x
        turn = self.desired.angular.z - odometry.twist.twist.angular.z
        if FAULT == "raised" or (FAULT == "sometimes" and self.count % 20 == 7):
            self.desird
        if FAULT == "publish" or (FAULT == "seldom" and self.count % 50):
            return
        self.driving += self.desired.linear.x > 0
        if FAULT == "died" and self.driving > 20:
            raise SystemExit("no more efforts")
        forward = -forward if FAULT == "speed-sign" else forward
        turn = -turn if FAULT == "turn-sign" else turn
        self.left = max(-1.0, min(1.0, self.left + 0.1 * forward - 0.05 * turn))
        self.right = max(-1.0, min(1.0, self.right + 0.1 * forward + 0.05 * turn))
        message = JointState()
        message.name = ["l", "r"] if FAULT == "ignored" else []
        efforts = [self.left, self.right]
        if FAULT == "field":
            message.velocity = efforts
        else:
            message.effort = [0.0, 0.0] if FAULT == "zero" else efforts
        self.publisher.publish(message)


lcmtools.init()
node = Controller()
if FAULT == "twice":
    other = Controller()
if FAULT == "spin":
    time.sleep(1000)
lcmtools.spin(node)
