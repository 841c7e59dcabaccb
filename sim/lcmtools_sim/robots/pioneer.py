"""MobileRobots' Pioneer 3-DX with a Kinect on top.

Size, wheels and speeds are from the maker's data sheet; the caster's position is from MobileRobots'
own model of the robot (amr-ros-config, pioneer3dx.urdf). Topics have the names used by the robot's
ROS driver (RosAria) and the Kinect's (openni).
"""

from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots.model import (
    ACROSS,
    ALONG,
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
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import GREY, Color, Cuboid, Cylinder, Part, Sphere

WHEEL_RADIUS = 0.0975
TRACK = 0.33

_LENGTH, _WIDTH = 0.455, 0.381
_BOTTOM, _TOP = 0.06, 0.237
_CENTRE = -0.04  # [m] the middle of the body, behind the axle
_CASTER = -0.185
_MASS = 23.0  # [kg] the robot itself and a load of batteries and a computer
_INERTIA = (0.35, 0.48, 0.62)  # [kg m^2] of a box of this size and mass

_KINECT = (0.10, 0.0, 0.25)  # [m] the position of the Kinect in base_link, on the deck

_RED: Color = (0.7, 0.1, 0.1)
_GOLD: Color = (0.83, 0.68, 0.35)
_LENS: Color = (0.1, 0.25, 0.3)
_WHEELS = tuple(wheel(WHEEL_RADIUS, 0.04, track) for track in (TRACK, -TRACK))


def _look() -> Look:
    """A red body with a dark deck and a ring of sonars, the Kinect on a stand, and a caster."""
    length, width, height = _LENGTH - 0.03, _WIDTH - 0.11, _TOP - _BOTTOM - 0.03
    middle = (_TOP + _BOTTOM) / 2
    nose = _CENTRE + length / 2
    kinect_x, _, kinect_z = (_KINECT[0], 0.0, _KINECT[2] + WHEEL_RADIUS)
    sonars = (
        Part(Sphere(0.016), (nose + 0.004, y, middle + 0.05), color=_GOLD)
        for y in (-0.1, -0.06, -0.02, 0.02, 0.06, 0.1)
    )
    lenses = (
        Part(Cylinder(0.012, 0.01), (kinect_x + 0.034, y, kinect_z), ALONG, _LENS)
        for y in (-0.08, 0.0, 0.03)
    )
    return Look(
        parts=(
            Part(Cuboid((length, width, height)), (_CENTRE, 0.0, middle), color=_RED),
            Part(Cuboid((length + 0.02, _WIDTH - 0.03, 0.018)), (_CENTRE, 0.0, _TOP), color=BLACK),
            Part(Cuboid((0.03, 0.22, 0.06)), (nose - 0.005, 0.0, middle + 0.05), color=BLACK),
            *sonars,
            Part(Cylinder(0.035, 0.03), (_CASTER, 0.0, 0.035), ACROSS, BLACK),
            Part(Cuboid((0.02, 0.05, 0.04)), (_CASTER, 0.0, 0.065), color=GREY),
            Part(Cuboid((0.06, 0.06, 0.08)), (kinect_x - 0.01, 0.0, kinect_z - 0.05), color=GREY),
            Part(Cuboid((0.06, 0.28, 0.045)), (kinect_x, 0.0, kinect_z), color=BLACK),
            *lenses,
            Part(Cuboid((0.18, 0.22, 0.02)), (_CENTRE - 0.08, 0.0, _TOP + 0.018), color=GREY),
        ),
        wheels=tuple(
            detailed_wheel(WHEEL_RADIUS, 0.04, (0.0, side * TRACK / 2, WHEEL_RADIUS), LIGHT)
            for side in (1, -1)
        ),
    )


PIONEER = RobotModel(
    name="pioneer",
    body=Body(
        mass=_MASS,
        inertia=_INERTIA,
        centre_of_mass=0.14,
        base_height=WHEEL_RADIUS,
        parts=(
            Part(
                Cuboid((_LENGTH, _WIDTH - 0.1, _TOP - _BOTTOM)),
                (_CENTRE, 0.0, (_TOP + _BOTTOM) / 2),
                color=_RED,
            ),
            *_WHEELS,
        ),
        feet=((0.0, TRACK / 2), (0.0, -TRACK / 2), (_CASTER, 0.0), (0.1, 0.0)),
        foot_radius=0.02,  # within the outline, so that it never touches first
        look=_look(),
    ),
    drive=Drive(
        wheel_radius=WHEEL_RADIUS,
        track=TRACK,
        full_speed=1.2,
        max_speed=1.2,
        max_turn_rate=5.2,
        max_acceleration=1.0,
        time_constant=0.1,
        tyre_friction=0.8,
    ),
    left_wheels=("left", "left_wheel"),
    right_wheels=("right", "right_wheel"),
    sensors=(
        SensorMount("odometry", "RosAria/pose", 10.0),
        SensorMount("wheel_states", "RosAria/wheel_state", 10.0),
        SensorMount("ground_truth", "ground_truth", 50.0),
        SensorMount("depth_camera", "camera", 30.0, Pose(*_KINECT)),
        SensorMount("transforms", "/tf", 50.0),
    ),
    commands=(CommandTopic("RosAria/cmd_vel", is_twist=True),),
)
