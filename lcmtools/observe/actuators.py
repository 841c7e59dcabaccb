"""Topics whose messages move a robot.

A command is recognized by its type (a velocity, an effort, a trajectory) or by its topic's name
(cmd_vel, WHEEL_COMMAND, goal). A simulator obeys what it subscribes to: see ``simulators``.
"""

import re
from collections.abc import Iterator

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.names import namespace_of

JOINTS = "sensor_msgs/JointState"
_ODOMETRY = "nav_msgs/Odometry"
VELOCITY_TYPES = frozenset(
    f"geometry_msgs/{name}{suffix}"
    for name in ("Twist", "Accel", "Wrench")
    for suffix in ("", "Stamped")
)
"""Types of velocities and efforts: in these, zeros mean stop."""
_COMMAND_TYPES = VELOCITY_TYPES | {
    "trajectory_msgs/JointTrajectory",
    "trajectory_msgs/MultiDOFJointTrajectory",
}
_WORDS = re.compile(
    r"cmd|commands?|control|setpoints?|goal|target|efforts?|torque|throttle|steering|actuators?"
    r"|motors?",
    re.IGNORECASE,
)
_SPLIT = re.compile(r"[^A-Za-z]+|(?<=[a-z])(?=[A-Z])")


def is_command_topic(topic: str, type_name: str) -> bool:
    """Return whether a topic's type or name says that its messages are commands."""
    words = _SPLIT.split(topic.rpartition("/")[2])
    return type_name in _COMMAND_TYPES or any(map(_WORDS.fullmatch, words))


def unattended_commands(graph: Graph) -> Iterator[tuple[NodeInfo, Endpoint, str]]:
    """Yield robots whose last velocity or effort came from a node or program that has ended.

    Each with the subscription that it came on, and the topic of the robot's odometry.
    """
    for node in (one for one in graph.nodes if not (one.stale or one.tool)):
        for odometry in (one for one in node.having(Role.PUBLISHER) if one.type == _ODOMETRY):
            space = namespace_of(odometry.topic)
            ends = [one for one in node.having(Role.SUBSCRIBER) if namespace_of(one.topic) == space]
            heard = [one for one in ends if one.messages and one.type in {JOINTS, *VELOCITY_TYPES}]
            last = max(heard, key=lambda one: one.last_time, default=None)
            if last and all(one.stale for one, _ in graph.topic(last.topic).publishers):
                yield node, last, odometry.topic
