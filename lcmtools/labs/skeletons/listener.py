"""Log the texts of the talker (skeleton).

Run it with   python listener.py   beside a talker: lcmtools run talker
Without one, publish a text yourself: lcmtools pub -1 /chatter std_msgs/String hello
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.std_msgs import String


class Listener(Node):
    """Logs the texts that it receives."""

    def __init__(self) -> None:
        super().__init__("listener")
        # TODO 1: subscribe to String on the topic chatter, so that chatter_callback is called with
        # each message: self.create_subscription(TYPE, TOPIC, FUNCTION)

    def chatter_callback(self, message: String) -> None:
        """Log one text."""
        # TODO 2: log message.data with self.get_logger().info(TEXT).
        del message  # remove this line


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    lcmtools.spin(Listener())
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
