"""The truth that no real robot knows: where the engine has it."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.rotation import Vector, add, chain, from_euler
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header, fill_quaternion
from lcmtools_sim.sensors.settings import deviation


@dataclass(frozen=True, slots=True)
class GroundTruthSettings(Settings):
    """How good it is: exact, or like a motion capture system with white noise.

    Attributes:
        position_noise: Standard deviation of x, y and z [m].
        heading_noise: Standard deviation of the yaw angle [rad].
    """

    position_noise: float = deviation()
    heading_noise: float = deviation()


class GroundTruthSensor:
    """nav_msgs/Odometry: the pose of base_link in world, the twist in base_link.

    The covariance is that of the noise: zeros where there is none.

    Args:
        mount: Where it publishes, and its settings.
        carrier: The robot, whose namespace prefixes the child frame.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        self._settings = cast("GroundTruthSettings", mount.settings or GroundTruthSettings())
        self._generator = carrier.generator(mount)
        self._child_frame = carrier.frame("base_link")
        place, turned = self._settings.position_noise**2, self._settings.heading_noise**2
        self._covariance = [0.0] * 36
        self._covariance[::7] = place, place, place, 0.0, 0.0, turned

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The message of one step."""
        del wanted
        message = Odometry()
        fill_header(message.header, state.time, "world")
        message.child_frame_id = self._child_frame
        message.pose.covariance = self._covariance
        pose, twist = message.pose.pose, message.twist.twist
        error, turned = self._errors()
        pose.position.x, pose.position.y, pose.position.z = add(state.position, error)
        rotation = chain(from_euler(0.0, 0.0, turned), state.rotation) if turned else state.rotation
        fill_quaternion(pose.orientation, rotation)
        twist.linear.x, twist.linear.y, twist.linear.z = state.velocity
        twist.angular.x, twist.angular.y, twist.angular.z = state.turning
        return {"": message}

    def _errors(self) -> tuple[Vector, float]:
        """How far one measurement is off [m], and by what angle about the vertical [rad]."""
        settings = self._settings
        if not (settings.position_noise or settings.heading_noise):
            return (0.0, 0.0, 0.0), 0.0
        x, y, z, yaw = self._generator.normal(size=4).tolist()
        spread = settings.position_noise
        return (x * spread, y * spread, z * spread), yaw * settings.heading_noise
