"""What a robot model consists of: its body, wheels, limits and sensors, as frozen values.

All positions are given in base_footprint: on the ground, in the middle between the wheels, x
forward, y left, z up. How these values move is drive.py's business, how they collide world.py's.
"""

from dataclasses import dataclass

from lcmtools_sim.rotation import Quaternion, Vector
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.shapes import Part


@dataclass(frozen=True, slots=True)
class Mesh:
    """A part of the body that is seen in the window: a file of pybullet_data and where it is.

    A wheel turns about its y axis.
    """

    file: str
    position: Vector
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    color: Vector = (0.2, 0.2, 0.2)
    is_wheel: bool = False


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body that slides on feet without friction; its tyres are drive.py's business.

    Attributes:
        mass: [kg], wheels included.
        inertia: About x, y, z through the centre of mass [kg m^2].
        centre_of_mass: Height above the ground [m]; it lies in the middle between the wheels.
        base_height: Of base_link above the ground [m].
        parts: What collides, and is seen by sensors.
        feet: (x, y) of the points that it stands on [m].
        foot_radius: [m]
        meshes: What is seen in the window; none: the parts.
    """

    mass: float
    inertia: Vector
    centre_of_mass: float
    base_height: float
    parts: tuple[Part, ...]
    feet: tuple[tuple[float, float], ...]
    foot_radius: float
    meshes: tuple[Mesh, ...] = ()


@dataclass(frozen=True, slots=True)
class Drive:
    """Two driven sides, their motors and their tyres.

    Attributes:
        wheel_radius: [m]
        track: Distance at which two ideal wheels would turn the robot as its own do [m].
        full_speed: Ground speed of a side at effort 1 [m/s].
        max_speed: Highest forward speed that is obeyed [m/s].
        max_turn_rate: Highest turn rate that is obeyed [rad/s].
        max_acceleration: Of a side [m/s^2].
        time_constant: Of the motors [s].
        tyre_friction: Coulomb coefficient on ground of friction 1.
        believed_track: What its controller takes for the track when it obeys a turn rate [m]; 0
            for the track itself.
        wheels: (x, y) where wheels touch the ground, for those that skid when it turns [m].
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
    """A name by which a robot is steered, and whether it is declared as one of Twists."""

    name: str
    is_twist: bool = False


COMMANDS = (
    CommandTopic("velocity_cmd"),
    CommandTopic("wheel_cmd"),
    CommandTopic("wheel_velocity_cmd"),
    CommandTopic("cmd_vel", is_twist=True),
)
"""What every name of the Husky lab's text means: the same."""


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A kind of robot.

    Attributes:
        name: As world files say it.
        body: What collides and is seen.
        drive: What moves it.
        left_wheels: Names that commands may use for the left side, the usual one first.
        right_wheels: Names for the right side, in the same order.
        sensors: What it publishes.
        commands: The topics by which it is steered, and whether each is declared as one of Twist;
            all take both types. ``wtf`` names the first one when nobody publishes any.
        gazebo_drive: How it drove in Gazebo, where that was known to be wrong.
    """

    name: str
    body: Body
    drive: Drive
    left_wheels: tuple[str, ...]
    right_wheels: tuple[str, ...]
    sensors: tuple[SensorMount, ...]
    commands: tuple[CommandTopic, ...] = COMMANDS
    gazebo_drive: Drive | None = None
