"""An inertial measurement unit: orientation, angular velocity and proper acceleration."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import Imu
from lcmtools_sim.rotation import (
    Vector,
    add,
    axes,
    components,
    cross,
    multiply,
    scaled,
    upwards,
)
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState
from lcmtools_sim.sensors.settings import deviation


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
        self._lever = mount.pose.position
        self._rotation = mount.pose.rotation
        self._axes = axes(mount.pose.rotation)
        self._gravity = carrier.gravity
        self._settings = cast("ImuSettings", mount.settings or ImuSettings())
        self._generator = carrier.generator(mount)
        frame = carrier.put_frame(mount, "imu_link", mount.pose.rotation)
        self._fill = _template(frame, self._settings).fill

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The measurement of one step."""
        del wanted
        rotation = multiply(state.rotation, self._rotation)
        angular_velocity = components(state.angular_velocity, self._axes)
        felt = components(self._felt(state), self._axes)
        angular_velocity = self._disturbed(angular_velocity, self._settings.turning_noise)
        felt = self._disturbed(felt, self._settings.acceleration_noise)
        return {"": self._fill(state.stamp, rotation, angular_velocity, felt)}

    def _felt(self, state: RobotState) -> Vector:
        """The proper acceleration where the sensor is, in base_link [m/s^2].

        That of base_link, of a lever that turns (Euler and centripetal), and what holds it up.
        """
        lever = self._lever
        angular_velocity = add(
            cross(state.angular_acceleration, lever),
            cross(state.angular_velocity, cross(state.angular_velocity, lever)),
        )
        held = scaled(upwards(state.rotation), self._gravity)
        return add(add(state.acceleration, angular_velocity), held)

    def _disturbed(self, vector: Vector, noise: float) -> Vector:
        if not noise:
            return vector
        x, y, z = self._generator.normal(vector, noise).tolist()
        return x, y, z


def _template(frame: str, settings: ImuSettings) -> PayloadTemplate:
    """The message but for its time and what is measured."""
    message = Imu()
    message.header.frame_id = frame
    message.angular_velocity_covariance = _covariance(settings.turning_noise)
    message.linear_acceleration_covariance = _covariance(settings.acceleration_noise)
    measured = "orientation", "angular_velocity", "linear_acceleration"
    return PayloadTemplate(message, "header.stamp", *measured)


def _covariance(noise: float) -> tuple[float, ...]:
    """Row-major 3x3, with the variance of the noise on its diagonal."""
    return tuple(noise**2 if i % 4 == 0 else 0.0 for i in range(9))
