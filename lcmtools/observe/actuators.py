"""Topics whose messages move a robot.

A command is recognized by its type (a velocity, an effort, a trajectory) or by its topic's name
(cmd_vel, WHEEL_COMMAND, goal). A simulator obeys what it subscribes to: see ``simulators``.
"""

import re

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
