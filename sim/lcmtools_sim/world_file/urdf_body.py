"""The rigid body of a URDF robot: its mass, its shapes above the ground, and its feet."""

import math
from collections.abc import Sequence

from lcmtools.errors import InvalidFile
from lcmtools_sim.robots.model import Body
from lcmtools_sim.rotation import Vector, axes
from lcmtools_sim.shapes import Cuboid, Part, Sphere
from lcmtools_sim.world_file.frames import Frame
from lcmtools_sim.world_file.inertia import centre_of_mass, moments
from lcmtools_sim.world_file.urdf import Urdf

_CLEARANCE = 0.004
"""[m] All parts hang so far above the ground at least: the feet carry, nothing else touches."""
_DEEPEST = 0.05
"""[m] A part that reaches farther below the wheels would carry the robot instead of them."""
_NEAR_GROUND = 0.01
"""[m] What comes so near to the ground supports the robot."""


def urdf_body(
    urdf: Urdf, contacts: Sequence[tuple[float, float]], middle: Vector, radius: float
) -> Body:
    """The body of all links together.

    Args:
        urdf: The robot.
        contacts: (x, y) where its wheels touch the ground, about ``middle`` [m].
        middle: Of the wheels, on the ground, in base_link.
        radius: Of the wheels [m].

    Raises:
        InvalidFile: It has no mass or no shape, or could not stand on its wheels.
    """
    inertials = [link.inertial for link in urdf.links.values() if link.inertial]
    mass, centre = centre_of_mass(inertials)
    if not mass:
        raise urdf.root.error("no link has a mass", "give base_link an <inertial>")
    inertia = moments(inertials, (middle[0], middle[1], centre[2]))
    if min(inertia) <= 0:
        raise urdf.root.error("the moments of inertia must be above 0")
    parts = tuple(part for _, part in _grounded_parts(urdf, middle))
    if not parts:
        raise urdf.root.error("no link has a shape", "boxes, cylinders and spheres are taken")
    height = centre[2] - middle[2]
    if height <= 0:
        raise urdf.root.error("the centre of mass lies below the ground on which the wheels stand")
    reach = max(abs(part.position[0]) + _extent(part, 0) for part in parts)
    return Body(
        mass=mass,
        inertia=inertia,
        centre_of_mass=height,
        base_height=-middle[2],
        parts=parts,
        feet=_feet(contacts, _supports(urdf, middle), reach),
        foot_radius=min(0.05, radius / 2),
    )


def _grounded_parts(urdf: Urdf, middle: Vector) -> list[tuple[str, Part]]:
    """All parts in base_footprint with their links' names; what touches the ground is lifted.

    Raises:
        InvalidFile: One reaches far below the wheels.
    """
    found = []
    for name, part in _parts(urdf, middle):
        lowest = part.position[2] - _extent(part, 2)
        if lowest < -_DEEPEST:
            raise _too_low(urdf, name, -lowest)
        x, y, z = part.position
        lift = max(0.0, _CLEARANCE - lowest)
        found.append((name, Part(part.shape, (x, y, z + lift), part.rotation, part.color)))
    return found


def _too_low(urdf: Urdf, name: str, depth: float) -> InvalidFile:
    return urdf.links[name].element.error(
        f"the link '{name}' reaches {depth:.3f} m below the wheels, which then carry nothing"
    )


def _parts(urdf: Urdf, middle: Vector) -> list[tuple[str, Part]]:
    to_footprint = Frame().moved(middle)
    return [
        (name, to_footprint.part(part)) for name, link in urdf.links.items() for part in link.parts
    ]


def _supports(urdf: Urdf, middle: Vector) -> list[tuple[float, float]]:
    """Where casters and the like come down to the ground."""
    return [
        (part.position[0], part.position[1])
        for _, part in _parts(urdf, middle)
        if part.position[2] - _extent(part, 2) < _NEAR_GROUND
    ]


def _feet(
    wheels: Sequence[tuple[float, float]], supports: list[tuple[float, float]], reach: float
) -> tuple[tuple[float, float], ...]:
    """Where the body stands: under its wheels and casters, and level.

    What lies between two wheels would tip over their axle; where nothing supports it in front or
    behind, a foot is added that no real robot has.
    """
    feet = list(dict.fromkeys([*wheels, *supports]))
    least = max(reach, 0.05) / 3
    for direction in (1, -1):
        if not any(direction * x >= least / 2 for x, _ in feet):
            feet.append((direction * least, 0.0))
    return tuple(feet)


def _extent(part: Part, axis: int) -> float:
    """How far a part reaches from its middle along an axis of the frame [m]."""
    shape = part.shape
    if isinstance(shape, Sphere):
        return shape.radius
    columns = [column[axis] for column in axes(part.rotation)]
    if isinstance(shape, Cuboid):
        return sum(abs(c) * side / 2 for c, side in zip(columns, shape.size, strict=True))
    along = abs(columns[2])
    return shape.radius * math.sqrt(max(0.0, 1 - along * along)) + shape.length / 2 * along
