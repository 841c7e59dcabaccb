"""What the wheels do: angle, speed and applied effort of both sides."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header
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
        self._frame = carrier.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The message of one step."""
        del wanted
        message = JointState()
        fill_header(message.header, state.time, self._frame)
        message.name = ["left", "right"]
        noise = self._settings
        angles, speeds = zip(*((wheel.angle, wheel.speed) for wheel in state.wheels), strict=True)
        message.position = self._disturbed(angles, noise.angle_noise)
        message.velocity = self._disturbed(speeds, noise.speed_noise)
        message.effort = [wheel.effort for wheel in state.wheels]
        return {"": message}

    def _disturbed(self, values: tuple[float, ...], noise: float) -> list[float]:
        return self._generator.normal(values, noise).tolist() if noise else list(values)
