"""What every sensor is given and what it gives back.

A sensor turns the state of one robot after one step into one message. It knows no bus, no engine
and no schedule; one sensor, one file.
"""

from dataclasses import dataclass
from typing import ClassVar, Protocol

from lcmtools.clock import split_stamp
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Quaternion as QuaternionMessage
from lcmtools.types.std_msgs import Header
from lcmtools_sim.rotation import Quaternion, Vector


@dataclass(frozen=True, slots=True)
class WheelState:
    """One side's wheels: angle [rad], speed [rad/s] and effort (fraction of full power)."""

    angle: float
    speed: float
    effort: float


@dataclass(frozen=True, slots=True)
class RobotState:
    """A robot after a step, as its sensors may measure it.

    Attributes:
        time: Simulated nanoseconds since the start.
        position: Of base_link in the world [m].
        rotation: Of base_link in the world.
        velocity: Of base_link, in its own frame [m/s].
        turning: Angular velocity in its own frame [rad/s].
        wheels: Left and right.
        reckoned_pose: x, y [m] and yaw [rad] by the wheels' encoders, where it started as origin.
        reckoned_speed: Forward speed [m/s] and turn rate [rad/s] by the wheels' encoders.
    """

    time: int
    position: Vector
    rotation: Quaternion
    velocity: Vector
    turning: Vector
    wheels: tuple[WheelState, WheelState]
    reckoned_pose: tuple[float, float, float]
    reckoned_speed: tuple[float, float]


class Sensor(Protocol):
    """Measures one robot."""

    message_type: ClassVar[type[Message]]

    def sample(self, state: RobotState) -> Message:
        """The message of one step."""
        ...


def frame(namespace: str, name: str) -> str:
    """A frame's id with its robot's prefix and no slash before ("husky0/odom")."""
    return f"{namespace}/{name}".lstrip("/")


def fill_header(header: Header, time: int, frame_id: str) -> None:
    """Stamp a header with the step's time [ns] and its frame."""
    header.stamp.sec, header.stamp.nsec = split_stamp(time)
    header.frame_id = frame_id


def fill_quaternion(message: QuaternionMessage, rotation: Quaternion) -> None:
    """Copy a rotation into a message."""
    message.x, message.y, message.z, message.w = rotation
