"""What every sensor is given and what it gives back.

A sensor turns the state of one robot after one step, and what it sees around it, into messages,
encoded as they go out: what is measured often fills a stencil instead of making a message anew.
It knows no bus, no engine and no schedule; one sensor, one file.
"""

import zlib
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from lcmtools.clock import split_stamp
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Quaternion as QuaternionMessage
from lcmtools.types.std_msgs import Header
from lcmtools_sim.pose import Pose
from lcmtools_sim.rotation import Quaternion, Vector, add, multiply, turn
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.shapes import Color, Part


class Sides(NamedTuple):
    """A number for the left and one for the right wheels."""

    left: float
    right: float


class RobotState(NamedTuple):
    """A robot after a step, as its sensors may measure it. A tuple, for many are made.

    Attributes:
        time: Simulated nanoseconds since the start.
        stamp: The same, as messages have it: seconds and nanoseconds.
        position: Of base_link in the world [m].
        rotation: Of base_link in the world.
        velocity: Of base_link, in its own frame [m/s].
        angular_velocity: Angular velocity in its own frame [rad/s].
        acceleration: Of base_link, in its own frame, gravity not counted [m/s^2].
        angular_acceleration: Angular acceleration in its own frame [rad/s^2].
        wheel_angles: Since the start [rad].
        wheel_speeds: [rad/s]
        efforts: What the motors are told to, as fractions of their full power.
        reckoned_pose: x, y [m] and yaw [rad] by the wheels' encoders, where it started as origin.
        reckoned_speed: Forward speed [m/s] and turn rate [rad/s] by the wheels' encoders.
    """

    time: int
    stamp: tuple[int, int]
    position: Vector
    rotation: Quaternion
    velocity: Vector
    angular_velocity: Vector
    acceleration: Vector
    angular_acceleration: Vector
    wheel_angles: Sides
    wheel_speeds: Sides
    efforts: Sides
    reckoned_pose: tuple[float, float, float]
    reckoned_speed: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Contact:
    """A place where a robot touches something.

    Attributes:
        name: What it touches.
        position: In the world [m].
        normal: Towards the robot, in the world.
        force: Along the normal [N].
        depth: How deep the two stand in each other [m]; negative for a gap.
    """

    name: str
    position: Vector
    normal: Vector
    force: float
    depth: float


class Surroundings(Protocol):
    """What a robot's sensors may see of the world around it; see lcmtools_sim.world."""

    def fixed_parts(self) -> tuple[Part, ...]:
        """The shapes that stand for ever, in the world; equal (by identity) until one changes."""
        ...

    def moving_parts(self) -> list[Part]:
        """The shapes that can move, in the world now, but for the robot's own."""
        ...

    def moving_bodies(self) -> list[tuple[tuple[Part, ...], Vector, Quaternion]]:
        """The bodies that can move, but for the robot's own: their shapes in a frame, and its pose.

        The shapes of a body are the same object as long as it is there.
        """
        ...

    def ground_color(self) -> Color:
        """How the plane z = 0 looks."""
        ...

    def touching(self) -> list[Contact]:
        """Where the robot touches something that is not the ground."""
        ...


@dataclass(frozen=True, slots=True)
class Carrier:
    """The robot that carries a sensor, as far as sensors need to know it.

    Attributes:
        namespace: The robot's, which prefixes frames and topics.
        parts: Its body's shapes, in base_link.
        gravity: [m/s^2]
        seed: The world's.
        around: What can be seen.
        frames: Of the sensors mounted so far: where each is in base_link, by its prefixed name.
    """

    namespace: str
    parts: tuple[Part, ...]
    gravity: float
    seed: int
    around: Surroundings
    frames: dict[str, tuple[Vector, Quaternion]] = field(default_factory=dict)

    def frame(self, name: str) -> str:
        """A frame's id with the robot's prefix and no slash before ("husky0/odom")."""
        return f"{self.namespace}/{name}".lstrip("/")

    def put_frame(self, mount: SensorMount, usual: str, rotation: Quaternion) -> str:
        """Note where a sensor's frame is; return its id.

        A frame can be at one place only: where another sensor has the usual name, the topic goes
        before it.

        Args:
            mount: Of the sensor.
            usual: The frame's name, where the mount has none.
            rotation: Of the frame in base_link.
        """
        place = mount.pose.position, rotation
        name = self.frame(mount.frame or usual)
        if not mount.frame and self.frames.get(name, place) != place:
            name = self.frame(f"{mount.topic.strip('/').replace('/', '_')}_{usual}")
        self.frames[name] = place
        return name

    def generator(self, mount: SensorMount) -> np.random.Generator:
        """The noise of one sensor: of its own, the same in each run with the same seed."""
        return generator(self.seed, f"{self.namespace}/{mount.kind}/{mount.topic}")


class Sensor(Protocol):
    """Measures for one robot."""

    @property
    def outputs(self) -> Mapping[str, type[Message]]:
        """What it publishes: a type for each name behind the mount's topic ("" for that itself)."""
        ...

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The payloads of one step, of those outputs that are wanted."""
        ...


@dataclass(frozen=True, slots=True)
class SensorKind:
    """A kind of sensor, as robot models and world files may mount it.

    Attributes:
        make: Makes one for a mount on a robot.
        settings: The class of its settings; None where there is nothing to set.
        rate: [Hz] Where a world file does not say it.
        topic: Where a world file does not say it.
        bulky: Outputs that are too large to be sent where nobody is known to listen.
    """

    make: Callable[[SensorMount, Carrier], Sensor]
    settings: type[Settings] | None = None
    rate: float = 50.0
    topic: str = ""
    bulky: frozenset[str] = frozenset()


def generator(seed: int, name: str) -> np.random.Generator:
    """The noise of whatever has this name: of its own, the same in each run with the same seed."""
    return np.random.default_rng([seed, zlib.crc32(name.encode())])


def placed(state: RobotState, pose: Pose) -> tuple[Vector, Quaternion]:
    """Where a sensor with this pose in base_link is in the world."""
    position = add(state.position, turn(pose.position, state.rotation))
    return position, multiply(state.rotation, pose.rotation)


def fill_header(header: Header, time: int, frame_id: str) -> None:
    """Stamp a header with the step's time [ns] and its frame."""
    header.stamp.sec, header.stamp.nsec = split_stamp(time)
    header.frame_id = frame_id


def fill_quaternion(message: QuaternionMessage, rotation: Quaternion) -> None:
    """Copy a rotation into a message."""
    message.x, message.y, message.z, message.w = rotation
