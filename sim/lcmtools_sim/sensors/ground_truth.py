"""The truth that no real robot knows: where the engine has it."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.rotation import Quaternion, Vector, add, from_euler, multiply, scaled
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState
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
        self._fill = _template(carrier, self._settings).fill

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The message of one step."""
        del wanted
        position, rotation = self._disturbed(state.position, state.rotation)
        return {
            "": self._fill(state.stamp, position, rotation, state.velocity, state.angular_velocity)
        }

    def _disturbed(self, position: Vector, rotation: Quaternion) -> tuple[Vector, Quaternion]:
        """A pose as it is measured: moved, and turned about the vertical."""
        settings = self._settings
        if not (settings.position_noise or settings.heading_noise):
            return position, rotation
        x, y, z, yaw = self._generator.normal(size=4).tolist()
        error = scaled((x, y, z), settings.position_noise)
        turned = from_euler(0.0, 0.0, yaw * settings.heading_noise)
        return add(position, error), multiply(turned, rotation)


def _template(carrier: Carrier, settings: GroundTruthSettings) -> PayloadTemplate:
    """A robot's truth but for its time, pose and twist."""
    place, turned = settings.position_noise**2, settings.heading_noise**2
    message = Odometry()
    message.header.frame_id = "world"
    message.child_frame_id = carrier.frame("base_link")
    message.pose.covariance = [0.0] * 36
    message.pose.covariance[::7] = place, place, place, 0.0, 0.0, turned
    pose, twist = ("pose.pose.position", "pose.pose.orientation"), ("linear", "angular")
    return PayloadTemplate(
        message, "header.stamp", *pose, *(f"twist.twist.{part}" for part in twist)
    )
