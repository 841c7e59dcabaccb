"""Odometry from the wheels' encoders: drifts from the truth when the wheels slip."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState
from lcmtools_sim.sensors.settings import deviation

_DIAGONAL = (0.001, 0.001, 0.001, 0.001, 0.001, 0.03)  # as Clearpath's husky_control says
COVARIANCE = tuple(_DIAGONAL[i // 6] if i % 7 == 0 else 0.0 for i in range(36))
"""Row-major 6x6 for pose and twist: x, y, z [m^2], then about x, y, z [rad^2]."""


@dataclass(frozen=True, slots=True)
class OdometrySettings(Settings):
    """How good the encoders are.

    Attributes:
        travel_noise: Standard deviation of each side's measured way after 1 m [m]; it grows with
            the root of the way (K. Chong, L. Kleeman, Accurate Odometry and Error Modelling for a
            Mobile Robot, ICRA 1997). The pose drifts by it, and with the pose odom in /tf.
        speed_noise: Standard deviation of the twist's forward speed [m/s].
        turning_noise: Standard deviation of the twist's turn rate [rad/s].
    """

    travel_noise: float = deviation()
    speed_noise: float = deviation()
    turning_noise: float = deviation()


class OdometrySensor:
    """nav_msgs/Odometry: the pose of base_link in odom, the twist in base_link (REP-105).

    Args:
        mount: Where it publishes, and its settings.
        carrier: The robot, whose namespace prefixes the frames.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        settings = cast("OdometrySettings", mount.settings or OdometrySettings())
        self._noise = settings.speed_noise, settings.turning_noise
        self._generator = carrier.generator(mount)
        self._fill = _template(carrier).fill

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The message of one step."""
        del wanted
        x, y, yaw = state.reckoned_pose
        place = x, y, 0.0, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)
        forward, turn_rate = self._disturbed(state.reckoned_speed)
        return {"": self._fill(state.stamp, place, (forward,), (turn_rate,))}

    def _disturbed(self, speed: tuple[float, float]) -> tuple[float, float]:
        if not any(self._noise):
            return speed
        forward, turn_rate = self._generator.normal(speed, self._noise).tolist()
        return forward, turn_rate


def _template(carrier: Carrier) -> PayloadTemplate:
    """A robot's odometry but for its time, pose, forward speed and turn rate."""
    message = Odometry()
    message.header.frame_id = carrier.frame("odom")
    message.child_frame_id = carrier.frame("base_link")
    message.pose.covariance = message.twist.covariance = COVARIANCE
    numbers = "pose.pose", "twist.twist.linear.x", "twist.twist.angular.z"
    return PayloadTemplate(message, "header.stamp", *numbers)
