"""A robot model from a URDF file: its wheels' joints, and one rigid body of all links.

The body slides on frictionless feet, as in all models. As the tyre model requires, its mass is
assumed above the middle between the wheels, with all links' moments of inertia about that line.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, TypeAlias

from lcmtools.formats.typed import Item, Within, read
from lcmtools.names import did_you_mean
from lcmtools_sim.geometry import Vector, axes, rotate, scaled, subtract
from lcmtools_sim.robots.model import Body, Drive, Look, RobotModel, Wheel, detailed_wheel
from lcmtools_sim.shapes import Cylinder, Part, Sphere, centre_of_mass, moments
from lcmtools_sim.world_file.urdf import Joint, Urdf
from lcmtools_sim.world_file.values import Friction, Length, given_twice

_NEAR = 0.01  # [m] two places this close to each other count as one
_PARALLEL = 0.99  # cosine of the largest angle between parallel axes
_CLEARANCE = 0.004  # [m] the least height of all parts above the ground: only the feet touch it
_DEEPEST = 0.05  # [m] a part that reaches farther below the wheels would carry the robot instead
_NEAR_GROUND = 0.01  # [m] a part this close to the ground supports the robot
_Speed: TypeAlias = Annotated[float, Within(1e-3, 100)]
_TURNING = ("continuous", "revolute")


@dataclass(frozen=True, slots=True)
class _Drive:
    left: Item
    right: Item
    max_speed: _Speed = 1.0  # [m/s]
    max_turn_rate: _Speed | None = None  # [rad/s]
    max_acceleration: Annotated[float, Within(1e-3, 1e3)] = 1.0  # [m/s^2]
    time_constant: Annotated[float, Within(0, 10)] = 0.1  # [s]
    friction: Friction = 0.8
    wheel_radius: Length | None = None
    track: Length | None = None


@dataclass(frozen=True, slots=True)
class _Wheel:
    """A driven wheel: its centre in base_link, its radius [m] (0 if it is not round), its tyre."""

    joint: str
    link: str
    centre: Vector
    radius: float = 0.0
    tyre: Part | None = None


def urdf_model(urdf: Urdf, item: Item) -> tuple[RobotModel, tuple[str, ...]]:
    """Return the robot of a URDF file, with the drive in ``item``, and notes about it."""
    drive = read(_Drive, item)
    left, right = ([_wheel(urdf, o) for o in side.items()] for side in (drive.left, drive.right))
    _check_sides(item, left, right)
    wheels = [*left, *right]
    radius = drive.wheel_radius or _common_radius(item, wheels)
    x, y = ((_mean(left, i) + _mean(right, i)) / 2 for i in (0, 1))
    middle = (x, y, min(wheel.centre[2] for wheel in wheels) - radius)
    contacts = tuple((wheel.centre[0] - x, wheel.centre[1] - y) for wheel in wheels)
    track = drive.track or _mean(left, 1) - _mean(right, 1)
    model = RobotModel(
        name=urdf.name,
        body=replace(_body(urdf, contacts, middle, radius), look=_look(urdf, wheels, middle)),
        drive=Drive(
            wheel_radius=radius,
            track=track,
            full_speed=drive.max_speed,
            max_speed=drive.max_speed,
            max_turn_rate=drive.max_turn_rate or 2 * drive.max_speed / track,
            max_acceleration=drive.max_acceleration,
            time_constant=drive.time_constant,
            tyre_friction=drive.friction,
            wheels=contacts if len(contacts) > 2 else (),  # noqa: PLR2004 - two wheels do not skid
        ),
        left_wheels=_names("left", left),
        right_wheels=_names("right", right),
    )
    return model, (*urdf.notes, *_rigid_joints(urdf, wheels), *_notes(urdf, middle))


def _names(side: str, wheels: Sequence[_Wheel]) -> tuple[str, ...]:
    return (side, *(wheel.joint for wheel in wheels if wheel.joint != side))


def _mean(wheels: Sequence[_Wheel], axis: int) -> float:
    return sum(wheel.centre[axis] for wheel in wheels) / len(wheels)


def _rigid_joints(urdf: Urdf, wheels: Sequence[_Wheel]) -> Iterator[str]:
    """Yield a note on the joints that could move, but that nothing drives."""
    driven = {wheel.joint for wheel in wheels}
    names = [
        f"{name} ({'mimic' if joint.element.child('mimic') else joint.kind})"
        for name, joint in urdf.joints.items()
        if joint.kind != "fixed" and name not in driven
    ]
    if names:
        yield f"{urdf.root.source}: rigid, as nothing drives them: {', '.join(names)}"


def _notes(urdf: Urdf, middle: Vector) -> tuple[str, ...]:
    """Return a note if the file's base_link differs from the simulation's."""
    x, y, _ = middle
    if math.hypot(x, y) < _NEAR:
        return ()
    note = "base_link is assumed at the middle between the wheels"
    return (f"{urdf.root.source}: {note}, {x:.3f} m forward and {y:.3f} m left of the file's",)


def _wheel(urdf: Urdf, item: Item) -> _Wheel:
    name = item.text()
    joint = urdf.joints.get(name)
    if joint is None:
        turning = [n for n, one in urdf.joints.items() if one.kind in _TURNING]
        known = f"joints that turn: {', '.join(turning) or 'none'}"
        hint = did_you_mean(name, turning) or known
        raise item.error(f"{urdf.root.source} has no joint '{name}'", hint)
    _check_axis(urdf, joint)
    link = urdf.links[joint.child]
    round_parts = [p for p in link.parts if isinstance(p.shape, Cylinder | Sphere)]
    largest = max(round_parts, key=_radius, default=None)
    if largest is None:
        return _Wheel(name, joint.child, link.frame.position)
    if isinstance(largest.shape, Cylinder) and abs(axes(largest.rotation)[2][1]) < _PARALLEL:
        what = f"the cylinder of the wheel '{joint.child}' does not lie along its axle"
        hint = 'rpy="1.5708 0 0" in its <origin> turns it, where the axle is y'
        raise link.element.error(what, hint)
    return _Wheel(name, joint.child, largest.position, _radius(largest), largest)


def _check_axis(urdf: Urdf, joint: Joint) -> None:
    if joint.kind not in _TURNING:
        raise joint.element.error(f"{joint.element} is {joint.kind}: a wheel's is continuous")
    axis = joint.element.child("axis")
    own = axis.vector("xyz") if axis else (1.0, 0.0, 0.0)
    size = math.hypot(*own)
    if not size or abs(rotate(own, urdf.links[joint.child].frame.rotation)[1]) / size < _PARALLEL:
        what = f"{joint.element} does not turn about the y axis of base_link, as wheels do"
        raise joint.element.error(what, 'give it <axis xyz="0 1 0"/>')


def _radius(part: Part) -> float:
    return part.shape.radius if isinstance(part.shape, Cylinder | Sphere) else 0.0


def _check_sides(item: Item, left: Sequence[_Wheel], right: Sequence[_Wheel]) -> None:
    for side, wheels in (("left", left), ("right", right)):
        if not wheels:
            raise item.error(f"'{side}' names no joint")
    if twice := given_twice([wheel.joint for wheel in (*left, *right)]):
        raise item.error(f"the joint '{twice}' is given twice")
    if min(w.centre[1] for w in left) <= max(w.centre[1] for w in right):
        raise item.error("the left wheels are not to the left (y) of the right ones", "swap them?")


def _common_radius(item: Item, wheels: Iterable[_Wheel]) -> float:
    """Return the wheels' radius [m]; refuse radii that differ by more than 1 %."""
    radii = {wheel.joint: wheel.radius for wheel in wheels}
    for joint, radius in radii.items():
        if not radius:
            raise item.error(f"the wheel of '{joint}' has no round shape", "set wheel_radius")
    smallest, largest = min(radii.values()), max(radii.values())
    if largest > 1.01 * smallest:
        what = f"the wheels have radii from {smallest:g} to {largest:g} m"
        raise item.error(what, "set wheel_radius")
    return largest


def _body(
    urdf: Urdf, contacts: Sequence[tuple[float, float]], middle: Vector, radius: float
) -> Body:
    """Return the body of all links together.

    ``middle`` is the wheels', on the ground, in base_link; ``contacts`` are relative to it [m].
    """
    inertials = [link.inertial for link in urdf.links.values() if link.inertial]
    mass, centre = centre_of_mass(inertials)
    if not mass:
        raise urdf.root.error("no link has a mass", "give base_link an <inertial>")
    inertia = moments(inertials, (middle[0], middle[1], centre[2]))
    if min(inertia) <= 0:
        raise urdf.root.error("the moments of inertia must be above 0")
    linked = _placed(urdf, middle)
    if not linked:
        raise urdf.root.error("no link has a shape", "boxes, cylinders and spheres are supported")
    parts = tuple(_lifted(urdf, name, part) for name, part in linked)
    height = centre[2] - middle[2]
    if height <= 0:
        raise urdf.root.error("the centre of mass lies below the ground under the wheels")
    reach = max(abs(part.position[0]) + part.extent(0) for part in parts)
    # Casters etc.
    supports = [part.position[:2] for _, part in linked if _lowest(part) < _NEAR_GROUND]
    return Body(
        mass=mass,
        inertia=inertia,
        centre_of_mass=height,
        base_height=-middle[2],
        parts=parts,
        feet=_feet([*contacts, *supports], reach),
        foot_radius=min(0.05, radius / 2),
    )


def _placed(urdf: Urdf, middle: Vector) -> list[tuple[str, Part]]:
    """Return all parts in base_footprint, each with the name of its link."""
    parts = [(name, part) for name, link in urdf.links.items() for part in link.parts]
    return [(name, part.placed(scaled(middle, -1.0))) for name, part in parts]


def _look(urdf: Urdf, wheels: Sequence[_Wheel], middle: Vector) -> Look:
    turning = {wheel.link for wheel in wheels}
    parts = [part for name, part in _placed(urdf, middle) if name not in turning]
    if not parts:
        return Look()  # shown as its body
    return Look(tuple(parts), tuple(_turning(urdf, wheel, middle) for wheel in wheels))


def _turning(urdf: Urdf, wheel: _Wheel, middle: Vector) -> Wheel:
    """Return a wheel for viewers: a cylinder gets spokes, which show its rotation."""
    centre, parts = subtract(wheel.centre, middle), list(urdf.links[wheel.link].parts)
    about = [part.placed(scaled(wheel.centre, -1.0)) for part in parts]
    if wheel.tyre and isinstance(wheel.tyre.shape, Cylinder):
        shape = wheel.tyre.shape
        spoked = detailed_wheel(shape.radius, shape.length, centre, wheel.tyre.color)
        about[(at := parts.index(wheel.tyre)) : at + 1] = spoked.parts
    return Wheel(centre, tuple(about))


def _lowest(part: Part) -> float:
    return part.position[2] - part.extent(2)


def _lifted(urdf: Urdf, name: str, part: Part) -> Part:
    """A part in base_footprint, lifted off the ground; one that reaches far below is refused."""
    lowest = _lowest(part)
    if lowest < -_DEEPEST:
        raise urdf.links[name].element.error(
            f"the link '{name}' reaches {-lowest:.3f} m below the wheels, which then carry nothing"
        )
    return part.placed((0.0, 0.0, max(0.0, _CLEARANCE - lowest)))


def _feet(supports: Iterable[tuple[float, float]], reach: float) -> tuple[tuple[float, float], ...]:
    """Return the points under wheels and casters, and more points to keep the body level.

    A body that stands only between two wheels would tip over their axle; without a support in front
    or behind, a foot is added that the real robot does not have.
    """
    feet = list(dict.fromkeys(supports))
    least = max(reach, 0.05) / 3
    for direction in (1, -1):
        if not any(direction * x >= least / 2 for x, _ in feet):
            feet.append((direction * least, 0.0))
    return tuple(feet)
