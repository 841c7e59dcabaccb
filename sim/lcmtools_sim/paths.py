"""A world's paths on the bus, as nav_msgs/Path in the frame world."""

import math

from lcmtools import Node
from lcmtools.types.geometry_msgs import PoseStamped
from lcmtools.types.nav_msgs import Path
from lcmtools_sim.scene import MarkedPath

_PERIOD = 0.1  # [s]; the longest delay for a new subscriber
_REPEAT = 10  # periods, for programs that announce no subscription


class PathPublisher:
    """Publishes a path to each new subscriber, as a latched topic of ROS does."""

    def __init__(self, node: Node, path: MarkedPath) -> None:
        self._node = node
        self._publisher = node.create_publisher(Path, path.topic)
        self._message = path_message(path)
        self._subscribers: frozenset[str] = frozenset()
        self._count = 0
        node.create_timer(_PERIOD, self._publish_if_due)

    def _publish_if_due(self) -> None:
        self._count += 1
        topic = self._node.graph().topic(self._publisher.topic)
        subscribers = frozenset(node.id for node, _ in topic.subscribers)
        is_time = self._count % _REPEAT == 0 and self._node.has_plain_listeners()
        if is_time or subscribers - self._subscribers:
            self._publisher.publish(self._message)
        self._subscribers = subscribers


def path_message(path: MarkedPath) -> Path:
    """The message of a path; each pose looks along the path, and no time is given."""
    message, points = Path(), path.line.points
    message.header.frame_id = "world"
    for index, (x, y) in enumerate(points):
        (x0, y0), (x1, y1) = points[max(0, index - 1)], points[min(index + 1, len(points) - 1)]
        heading = math.atan2(y1 - y0, x1 - x0)
        pose = PoseStamped()
        pose.header.frame_id = "world"
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = (
            math.sin(heading / 2),
            math.cos(heading / 2),
        )
        message.poses.append(pose)
    return message
