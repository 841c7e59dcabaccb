"""Odometry from the wheels' encoders: drifts from the truth when the wheels slip."""

import math
from collections.abc import Collection, Mapping

from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header

_DIAGONAL = (0.001, 0.001, 0.001, 0.001, 0.001, 0.03)  # as Clearpath's husky_control says
COVARIANCE = tuple(_DIAGONAL[i // 6] if i % 7 == 0 else 0.0 for i in range(36))
"""Row-major 6x6 for pose and twist: x, y, z [m^2], then about x, y, z [rad^2]."""


class OdometrySensor:
    """nav_msgs/Odometry: the pose of base_link in odom, the twist in base_link (REP-105).

    Args:
        mount: Where it publishes.
        carrier: The robot, whose namespace prefixes the frames.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        del mount  # it measures the whole robot, which is one thing to set
        self._frame = carrier.frame("odom")
        self._child_frame = carrier.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The message of one step."""
        del wanted
        message = Odometry()
        fill_header(message.header, state.time, self._frame)
        message.child_frame_id = self._child_frame
        x, y, yaw = state.reckoned_pose
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        twist.linear.x, twist.angular.z = state.reckoned_speed
        message.pose.covariance = message.twist.covariance = COVARIANCE
        return {"": message}
