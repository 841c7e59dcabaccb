"""An inertial measurement unit: orientation, angular velocity and proper acceleration."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.types.sensor_msgs import Imu
from lcmtools_sim.rotation import Vector, add, axes, components, cross, scaled
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header, fill_quaternion, placed
from lcmtools_sim.sensors.settings import deviation
from lcmtools_sim.vision.solids import Floats


@dataclass(frozen=True, slots=True)
class ImuSettings(Settings):
    """How good it is; standard deviations of white noise on each axis and measurement.

    Attributes:
        turning_noise: [rad/s]
        acceleration_noise: [m/s^2]
    """

    turning_noise: float = deviation()
    acceleration_noise: float = deviation()


class ImuSensor:
    """sensor_msgs/Imu by REP-145: at rest it measures +g along the axis that points up.

    The orientation is the true one in the world; the other covariances are those of the noise,
    and all zero (unknown) without noise.

    Args:
        mount: Where it is, and its settings.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {"": Imu}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        self._pose = mount.pose
        self._gravity = carrier.gravity
        self._settings = cast("ImuSettings", mount.settings or ImuSettings())
        self._generator = carrier.generator(mount)
        self._frame = carrier.put_frame(mount, "imu_link", mount.pose.rotation)

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The measurement of one step."""
        del wanted
        message = Imu()
        fill_header(message.header, state.time, self._frame)
        _, rotation = placed(state, self._pose)
        fill_quaternion(message.orientation, rotation)
        own = axes(self._pose.rotation)
        settings = self._settings
        turning = self._disturbed(components(state.turning, own), settings.turning_noise)
        felt = self._disturbed(components(self._felt(state), own), settings.acceleration_noise)
        _fill(message.angular_velocity, turning)
        _fill(message.linear_acceleration, felt)
        message.angular_velocity_covariance = _covariance(settings.turning_noise)
        message.linear_acceleration_covariance = _covariance(settings.acceleration_noise)
        return {"": message}

    def _felt(self, state: RobotState) -> Vector:
        """The proper acceleration where the sensor is, in base_link [m/s^2].

        That of base_link, of a lever that turns (Euler and centripetal), and what holds it up.
        """
        lever = self._pose.position
        turning = add(
            cross(state.turning_change, lever), cross(state.turning, cross(state.turning, lever))
        )
        up = tuple(axis[2] for axis in axes(state.rotation))
        held = scaled(cast("Vector", up), self._gravity)
        return add(add(state.acceleration, turning), held)

    def _disturbed(self, vector: Vector, noise: float) -> Floats:
        exact = np.array(vector)
        return exact + self._generator.normal(0.0, noise, 3) if noise else exact


def _fill(message: Vector3, vector: Floats) -> None:
    message.x, message.y, message.z = vector.tolist()


def _covariance(noise: float) -> tuple[float, ...]:
    """Row-major 3x3, with the variance of the noise on its diagonal."""
    return tuple(noise**2 if i % 4 == 0 else 0.0 for i in range(9))
