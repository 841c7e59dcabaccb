"""Dolly, the sheep that follows: a small cart with a laser in front.

All numbers are from its public model (chapulina/dolly, dolly_gazebo/models/dolly/model.sdf).
Its Gazebo plugin has a wheel separation of 1.25 m, but the wheels are 0.6 m apart, so that in
Gazebo it turns 1.25 / 0.6 times as fast as commanded; ``gazebo_quirks: true`` in a world file
restores this.
"""

from dataclasses import replace

from lcmtools_sim.geometry import Pose, from_euler
from lcmtools_sim.robots.model import (
    ACROSS,
    BLACK,
    LIGHT,
    Body,
    CommandTopic,
    Drive,
    Look,
    RobotModel,
    detailed_wheel,
    wheel,
)
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import GREY, Color, Cuboid, Cylinder, Part, Sphere

WHEEL_RADIUS = 0.15
TRACK = 0.6

_PLUGIN_RATE = 100.0  # [Hz] default of Gazebo's differential drive plugin
_HEIGHT = 0.225  # [m] of the middle of the chassis, and of base_link, which is above the axle
_AXLE = 0.3  # [m] distance of the wheels in front of the middle of the chassis
_CHASSIS = (1.0, 0.5, 0.15)
_MASS = 2.0  # [kg] chassis and two wheels
_INERTIA = (0.06, 0.13, 0.19)  # [kg m^2] a box of 1 kg with two wheels of 0.5 kg beside it

_WHITE: Color = (0.9, 0.9, 0.88)
_WOOL: Color = (0.93, 0.91, 0.85)
_FACE: Color = (0.2, 0.18, 0.17)
_LENS: Color = (0.75, 0.15, 0.1)
_WHEELS = tuple(wheel(WHEEL_RADIUS, 0.05, track) for track in (TRACK, -TRACK))

_LASER = LaserSettings(200, -1.0, 1.0, 0.05, 10.0)
_DRIVE = Drive(
    wheel_radius=WHEEL_RADIUS,
    track=TRACK,
    full_speed=1.0,
    max_speed=2.0,
    max_turn_rate=4.0,
    max_acceleration=1.0,
    time_constant=0.05,
    tyre_friction=1.0,
)


def _look() -> Look:
    """A white cart with a woolly back, a dark head with ears, and its laser in front."""
    nose = 0.5 - _AXLE
    wool = (
        Part(Sphere(0.14), (-_AXLE + 0.02 + x, y, _HEIGHT + 0.06), color=_WOOL)
        for x in (-0.36, -0.18, 0.0, 0.18)
        for y in (-0.13, 0.0, 0.13)
    )
    casters = (
        part
        for y in (0.15, -0.15)
        for part in (
            Part(Cylinder(0.05, 0.03), (-2 * _AXLE, y, 0.05), ACROSS, BLACK),
            Part(Cuboid((0.03, 0.05, 0.06)), (-2 * _AXLE, y, 0.12), color=GREY),
        )
    )
    ears = (
        Part(Cuboid((0.04, 0.11, 0.05)), (nose - 0.06, y, 0.40), from_euler(tilt, 0.0, 0.0), _FACE)
        for y, tilt in ((0.13, -0.4), (-0.13, 0.4))
    )
    eyes = (Part(Sphere(0.018), (nose + 0.032, y, 0.40), color=LIGHT) for y in (0.045, -0.045))
    return Look(
        parts=(
            Part(Cuboid(_CHASSIS), (-_AXLE, 0.0, _HEIGHT), color=_WHITE),
            *wool,
            Part(Cuboid((0.2, 0.17, 0.17)), (nose - 0.06, 0.0, 0.37), color=_FACE),
            *ears,
            *eyes,
            Part(Cylinder(0.045, 0.06), (nose + 0.03, 0.0, _HEIGHT), color=BLACK),
            Part(Cylinder(0.047, 0.012), (nose + 0.03, 0.0, _HEIGHT + 0.005), color=_LENS),
            *casters,
        ),
        wheels=tuple(
            detailed_wheel(WHEEL_RADIUS, 0.05, (0.0, side * TRACK / 2, WHEEL_RADIUS), GREY)
            for side in (1, -1)
        ),
    )


DOLLY = RobotModel(
    name="dolly",
    body=Body(
        mass=_MASS,
        inertia=_INERTIA,
        centre_of_mass=0.18,
        base_height=_HEIGHT,
        parts=(Part(Cuboid(_CHASSIS), (-_AXLE, 0.0, _HEIGHT), color=_WHITE), *_WHEELS),
        feet=((0.0, TRACK / 2), (0.0, -TRACK / 2), (-2 * _AXLE, 0.0), (0.17, 0.0)),
        foot_radius=0.025,  # within the outline, so that it never touches first
        look=_look(),
    ),
    drive=_DRIVE,
    left_wheels=("left", "left_wheel"),
    right_wheels=("right", "right_wheel"),
    sensors=(
        SensorMount("odometry", "odom", _PLUGIN_RATE),
        SensorMount("laser", "laser_scan", 100.0, Pose(0.5 - _AXLE), settings=_LASER),
        SensorMount("ground_truth", "ground_truth", 50.0),
        SensorMount("transforms", "/tf", _PLUGIN_RATE),
    ),
    commands=(CommandTopic("cmd_vel", is_twist=True),),
    gazebo_drive=replace(_DRIVE, believed_track=1.25),
)
