"""Drive the Dolly in a circle (skeleton).

Run it with   python moving_robot.py   while the simulator runs: lcmtools run sim --world dolly
Look at it with   lcmtools hz /dolly/cmd_vel   and   lcmtools echo /dolly/odom
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist


class MovingRobot(Node):
    """Commands the same velocity again and again."""

    def __init__(self) -> None:
        super().__init__("moving_robot")
        # TODO 1: make a publisher of Twist on the topic /dolly/cmd_vel, with a queue of 10, and
        # keep it: self.publisher = self.create_publisher(TYPE, TOPIC, QUEUE)

        # TODO 2: have timer_callback called every 500 ms: self.create_timer(SECONDS, FUNCTION)

    def timer_callback(self) -> None:
        """Publish one command."""
        message = Twist()
        # TODO 3: set the forward speed message.linear.x to 0.5 m/s and the turn rate
        # message.angular.z to 0.3 rad/s; what you do not set is 0.

        # TODO 4: log what you publish, with self.get_logger().info(TEXT), and publish the message
        # with self.publisher.publish(message).
        del message  # remove this line


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    lcmtools.spin(MovingRobot())
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
