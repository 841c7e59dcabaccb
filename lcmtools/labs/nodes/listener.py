"""Log the texts of the talker: the first subscriber.

Subscribes:
    chatter   std_msgs/String   each text is logged

Example:
    lcmtools run listener
    lcmtools run listener chatter:=/news
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.std_msgs import String


class Listener(Node):
    """Logs the texts that it receives."""

    def __init__(self) -> None:
        super().__init__("listener")
        self.create_subscription(String, "chatter", self._callback)

    def _callback(self, message: String) -> None:
        self.get_logger().info(f"I heard: [{message.data}]")


def main(args: Sequence[str] | None = None) -> None:
    """Listen until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(Listener())
        lcmtools.shutdown()
