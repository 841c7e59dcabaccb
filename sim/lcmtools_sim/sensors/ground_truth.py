"""The truth that no real robot knows: where the engine has it."""

from typing import ClassVar

from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.sensors.sensor import RobotState, fill_header, fill_quaternion, frame


class GroundTruthSensor:
    """nav_msgs/Odometry: the pose of base_link in world, the twist in base_link, no covariance.

    Args:
        namespace: The robot's, which prefixes the child frame.
    """

    message_type: ClassVar[type[Message]] = Odometry

    def __init__(self, namespace: str) -> None:
        self._child_frame = frame(namespace, "base_link")

    def sample(self, state: RobotState) -> Odometry:
        """The message of one step."""
        message = Odometry()
        fill_header(message.header, state.time, "world")
        message.child_frame_id = self._child_frame
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y, pose.position.z = state.position
        fill_quaternion(pose.orientation, state.rotation)
        twist.linear.x, twist.linear.y, twist.linear.z = state.velocity
        twist.angular.x, twist.angular.y, twist.angular.z = state.turning
        return message
