"""Sensors of the robot's own motion: wheels, odometry, frames, inertial unit and ground truth."""

from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import Imu, JointState
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.arithmetic import arithmetic_of
from lcmtools_sim.geometry import (
    IDENTITY,
    Frame,
    Vector,
    add,
    axes,
    components,
    cross,
    from_euler,
    multiply,
    scaled,
    upwards,
)
from lcmtools_sim.sensors.payloads import Payloads, Row
from lcmtools_sim.sensors.sensor import (
    BatchSensor,
    Deviation,
    MeasureBatch,
    RobotState,
    SensorContext,
    SensorMount,
    Settings,
    transform_message,
)

if TYPE_CHECKING:
    from typing_extensions import Self

_DIAGONAL = (0.001, 0.001, 0.001, 0.001, 0.001, 0.03)  # as in Clearpath's husky_control
COVARIANCE = tuple(_DIAGONAL[i // 6] if i % 7 == 0 else 0.0 for i in range(36))
"""Row-major 6x6 for pose and twist: x, y, z [m^2], then about x, y, z [rad^2]."""


class MotionSensor(BatchSensor):
    """A sensor whose messages are numbers in a template, computed only from a robot's state."""

    template: PayloadTemplate  # of its messages
    is_noisy: bool  # True if it draws its own random numbers for each sample

    @property
    def is_batchable(self) -> bool:
        """True unless it draws its own random numbers."""
        return not self.is_noisy

    @property
    @abstractmethod
    def outputs(self) -> Mapping[str, type[Message]]:
        """The type of its only output."""

    @abstractmethod
    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """The numbers for the template; arrays for a state with arrays, unless it is noisy."""

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the message of one step."""
        del wanted
        return {"": self.template.fill(*self.rows(state))}

    def batch(self, sensors: Sequence[tuple["Self", int]]) -> MeasureBatch:
        """Return the function that measures these sensors at once; see BatchSensor."""
        payloads = Payloads([(sensor.template, index) for sensor, index in sensors])
        return lambda state: payloads.fill(self.rows(state))


def _planar_pose(state: RobotState) -> tuple[float, ...]:
    """Return the odometry's pose as the seven numbers of a message: position and quaternion."""
    x, y, yaw = state.odometry_pose
    ops = arithmetic_of(yaw)
    return x, y, 0.0, 0.0, 0.0, ops.sin(yaw / 2), ops.cos(yaw / 2)


@dataclass(frozen=True, slots=True)
class WheelStatesSettings(Settings):
    """Standard deviations of white noise on each side: angle [rad] and speed [rad/s]."""

    angle_noise: Deviation = 0.0
    speed_noise: Deviation = 0.0


class WheelStatesSensor(MotionSensor):
    """sensor_msgs/JointState with two joints: left at index 0, right at index 1."""

    outputs: Mapping[str, type[Message]] = {"": JointState}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        self._settings = cast("WheelStatesSettings", mount.settings or WheelStatesSettings())
        self._noise = context.noise(mount)
        message = JointState()
        message.header.frame_id = context.frame("base_link")
        message.name = ["left", "right"]
        message.position = message.velocity = message.effort = [0.0, 0.0]
        holes = "header.stamp", "position", "velocity", "effort"
        self.template = PayloadTemplate(message, *holes)
        self.is_noisy = bool(self._settings.angle_noise or self._settings.speed_noise)

    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """Stamp, angles, speeds and efforts."""
        settings, noise, time = self._settings, self._noise, state.time
        angles = noise.added_to(state.wheel_angles, settings.angle_noise, time)
        speeds = noise.added_to(state.wheel_speeds, settings.speed_noise, time, stream=1)
        return state.stamp, angles, speeds, state.efforts


@dataclass(frozen=True, slots=True)
class OdometrySettings(Settings):
    """The errors of odometry."""

    # Standard deviation of each side's measured distance after 1 m [m]; it grows with the square
    # root of the distance (K. Chong, L. Kleeman, Accurate Odometry and Error Modelling for a Mobile
    # Robot, ICRA 1997). The pose and odom in /tf drift by it.
    travel_noise: Deviation = 0.0
    speed_noise: Deviation = 0.0  # standard deviation of the twist's forward speed [m/s]
    turning_noise: Deviation = 0.0  # standard deviation of the twist's turn rate [rad/s]

    @property
    def encoder_noise(self) -> float:
        """The noise of the travel."""
        return self.travel_noise


class OdometrySensor(MotionSensor):
    """nav_msgs/Odometry: the pose of base_link in odom, the twist in base_link (REP-105).

    It drifts from the truth when the wheels slip.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        settings = cast("OdometrySettings", mount.settings or OdometrySettings())
        self._deviations = settings.speed_noise, settings.turning_noise
        self._noise = context.noise(mount)
        message = Odometry()
        message.header.frame_id = context.frame("odom")
        message.child_frame_id = context.frame("base_link")
        message.pose.covariance = message.twist.covariance = COVARIANCE
        numbers = "pose.pose", "twist.twist.linear.x", "twist.twist.angular.z"
        self.template = PayloadTemplate(message, "header.stamp", *numbers)
        self.is_noisy = any(self._deviations)

    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """Stamp, pose, forward speed and turn rate."""
        forward, turn_rate = state.odometry_speed
        if self.is_noisy:
            random = self._noise.at(state.time)
            forward, turn_rate = random.normal((forward, turn_rate), self._deviations).tolist()
        return state.stamp, _planar_pose(state), (forward,), (turn_rate,)


class TransformsSensor(MotionSensor):
    """tf2_msgs/TFMessage with odom to base_link, and base_link to each sensor (REP-105).

    It publishes the frames of the sensors that were made before (see SensorKind.needs_frames).
    """

    outputs: Mapping[str, type[Message]] = {"": TFMessage}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        del mount  # it measures the whole robot
        self.is_noisy = False
        message = TFMessage()
        base = context.frame("base_link")
        message.transforms = [
            transform_message(context.frame("odom"), base, Frame()),
            *(transform_message(base, name, frame) for name, frame in context.frames.items()),
        ]
        self._count = len(message.transforms)
        stamps = (f"transforms[{index}].header.stamp" for index in range(self._count))
        self.template = PayloadTemplate(message, "transforms[0].transform", *stamps)

    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """The pose by odometry, and a stamp for each transform."""
        return _planar_pose(state), *[state.stamp] * self._count


@dataclass(frozen=True, slots=True)
class ImuSettings(Settings):
    """Standard deviations of white noise on each axis."""

    turning_noise: Deviation = 0.0  # of the angular velocity [rad/s]
    acceleration_noise: Deviation = 0.0  # [m/s^2]


class ImuSensor(MotionSensor):
    """sensor_msgs/Imu by REP-145: at rest it measures +g along the axis that points up.

    The orientation is the true one in the world; the other covariances are the noise's,
    and all zero (unknown) without noise.
    """

    outputs: Mapping[str, type[Message]] = {"": Imu}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        self._lever, self._rotation = mount.pose.position, mount.pose.rotation
        self._axes = axes(mount.pose.rotation)
        self._gravity = context.gravity
        self._settings = settings = cast("ImuSettings", mount.settings or ImuSettings())
        self._noise = context.noise(mount)
        message = Imu()
        message.header.frame_id = context.add_frame(mount, "imu_link", mount.pose.rotation)
        message.angular_velocity_covariance = _covariance(settings.turning_noise)
        message.linear_acceleration_covariance = _covariance(settings.acceleration_noise)
        measured = "orientation", "angular_velocity", "linear_acceleration"
        self.template = PayloadTemplate(message, "header.stamp", *measured)
        self.is_noisy = bool(settings.turning_noise or settings.acceleration_noise)

    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """Stamp, orientation, angular velocity and acceleration."""
        settings, noise, time = self._settings, self._noise, state.time
        rotation, turning = state.rotation, state.angular_velocity
        acceleration = self._proper_acceleration(state)
        if self._rotation != IDENTITY:
            rotation = multiply(rotation, self._rotation)
            turning = components(turning, self._axes)
            acceleration = components(acceleration, self._axes)
        return (
            state.stamp,
            rotation,
            noise.added_to(turning, settings.turning_noise, time),
            noise.added_to(acceleration, settings.acceleration_noise, time, stream=1),
        )

    def _proper_acceleration(self, state: RobotState) -> Vector:
        """Return the proper acceleration of the sensor, in base_link [m/s^2].

        It is base_link's, plus the rotating lever's (Euler and centripetal), minus gravity.
        """
        lever = self._lever
        of_lever = add(
            cross(state.angular_acceleration, lever),
            cross(state.angular_velocity, cross(state.angular_velocity, lever)),
        )
        reaction = scaled(upwards(state.rotation), self._gravity)
        return add(add(state.acceleration, of_lever), reaction)


def _covariance(noise: float) -> tuple[float, ...]:
    """Return a row-major 3x3 with the variance of the noise on its diagonal."""
    return tuple(noise**2 if i % 4 == 0 else 0.0 for i in range(9))


@dataclass(frozen=True, slots=True)
class GroundTruthSettings(Settings):
    """Standard deviations of white noise, as of a motion capture system."""

    position_noise: Deviation = 0.0  # of x, y and z [m]
    heading_noise: Deviation = 0.0  # of the yaw angle [rad]


class GroundTruthSensor(MotionSensor):
    """nav_msgs/Odometry: the true pose of base_link in world, the twist in base_link.

    The covariance is that of the noise.
    """

    outputs: Mapping[str, type[Message]] = {"": Odometry}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        settings = cast("GroundTruthSettings", mount.settings or GroundTruthSettings())
        self._settings = settings
        self._noise = context.noise(mount)
        place, turn = settings.position_noise**2, settings.heading_noise**2
        message = Odometry()
        message.header.frame_id = "world"
        message.child_frame_id = context.frame("base_link")
        message.pose.covariance = [0.0] * 36
        message.pose.covariance[::7] = place, place, place, 0.0, 0.0, turn
        pose = "pose.pose.position", "pose.pose.orientation"
        twist = "twist.twist.linear", "twist.twist.angular"
        self.template = PayloadTemplate(message, "header.stamp", *pose, *twist)
        self.is_noisy = bool(settings.position_noise or settings.heading_noise)

    def rows(self, state: RobotState) -> tuple[Row, ...]:
        """Stamp, pose and twist."""
        place, turn, settings = state.position, state.rotation, self._settings
        if self.is_noisy:  # moved, and turned about the vertical axis
            x, y, z, yaw = self._noise.at(state.time).normal(size=4).tolist()
            place = add(place, scaled((x, y, z), settings.position_noise))
            turn = multiply(from_euler(0.0, 0.0, yaw * settings.heading_noise), turn)
        return state.stamp, place, turn, state.velocity, state.angular_velocity
