"""A robot model made of a URDF: which of its joints drive it, and what it stands on.

The body is one rigid piece that slides on frictionless feet, as those of all models; its mass is
taken to lie over the middle between the wheels, where the tyre model wants it, with the moments of
inertia that all links together have about that line.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from lcmtools.names import did_you_mean
from lcmtools_sim.robots.model import Drive, RobotModel
from lcmtools_sim.rotation import Vector, axes, turn
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.shapes import Cylinder, Part, Sphere
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.urdf import Joint, Urdf
from lcmtools_sim.world_file.urdf_body import urdf_body
from lcmtools_sim.world_file.values import friction, length, value

_DRIVE_KEYS = (
    "left",
    "right",
    "max_speed",
    "max_turn_rate",
    "max_acceleration",
    "time_constant",
    "friction",
    "wheel_radius",
    "track",
)
_NEAR = 0.01
"""[m] Two places so near to each other are one."""
_ALONG = 0.99
"""Cosine of the largest angle between what must be parallel."""
_SENSORS = (
    SensorMount("odometry", "odometry", 50.0),
    SensorMount("wheel_states", "wheel_states", 50.0),
    SensorMount("ground_truth", "ground_truth", 50.0),
    SensorMount("transforms", "/tf", 50.0),
)


@dataclass(frozen=True, slots=True)
class _Wheel:
    """A driven wheel: its middle in base_link, and its radius [m]; 0 where it is not round."""

    joint: str
    centre: Vector
    radius: float


def urdf_model(urdf: Urdf, item: Item) -> tuple[RobotModel, tuple[str, ...]]:
    """The robot that a URDF describes, driven as ``item`` says, and notes about it.

    Raises:
        InvalidFile: The joints do not fit, or the robot could not stand on its wheels.
    """
    keys = item.fields(_DRIVE_KEYS, required=["left", "right"])
    sides = tuple(
        tuple(_wheel(urdf, joint) for joint in keys[side].items()) for side in ("left", "right")
    )
    left, right = sides
    _check_sides(item, left, right)
    said = value(keys, "wheel_radius", length, 0.0)
    radius = said or _common_radius(item, (*left, *right))
    middle = _middle(left, right, radius)
    drive = _drive(keys, left, right, radius, middle)
    body = urdf_body(urdf, _contacts((*left, *right), middle), middle, radius)
    model = RobotModel(
        name=urdf.name,
        body=body,
        drive=drive,
        left_wheels=_names("left", left),
        right_wheels=_names("right", right),
        sensors=_SENSORS,
    )
    return model, (*urdf.notes, *_notes(urdf, middle))


def _names(side: str, wheels: Sequence[_Wheel]) -> tuple[str, ...]:
    return (side, *(wheel.joint for wheel in wheels if wheel.joint != side))


def _notes(urdf: Urdf, middle: Vector) -> tuple[str, ...]:
    """Where the file's own base_link is not that of the simulation."""
    x, y, _ = middle
    if math.hypot(x, y) < _NEAR:
        return ()
    note = "base_link is taken to be over the middle between the wheels"
    return (f"{urdf.root.source}: {note}, {x:.3f} m forward and {y:.3f} m left of the file's",)


def _wheel(urdf: Urdf, item: Item) -> _Wheel:
    name = item.text()
    joint = urdf.joints.get(name)
    if joint is None:
        turning = [n for n, one in urdf.joints.items() if one.kind in ("continuous", "revolute")]
        known = f"joints that turn: {', '.join(turning) or 'none'}"
        raise item.error(
            f"{urdf.root.source} has no joint '{name}'", did_you_mean(name, turning) or known
        )
    _check_axis(urdf, joint)
    link = urdf.links[joint.child]
    round_parts = [p for p in link.parts if isinstance(p.shape, Cylinder | Sphere)]
    biggest = max(round_parts, key=_radius, default=None)
    if biggest is None:
        return _Wheel(name, link.frame.position, 0.0)
    if isinstance(biggest.shape, Cylinder) and abs(axes(biggest.rotation)[2][1]) < _ALONG:
        raise link.element.error(
            f"the cylinder of the wheel '{joint.child}' does not lie along its axle",
            'rpy="1.5708 0 0" in its <origin> turns it, where the axle is y',
        )
    return _Wheel(name, biggest.position, _radius(biggest))


def _check_axis(urdf: Urdf, joint: Joint) -> None:
    if joint.kind not in ("continuous", "revolute"):
        raise joint.element.error(f"{joint.element} is {joint.kind}: a wheel's is continuous")
    axis = joint.element.child("axis")
    own = axis.vector("xyz") if axis else (1.0, 0.0, 0.0)
    size = math.hypot(*own)
    turned = turn(own, urdf.links[joint.child].frame.rotation)
    if not size or abs(turned[1]) / size < _ALONG:
        raise joint.element.error(
            f"{joint.element} does not turn about the y axis of base_link, as wheels do",
            'give it <axis xyz="0 1 0"/>',
        )


def _radius(part: Part) -> float:
    return part.shape.radius if isinstance(part.shape, Cylinder | Sphere) else 0.0


def _check_sides(item: Item, left: Sequence[_Wheel], right: Sequence[_Wheel]) -> None:
    for side, wheels in (("left", left), ("right", right)):
        if not wheels:
            raise item.error(f"'{side}' names no joint")
    names = [wheel.joint for wheel in (*left, *right)]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise item.error(f"the joint '{twice}' is given twice")
    if min(w.centre[1] for w in left) <= max(w.centre[1] for w in right):
        raise item.error("the left wheels are not to the left (y) of the right ones", "swap them?")


def _common_radius(item: Item, wheels: Iterable[_Wheel]) -> float:
    """The wheels' radius [m], where they agree on it to a hundredth."""
    radii = {wheel.joint: wheel.radius for wheel in wheels}
    for joint, radius in radii.items():
        if not radius:
            raise item.error(f"the wheel of '{joint}' has no round shape", "say wheel_radius")
    smallest, largest = min(radii.values()), max(radii.values())
    if largest > 1.01 * smallest:
        raise item.error(
            f"the wheels have radii from {smallest:g} to {largest:g} m", "say wheel_radius"
        )
    return largest


def _middle(left: Sequence[_Wheel], right: Sequence[_Wheel], radius: float) -> Vector:
    """The point on the ground in the middle between the wheels, in base_link."""
    wheels = (*left, *right)
    x, y = ((_mean(left, i) + _mean(right, i)) / 2 for i in (0, 1))
    return x, y, min(wheel.centre[2] for wheel in wheels) - radius


def _contacts(wheels: Iterable[_Wheel], middle: Vector) -> tuple[tuple[float, float], ...]:
    """Where the wheels touch the ground, about the middle [m]."""
    return tuple((w.centre[0] - middle[0], w.centre[1] - middle[1]) for w in wheels)


def _mean(wheels: Sequence[_Wheel], axis: int) -> float:
    return sum(wheel.centre[axis] for wheel in wheels) / len(wheels)


def _drive(
    keys: dict[str, Item],
    left: Sequence[_Wheel],
    right: Sequence[_Wheel],
    radius: float,
    middle: Vector,
) -> Drive:
    speed = value(keys, "max_speed", lambda item: item.number(1e-3, 100), 1.0)
    track = value(keys, "track", length, _mean(left, 1) - _mean(right, 1))
    contacts = _contacts((*left, *right), middle)
    return Drive(
        wheel_radius=radius,
        track=track,
        full_speed=speed,
        max_speed=speed,
        max_turn_rate=value(
            keys, "max_turn_rate", lambda item: item.number(1e-3, 100), 2 * speed / track
        ),
        max_acceleration=value(keys, "max_acceleration", lambda item: item.number(1e-3, 1e3), 1.0),
        time_constant=value(keys, "time_constant", lambda item: item.number(0, 10), 0.1),
        tyre_friction=value(keys, "friction", friction, 0.8),
        wheels=contacts if len(contacts) > 2 else (),  # noqa: PLR2004 - two wheels do not skid
    )
