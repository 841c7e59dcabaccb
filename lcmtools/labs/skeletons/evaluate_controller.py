"""Measure how well a controller keeps the desired velocity (skeleton).

python evaluate_controller.py __ns:=/husky0
lcmtools echo /husky0/evaluation_stat
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry


class EvaluateController(Node):
    """Publishes the errors of a controller."""

    def __init__(self) -> None:
        super().__init__("evaluate_controller")
        self.desired: Twist | None = None  # none has come yet
        self.samples = 0
        # TODO 1: make a publisher of ControllerEvaluationStat on the topic evaluation_stat:
        # self.publisher = self.create_publisher(TYPE, TOPIC)
        # See its fields with   lcmtools msg show air_lab0/ControllerEvaluationStat

        # TODO 2: subscribe to Odometry on odometry and to Twist on desired_velocity:
        # self.create_subscription(TYPE, TOPIC, FUNCTION)

    def desired_velocity_callback(self, twist: Twist) -> None:
        """Take a new desired velocity."""
        # TODO 3: keep it for odometry_callback.
        del twist  # remove this line

    def odometry_callback(self, odometry: Odometry) -> None:
        """Add one sample, and publish the statistics so far."""
        if self.desired is None:
            return  # nothing to compare with yet
        # TODO 4: compute the error of this sample: the length of the difference of
        # (linear.x, angular.z) measured, in odometry.twist.twist, and desired.

        # TODO 5: count the sample, and compute the root of the mean of the squares of all errors
        # so far. You do not need to keep them all: their sum of squares is enough.
        self.samples += 1

        # TODO 6: fill in samples, last_error and average_error of a message, and publish it.
        message = ControllerEvaluationStat()
        del message, odometry  # remove this line


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    lcmtools.spin(EvaluateController())
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
