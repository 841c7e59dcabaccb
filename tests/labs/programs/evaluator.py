# lab check husky --evaluator
# expects: mean | average_error remembers | it is the mean of the errors, and should be the root
# expects: y | last_error | it is always 0
# expects: ignores | last_error of a moving robot | it is the length of the desired velocity
# expects: exchanged | last_error of a moving robot | made with linear.x and angular.z exchanged
# expects: reset | samples | it starts again: go on counting when another desired velocity
# expects: both | samples | count in the odometry callback, and only there
# expects: slash | publishes | it begins with /, so __ns:=/husky0 does not apply: write 'odometry
# expects: late | samples | count a sample before you publish it

import math, sys
import lcmtools
from lcmtools import Node
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

FAULT = sys.argv[1]


class Evaluator(Node):
    def __init__(self):
        super().__init__("evaluate_controller")
        source = "/odometry" if FAULT == "slash" else "odometry"
        self.publisher = self.create_publisher(ControllerEvaluationStat, "evaluation_stat")
        self.create_subscription(Odometry, source, self.take_odometry, 100)
        self.create_subscription(Twist, "desired_velocity", self.take_desired, 1)
        self.desired, self.errors, self.count = None, [], 0

    def take_desired(self, twist):
        self.desired = twist
        if FAULT == "reset":
            self.errors, self.count = [], 0
        self.count += FAULT == "both"

    def take_odometry(self, odometry):
        if self.desired is None:
            return
        has, want = odometry.twist.twist, self.desired
        v, w = has.linear.x - want.linear.x, has.angular.z - want.angular.z
        error = {
            "square": v * v + w * w,
            "linear": abs(v),
            "angular": abs(w),
            "y": abs(has.linear.y - want.linear.y),
            "manhattan": abs(v) + abs(w),
            "ignores": math.hypot(want.linear.x, want.angular.z),
            "exchanged": math.hypot(
                has.linear.x - want.angular.z, has.angular.z - want.linear.x
            ),
        }.get(FAULT, math.hypot(v, w))
        self.errors.append(error)
        self.count += FAULT != "late"
        size, squares = len(self.errors), sum(e * e for e in self.errors)
        message = ControllerEvaluationStat()
        message.samples, message.last_error = self.count, error
        message.average_error = {
            "mean": sum(self.errors) / size,
            "mean-square": squares / size,
            "sum": squares,
            "root-sum": math.sqrt(squares),
            "minus-1": math.sqrt(squares / max(1, size - 1)),
            "last": error,
        }.get(FAULT, math.sqrt(squares / size))
        self.count += FAULT == "late"
        self.publisher.publish(message)


lcmtools.init()
lcmtools.spin(Evaluator())
