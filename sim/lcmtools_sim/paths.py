"""A world's paths as nav_msgs/Path in the frame world."""

import math

from lcmtools.types.geometry_msgs import PoseStamped
from lcmtools.types.nav_msgs import Path
from lcmtools_sim.scene import MarkedPath


def path_message(path: MarkedPath) -> Path:
    """Return the message of a path; each pose points along the path; the time is left empty."""
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
