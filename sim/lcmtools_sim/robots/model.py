"""Robot models: body, wheels, limits and sensors, as frozen values.

All positions are given in base_footprint: on the ground, midway between the wheels, x
forward, y left, z up.
"""

import math
from dataclasses import dataclass

from lcmtools_sim.geometry import Quaternion, Vector, from_euler
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part

BLACK: Color = (0.15, 0.15, 0.15)
LIGHT: Color = (0.93, 0.93, 0.9)
ACROSS: Quaternion = (0.7071067811865476, 0.0, 0.0, 0.7071067811865476)
"""The rotation of a cylinder along y, such as a wheel."""
ALONG: Quaternion = (0.0, 0.7071067811865476, 0.0, 0.7071067811865476)  # the same along x


def wheel(radius: float, width: float, track: float) -> Part:
    """A wheel's shape [m], slightly above the ground; on the right if the track is below 0."""
    return Part(Cylinder(radius - 0.005, width), (0.0, track / 2, radius), ACROSS, BLACK)


def detailed_wheel(radius: float, width: float, centre: Vector, hub: Color) -> "Wheel":
    """Return a tyre with a hub and spokes of this colour, which show its rotation."""
    tyre = Part(Cylinder(radius, width), rotation=ACROSS, color=BLACK)
    disc = Part(Cylinder(0.6 * radius, width + 0.008), rotation=ACROSS, color=hub)
    cap = Part(Cylinder(0.2 * radius, width + 0.024), rotation=ACROSS, color=BLACK)
    spokes = [
        Part(
            Cuboid((1.1 * radius, width + 0.014, 0.14 * radius)),
            rotation=from_euler(0.0, math.pi / 3 * number, 0.0),
            color=BLACK,
        )
        for number in range(3)
    ]
    return Wheel(centre, (tyre, disc, *spokes, cap))


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel for viewers: its centre in base_footprint, and its parts relative to the centre.

    It turns about its y axis, by its side's angle.
    """

    centre: Vector
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Look:
    """A robot's appearance in a viewer, in more detail than its collision shapes."""

    parts: tuple[Part, ...] = ()
    wheels: tuple[Wheel, ...] = ()


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body that slides on feet without friction; tyres pull it."""

    mass: float  # [kg], wheels included
    inertia: Vector  # about x, y, z through the centre of mass [kg m^2]
    centre_of_mass: float  # height above the ground [m], midway between the wheels
    base_height: float  # of base_link above the ground [m]
    parts: tuple[Part, ...]  # the shapes that collide and that sensors see
    feet: tuple[tuple[float, float], ...]  # (x, y) of the points on which it stands [m]
    foot_radius: float  # [m]
    look: Look = Look()  # shown by viewers instead of the parts, unless it has none


@dataclass(frozen=True, slots=True)
class Drive:
    """Two driven sides, their motors and their tyres."""

    wheel_radius: float  # [m]
    track: float  # distance of two ideal wheels that would turn the robot as its own wheels do [m]
    full_speed: float  # ground speed of a side at effort 1 [m/s]
    max_speed: float  # highest forward speed of a command [m/s]
    max_turn_rate: float  # highest turn rate of a command [rad/s]
    max_acceleration: float  # of a side [m/s^2]
    time_constant: float  # of the motors [s]
    tyre_friction: float  # Coulomb coefficient on ground of friction 1
    believed_track: float = 0.0  # assumed by its controller for turn rates [m]; 0 for the track
    # (x, y) of the contacts of wheels that skid when it turns [m].
    wheels: tuple[tuple[float, float], ...] = ()
    # Turn by skidding on these wheels, as a real robot, not as with two ideal ones at the track.
    skids: bool = False


@dataclass(frozen=True, slots=True)
class CommandTopic:
    """A topic that steers a robot; it is declared as Twist or JointState, and accepts both."""

    name: str
    is_twist: bool = False


COMMANDS = (
    CommandTopic("velocity_cmd"),
    CommandTopic("wheel_cmd"),
    CommandTopic("wheel_velocity_cmd"),
    CommandTopic("cmd_vel", is_twist=True),
)
"""All names in the Husky lab's text; they mean the same."""

MOTION_SENSORS = (
    SensorMount("odometry", "odometry", 50.0),
    SensorMount("wheel_states", "wheel_states", 50.0),
    SensorMount("ground_truth", "ground_truth", 50.0),
    SensorMount("transforms", "/tf", 50.0),
)
"""The sensors of a robot whose model has no others."""


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A kind of robot."""

    name: str  # in world files
    body: Body  # its rigid body
    drive: Drive  # its motors and tyres
    left_wheels: tuple[str, ...]  # names in commands for the left side, the usual one first
    right_wheels: tuple[str, ...]  # the same for the right side, in the same order
    sensors: tuple[SensorMount, ...] = MOTION_SENSORS  # in order
    commands: tuple[CommandTopic, ...] = COMMANDS  # ``wtf`` names the first if none is published
    gazebo_drive: Drive | None = None  # the drive as in Gazebo, if that is known to be wrong
