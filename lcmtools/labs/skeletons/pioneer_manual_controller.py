"""Drive the Pioneer by keys (skeleton).

Run it with   python pioneer_manual_controller.py   while the simulator runs:
lcmtools run sim --world pioneer

    u i o    forward left, forward, forward right     q / z   both speeds 10 % more / less
    j k l    turn left, stop, turn right              w / x   forward speed 10 % more / less
    m , .    backward: clockwise, straight,           e / c   turn rate 10 % more / less
             counter-clockwise
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.driving.keyboard import open_keyboard
from lcmtools.types.geometry_msgs import Twist


class PioneerManualController(Node):
    """Publishes the velocity that the keys set."""

    def __init__(self) -> None:
        super().__init__("pioneer_manual_controller")
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel")
        self.speed = 0.5  # [m/s], what the keys drive at
        self.turn = 1.0  # [rad/s], what the keys turn at
        self.cmdvel = Twist()  # what is published; all its fields are 0 at first

    def take_key(self, keyboard_input: str) -> None:
        """Apply a key, and publish the velocity."""
        # TODO 1: find out what keyboard_input is for each key, and take this line out again.
        self.get_logger().info(f"key {keyboard_input!r}, ASCII code {ord(keyboard_input[0])}")

        # TODO 2: for the keys i , j l u o m . and k, set self.cmdvel.linear.x [m/s] (negative is
        # backward) and self.cmdvel.angular.z [rad/s] (positive is to the left). The other fields
        # stay 0: the Pioneer cannot drive sideways, or fly. Which way does its nose turn when it
        # drives backward with "m"?

        # TODO 3: for the keys q z w x e c, change self.speed and self.turn by 10 %. The robot
        # should go on as it was, at the new speed.

        self.publisher.publish(self.cmdvel)

    def stop(self) -> None:
        """Stop the robot: it would go on with the last command."""
        self.publisher.publish(Twist())


def main(args: Sequence[str] | None = None) -> None:
    """Drive until Ctrl-C."""
    lcmtools.init(args)
    controller = PioneerManualController()
    try:
        with open_keyboard(controller.stop) as keyboard:
            while lcmtools.ok() and not keyboard.is_over:
                for key in keyboard.read(0.05):
                    controller.take_key(key)
                lcmtools.spin_once(controller)
    finally:
        controller.stop()
        lcmtools.shutdown()


if __name__ == "__main__":
    main()
