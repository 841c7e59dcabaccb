"""The truth that no real robot knows: where the engine has it."""

from collections.abc import Collection, Mapping

from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header, fill_quaternion


class GroundTruthSensor:
    """nav_msgs/Odometry: the pose of base_link in world, the twist in base_link, no covariance.

    Args:
        mount: Where it publishes.
        carrier: The robot, whose namespace prefixes the child frame.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        del mount  # it measures the whole robot, which is one thing to set
        self._child_frame = carrier.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The message of one step."""
        del wanted
        message = Odometry()
        fill_header(message.header, state.time, "world")
        message.child_frame_id = self._child_frame
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y, pose.position.z = state.position
        fill_quaternion(pose.orientation, state.rotation)
        twist.linear.x, twist.linear.y, twist.linear.z = state.velocity
        twist.angular.x, twist.angular.y, twist.angular.z = state.turning
        return {"": message}
