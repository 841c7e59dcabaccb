"""Clearpath's Husky A200.

Dimensions, masses, limits and the wheel_separation_multiplier are from the public ROS
packages of the robot (husky/husky, noetic: husky.urdf.xacro, wheel.urdf.xacro, control.yaml).
"""

from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots.model import (
    ACROSS,
    ALONG,
    LIGHT,
    Body,
    Drive,
    Look,
    RobotModel,
    detailed_wheel,
)
from lcmtools_sim.sensors.motion import ImuSettings
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part

WHEEL_RADIUS = 0.1651
WHEEL_WIDTH = 0.1143
WHEELBASE = 0.5120
TRACK = 0.5708
TRACK_MULTIPLIER = 1.875
"""A skid-steered robot turns more slowly than its wheels suggest, as if this much wider."""

_BASE_HEIGHT = 0.13228
_CHASSIS = (0.9874, 0.5709, 0.2475)
_CHASSIS_MASS = 46.034
_CHASSIS_INERTIA = (0.6022, 1.7386, 2.0296)
_WHEEL_MASS = 2.637
_WHEEL_INERTIA = (0.02467, 0.04411, 0.02467)
_CENTRE_OF_MASS = 0.19  # of chassis and wheels together
_GROUND_CLEARANCE = 0.03  # of the wheels' collision boxes; only the feet reach the ground

_YELLOW: Color = (0.8, 0.8, 0.1)
_BLACK: Color = (0.2, 0.2, 0.2)
_PLATE: Color = (0.96, 0.74, 0.05)
_HUB: Color = (0.75, 0.58, 0.06)
_REAR_LAMP: Color = (0.75, 0.05, 0.05)

_CORNERS = tuple((x * WHEELBASE / 2, y * TRACK / 2) for x in (1, -1) for y in (1, -1))


def _inertia() -> tuple[float, float, float]:
    """The inertia of chassis and wheels about their common centre (parallel axis theorem)."""
    a, b = WHEELBASE / 2, TRACK / 2
    offsets = (b * b, a * a, a * a + b * b)
    x, y, z = (
        chassis + 4 * (wheel + _WHEEL_MASS * offset)
        for chassis, wheel, offset in zip(_CHASSIS_INERTIA, _WHEEL_INERTIA, offsets, strict=True)
    )
    return x, y, z


def _wheels(side: int) -> Part:
    """Return the box around the two wheels of a side (left 1, right -1)."""
    height = 2 * (WHEEL_RADIUS - _GROUND_CLEARANCE)
    length = WHEELBASE + 2 * WHEEL_RADIUS
    box = Cuboid((length, WHEEL_WIDTH, height))
    return Part(box, (0.0, side * TRACK / 2, WHEEL_RADIUS), color=_BLACK)


def _look() -> Look:
    """A dark chassis with yellow plates, a rail, and lamps: white in front, red behind."""
    z = _BASE_HEIGHT
    plate, dark = _PLATE, _BLACK
    rail = (
        *(Part(Cylinder(0.018, 0.12), (0.30, y, z + 0.33), color=dark) for y in (0.2, -0.2)),
        Part(Cylinder(0.018, 0.436), (0.30, 0.0, z + 0.39), ACROSS, dark),
    )
    ends = (
        part
        for x, lamp in ((1, LIGHT), (-1, _REAR_LAMP))
        for part in (
            Part(Cuboid((0.06, 0.46, 0.1)), (x * 0.465, 0.0, z + 0.085), color=dark),
            Part(Cuboid((0.05, 0.34, 0.045)), (x * 0.475, 0.0, z + 0.165), color=plate),
            *(
                Part(Cylinder(0.022, 0.05), (x * 0.462, y, z + 0.215), ALONG, lamp)
                for y in (0.16, -0.16)
            ),
        )
    )
    return Look(
        parts=(
            Part(Cuboid((0.88, 0.42, 0.19)), (0.0, 0.0, z + 0.095), color=dark),
            Part(Cuboid((0.92, 0.5, 0.05)), (0.0, 0.0, z + 0.215), color=dark),
            *(
                Part(Cuboid((0.9, 0.085, 0.02)), (0.0, y, z + 0.25), color=plate)
                for y in (0.2425, -0.2425)
            ),
            Part(Cuboid((0.80, 0.40, 0.03)), (0.0, 0.0, z + 0.252), color=plate),
            Part(Cuboid((0.34, 0.26, 0.012)), (-0.12, 0.0, z + 0.272), color=dark),
            *ends,
            *rail,
        ),
        wheels=tuple(
            detailed_wheel(WHEEL_RADIUS, WHEEL_WIDTH, (x, y, WHEEL_RADIUS), _HUB)
            for x, y in _CORNERS
        ),
    )


HUSKY = RobotModel(
    name="husky",
    body=Body(
        mass=_CHASSIS_MASS + 4 * _WHEEL_MASS,
        inertia=_inertia(),
        centre_of_mass=_CENTRE_OF_MASS,
        base_height=_BASE_HEIGHT,
        parts=(
            Part(Cuboid(_CHASSIS), (0.0, 0.0, _BASE_HEIGHT + _CHASSIS[2] / 2), color=_YELLOW),
            _wheels(1),
            _wheels(-1),
        ),
        feet=_CORNERS,
        foot_radius=0.05,
        look=_look(),
    ),
    drive=Drive(
        wheel_radius=WHEEL_RADIUS,
        track=TRACK * TRACK_MULTIPLIER,
        full_speed=1.0,
        max_speed=1.0,
        max_turn_rate=2.0,
        max_acceleration=3.0,
        time_constant=0.15,
        tyre_friction=0.8,
        wheels=_CORNERS,
    ),
    left_wheels=("left", "front_left_wheel", "rear_left_wheel"),
    right_wheels=("right", "front_right_wheel", "rear_right_wheel"),
    sensors=(
        SensorMount("odometry", "odometry", 50.0),
        SensorMount("wheel_states", "wheel_velocities", 50.0),
        SensorMount("ground_truth", "ground_truth", 50.0),
        SensorMount("imu", "imu", 50.0, Pose(0.19, 0.0, 0.149), settings=ImuSettings()),
        SensorMount("transforms", "/tf", 50.0),
    ),
)
