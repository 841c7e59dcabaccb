"""Robot models: body, wheels, limits and sensors, as frozen values.

All positions are given in base_footprint: on the ground, in the middle between the wheels, x
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
"""A cylinder's along y, as a wheel's."""
ALONG: Quaternion = (0.0, 0.7071067811865476, 0.0, 0.7071067811865476)
"""A cylinder's along x."""


def wheel(radius: float, width: float, track: float) -> Part:
    """The shape of a wheel [m], a little above the ground; on the right with a track below 0."""
    return Part(Cylinder(radius - 0.005, width), (0.0, track / 2, radius), ACROSS, BLACK)


def detailed_wheel(radius: float, width: float, centre: Vector, hub: Color) -> "Wheel":
    """A tyre with a hub and spokes of this colour, which show that it turns."""
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
    """A wheel as viewers show it: its centre in base_footprint, and its parts about the centre.

    It turns about its y axis, by the angle of the side that it is on.
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
    """A rigid body that slides on feet without friction; tyres pull it.

    Attributes:
        mass: [kg], wheels included.
        inertia: About x, y, z through the centre of mass [kg m^2].
        centre_of_mass: Height above the ground [m], in the middle between the wheels.
        base_height: Of base_link above the ground [m].
        parts: The shapes that collide and that sensors see.
        feet: (x, y) of the points that it stands on [m].
        foot_radius: [m]
        look: Shown by viewers instead of the parts, unless it has none.
    """

    mass: float
    inertia: Vector
    centre_of_mass: float
    base_height: float
    parts: tuple[Part, ...]
    feet: tuple[tuple[float, float], ...]
    foot_radius: float
    look: Look = Look()


@dataclass(frozen=True, slots=True)
class Drive:
    """Two driven sides, their motors and their tyres.

    Attributes:
        wheel_radius: [m]
        track: Distance at which two ideal wheels would turn the robot as its own do [m].
        full_speed: Ground speed of a side at effort 1 [m/s].
        max_speed: Highest forward speed of a command [m/s].
        max_turn_rate: Highest turn rate of a command [rad/s].
        max_acceleration: Of a side [m/s^2].
        time_constant: Of the motors [s].
        tyre_friction: Coulomb coefficient on ground of friction 1.
        believed_track: The track that its controller assumes for turn rates [m]; 0 for the track.
        wheels: (x, y) of the contacts of wheels that skid when it turns [m].
        skids: Turn by skidding on these wheels, as a real one does, instead of as two ideal wheels
            at the track would.
    """

    wheel_radius: float
    track: float
    full_speed: float
    max_speed: float
    max_turn_rate: float
    max_acceleration: float
    time_constant: float
    tyre_friction: float
    believed_track: float = 0.0
    wheels: tuple[tuple[float, float], ...] = ()
    skids: bool = False


@dataclass(frozen=True, slots=True)
class CommandTopic:
    """A topic that steers a robot; it is declared as Twist or as JointState, and takes both."""

    name: str
    is_twist: bool = False


COMMANDS = (
    CommandTopic("velocity_cmd"),
    CommandTopic("wheel_cmd"),
    CommandTopic("wheel_velocity_cmd"),
    CommandTopic("cmd_vel", is_twist=True),
)
"""All names in the Husky lab's text; they mean the same."""


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A kind of robot.

    Attributes:
        name: In world files.
        body: Its rigid body.
        drive: Its motors and tyres.
        left_wheels: Names that commands may use for the left side, the usual one first.
        right_wheels: Names for the right side, in the same order.
        sensors: In their order.
        commands: ``wtf`` names the first one if nobody publishes any.
        gazebo_drive: The drive as it was in Gazebo, if that is known to be wrong.
    """

    name: str
    body: Body
    drive: Drive
    left_wheels: tuple[str, ...]
    right_wheels: tuple[str, ...]
    sensors: tuple[SensorMount, ...]
    commands: tuple[CommandTopic, ...] = COMMANDS
    gazebo_drive: Drive | None = None
