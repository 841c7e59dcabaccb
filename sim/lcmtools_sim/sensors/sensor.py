"""The interface of sensors: mounting, settings, input and output.

A sensor turns the state of one robot after a step, and its view of the world, into encoded
messages; frequent messages are filled templates instead of being encoded each time. Sensors know no
bus, engine or schedule.
"""

import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, NamedTuple, Protocol, TypeAlias

import numpy as np

from lcmtools.clock import split_stamp
from lcmtools.formats.typed import Within
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.std_msgs import Header
from lcmtools_sim.geometry import ORIGIN, Frame, Pose, Quaternion, Vector
from lcmtools_sim.shapes import Color, Line, Part
from lcmtools_sim.vision.solids import PlacedSolids, Solids

if TYPE_CHECKING:
    from typing_extensions import Self


@dataclass(frozen=True, slots=True)
class Settings:
    """Base of all sensors' settings: frozen dataclasses whose fields a world file may set.

    Bounds of numbers are annotations, as in lcmtools.formats.typed.
    """

    @property
    def encoder_noise(self) -> float:
        """Standard deviation of the distance that one side's encoder measures in 1 m [m].

        It grows with the square root of the distance. The encoders are the robot's: everything that
        is computed from them drifts.
        """
        return 0.0


Deviation: TypeAlias = Annotated[float, Within(0.0, 1e3)]
"""A setting: the standard deviation of noise, in the disturbed value's unit."""


@dataclass(frozen=True, slots=True)
class SensorMount:
    """A sensor on a robot."""

    kind: str  # a key of sensors.SENSORS
    # Its topic, or the prefix of its topics; relative to the robot's namespace, or absolute.
    topic: str
    rate: float  # [Hz], at most one measurement per step
    pose: Pose = ORIGIN  # of the sensor in base_link; unused by sensors of the whole robot
    frame: str = ""  # the name of its frame without the namespace; "" for the kind's usual one
    settings: Settings | None = None  # None for the kind's defaults
    always: bool = False  # measure even without subscribers


class Sides(NamedTuple):
    """Values of the left and the right wheels."""

    left: float
    right: float


class RobotState(NamedTuple):
    """The state of a robot after a step. A tuple, because many are created."""

    time: int  # simulated nanoseconds since the start
    stamp: tuple[int, int]  # the same as seconds and nanoseconds
    position: Vector  # of base_link in the world [m]
    rotation: Quaternion  # of base_link in the world
    velocity: Vector  # of base_link, in its own frame [m/s]
    angular_velocity: Vector  # in its own frame [rad/s]
    acceleration: Vector  # of base_link, in its own frame, without gravity [m/s^2]
    angular_acceleration: Vector  # in its own frame [rad/s^2]
    wheel_angles: Sides  # angles since the start [rad]
    wheel_speeds: Sides  # [rad/s]
    efforts: Sides  # the motors' commands, as fractions of full power
    odometry_pose: Vector  # x, y [m] and yaw [rad] from the wheels' encoders, relative to the start
    odometry_speed: tuple[float, float]  # forward [m/s] and turn rate [rad/s] from the encoders

    def sensor_frame(self, pose: Pose) -> Frame:
        """Return the frame in the world of a sensor with this pose in base_link."""
        return Frame(self.position, self.rotation).place(pose.frame)


@dataclass(frozen=True, slots=True)
class Contact:
    """A point where a robot touches something."""

    name: str  # of the other body
    position: Vector  # in the world [m]
    normal: Vector  # towards the robot, in the world
    force: float  # along the normal [N]
    depth: float  # penetration [m]; negative for a gap


class WorldView(Protocol):
    """The part of the world that sensors may see; see lcmtools_sim.world."""

    def fixed_parts(self) -> tuple[Part, ...]:
        """The immovable shapes, in the world; the same object until one is added."""

    def moving_parts(self, but: int) -> list[Part]:
        """Return the movable shapes except one body's, in the world."""

    def fixed_solids(self) -> Solids:
        """The immovable shapes as arrays; the same object until one is added."""

    def moving_bodies(self) -> Mapping[int, PlacedSolids]:
        """Return the movable bodies by their numbers.

        The shapes of a body are the same object as long as it exists.
        """

    def contacts(self, body: int) -> list[Contact]:
        """Return the contacts of a body with anything except the ground."""


class Noise:
    """The random numbers of a sensor's noise, from the world's seed, its name and sample times.

    They do not depend on earlier samples, and thus not on when a program began to subscribe.
    """

    def __init__(self, seed: int, name: str) -> None:
        # Philox (J. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, 2011) can start at
        # any position; a new generator for each sample would take ten times as long.
        self._bits = np.random.Philox(key=[seed, zlib.crc32(name.encode())])
        self._state = self._bits.state
        self._generator = np.random.Generator(self._bits)

    def at(self, time: int, stream: int = 0) -> np.random.Generator:
        """Return the random numbers of the sample at a time [ns]; they differ between streams."""
        self._state["state"]["counter"][:] = 0, time, stream, 0
        self._bits.state = self._state
        return self._generator

    def added_to(
        self, values: Sequence[float], deviation: float, time: int, stream: int = 0
    ) -> Sequence[float]:
        """Return the values with white noise of this standard deviation."""
        if not deviation:
            return values
        disturbed: list[float] = self.at(time, stream).normal(values, deviation).tolist()
        return disturbed


@dataclass(frozen=True, slots=True)
class SensorContext:
    """The robot that carries a sensor, as far as sensors need to know about it."""

    namespace: str  # the robot's namespace, which prefixes frames and topics
    body: int  # the robot's body in the world
    world: WorldView  # the view of the world
    ground_color: Color  # the colour of the plane z = 0
    lines: tuple[Line, ...]  # painted on it
    gravity: float  # [m/s^2]
    seed: int  # the world's seed
    # The frames in base_link of the sensors mounted so far, by their prefixed names.
    frames: dict[str, Frame] = field(default_factory=dict)

    def frame(self, name: str) -> str:
        """Return a frame's id with the robot's prefix and no leading slash ("husky0/odom")."""
        return f"{self.namespace}/{name}".lstrip("/")

    def add_frame(self, mount: SensorMount, usual: str, rotation: Quaternion) -> str:
        """Register a sensor's frame, by its rotation in base_link; return its id.

        A frame has only one pose: if another sensor already has the usual name, the topic prefixes
        it. The usual name is used for a mount without one.
        """
        frame = Frame(mount.pose.position, rotation)
        name = self.frame(mount.frame or usual)
        if not mount.frame and self.frames.get(name, frame) != frame:
            name = self.frame(f"{mount.topic.strip('/').replace('/', '_')}_{usual}")
        self.frames[name] = frame
        return name

    def noise(self, mount: SensorMount) -> Noise:
        """Return the noise of one sensor."""
        return Noise(self.seed, f"{self.namespace}/{mount.kind}/{mount.topic}")


MeasureBatch = Callable[[RobotState], Iterable[bytes]]
"""Measures several robots' sensors of one kind; returns payloads of one step in the sensors' order.

The argument is the state of all the robots, as arrays.
"""


class Sensor(Protocol):
    """A sensor of one robot."""

    @property
    def outputs(self) -> Mapping[str, type[Message]]:
        """The type of each output, by its name below the mount's topic ("" for that topic)."""

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the payloads of the wanted outputs for one step."""


class BatchSensor(ABC):
    """A sensor that can be measured in one batch with those mounted identically on other robots."""

    @property
    def is_batchable(self) -> bool:
        """False if its settings make it an exception."""
        return True

    @abstractmethod
    def batch(self, sensors: Sequence[tuple["Self", int]]) -> MeasureBatch:
        """Return the function for these batchable sensors, each given with its robot's index."""


@dataclass(frozen=True, slots=True)
class SensorKind:
    """A kind of sensor, as robot models and world files may mount it."""

    make: Callable[[SensorMount, SensorContext], Sensor]  # creates one for a mount on a robot
    settings: type[Settings] = Settings  # the class of its settings
    rate: float = 50.0  # the default rate in world files [Hz]
    topic: str = ""  # the default topic in world files
    bulky: frozenset[str] = frozenset()  # outputs too large to send without a known subscriber
    is_optical: bool = False  # True if z of its frame is the mount's x, as cameras' (REP-103)
    needs_frames: bool = False  # True if it is made after the robot's other sensors, for its frames

    def settings_of(self, mount: SensorMount) -> Settings:
        """Return the settings of a mounted sensor of this kind."""
        return mount.settings or self.settings()


def random_numbers(seed: int, name: str) -> np.random.Generator:
    """Return random numbers for the noise of this name, the same in each run with the same seed."""
    return np.random.default_rng([seed, zlib.crc32(name.encode())])


def fill_header(header: Header, time: int, frame_id: str) -> None:
    """Stamp a header with the step's time [ns] and its frame."""
    header.stamp.sec, header.stamp.nsec = split_stamp(time)
    header.frame_id = frame_id


def transform_message(parent: str, child: str, frame: Frame) -> TransformStamped:
    """Return the message of a frame in its parent, without a time."""
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    place, turn = message.transform.translation, message.transform.rotation
    place.x, place.y, place.z = frame.position
    turn.x, turn.y, turn.z, turn.w = frame.rotation
    return message
