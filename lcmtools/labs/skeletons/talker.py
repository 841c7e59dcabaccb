"""Publish a text ten times a second (skeleton).

Run it with   python talker.py   and look at it with   lcmtools echo /chatter
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.std_msgs import String


class Talker(Node):
    """Publishes a text with a number that counts up."""

    def __init__(self) -> None:
        super().__init__("talker")
        self.count = 0
        # TODO 1: make a publisher of String on the topic chatter, and keep it:
        # self.publisher = self.create_publisher(TYPE, TOPIC)

        # TODO 2: have timer_callback called every 0.1 s: self.create_timer(SECONDS, FUNCTION)

    def timer_callback(self) -> None:
        """Publish one text."""
        message = String()
        # TODO 3: set message.data to "hello world" and the number self.count, log it with
        # self.get_logger().info(TEXT), and publish it with self.publisher.publish(message).
        del message  # remove this line
        self.count += 1


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    lcmtools.spin(Talker())
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
