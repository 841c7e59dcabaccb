"""What the wheels do: angle, speed and applied effort of both sides."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, Sides
from lcmtools_sim.sensors.settings import deviation


@dataclass(frozen=True, slots=True)
class WheelStatesSettings(Settings):
    """How good the encoders are; standard deviations of white noise on each side.

    Attributes:
        angle_noise: [rad]
        speed_noise: [rad/s]
    """

    angle_noise: float = deviation()
    speed_noise: float = deviation()


class WheelStatesSensor:
    """sensor_msgs/JointState with two joints: left at index 0, right at index 1.

    Args:
        mount: Where it publishes, and its settings.
        carrier: The robot, whose namespace prefixes the frame.
    """

    outputs: Mapping[str, type[Message]] = {"": JointState}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        self._settings = cast("WheelStatesSettings", mount.settings or WheelStatesSettings())
        self._generator = carrier.generator(mount)
        self._fill = _template(carrier).fill

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The message of one step."""
        del wanted
        angles = self._disturbed(state.wheel_angles, self._settings.angle_noise)
        speeds = self._disturbed(state.wheel_speeds, self._settings.speed_noise)
        return {"": self._fill(state.stamp, angles, speeds, state.efforts)}

    def _disturbed(self, values: Sides, noise: float) -> Sides:
        return Sides(*self._generator.normal(values, noise).tolist()) if noise else values


def _template(carrier: Carrier) -> PayloadTemplate:
    """The joints' message but for its time and all numbers."""
    message = JointState()
    message.header.frame_id = carrier.frame("base_link")
    message.name = ["left", "right"]
    message.position = message.velocity = message.effort = [0.0, 0.0]
    return PayloadTemplate(message, "header.stamp", "position", "velocity", "effort")
