"""Publish "hello world" ten times a second: the first publisher.

Publishes:
    chatter   std_msgs/String   "hello world N", with N counting from 0, at 10 Hz

Example:
    lcmtools run talker
    lcmtools run talker chatter:=/news
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.std_msgs import String

PERIOD = 0.1  # seconds between two messages


class Talker(Node):
    """Publishes a text with a number that counts up."""

    def __init__(self) -> None:
        super().__init__("talker")
        self._chatter = self.create_publisher(String, "chatter")
        self._count = 0
        self.create_timer(PERIOD, self._talk)

    def _talk(self) -> None:
        message = String()
        message.data = f"hello world {self._count}"
        self.get_logger().info(message.data)
        self._chatter.publish(message)
        self._count += 1


def main(args: Sequence[str] | None = None) -> None:
    """Talk until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(Talker())
        lcmtools.shutdown()
