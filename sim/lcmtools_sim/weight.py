"""Where the weight of solid shapes is, and how they resist turning, as plain mathematics.

Everything is of one material throughout; symbols are those of the textbooks.
"""

import math
from collections.abc import Sequence

from lcmtools_sim.rotation import Vector, axes, dot, subtract
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Shape


def centre_of(parts: Sequence[Part]) -> Vector:
    """The centre of mass of several shapes [m]."""
    volumes = [_volume(part.shape) for part in parts]
    x, y, z = (
        sum(volume * part.position[i] for volume, part in zip(volumes, parts, strict=True))
        / sum(volumes)
        for i in range(3)
    )
    return x, y, z


def moments_of(parts: Sequence[Part], mass: float) -> Vector:
    """Their moments of inertia about x, y, z through the centre of mass [kg m^2].

    Args:
        parts: The shapes.
        mass: Of all together [kg].
    """
    centre, density = centre_of(parts), mass / sum(_volume(part.shape) for part in parts)
    found = [_moments(part, centre, density * _volume(part.shape)) for part in parts]
    x, y, z = (sum(moments) for moments in zip(*found, strict=True))
    return x, y, z


def _moments(part: Part, point: Vector, mass: float) -> Vector:
    """Those of one shape about axes through a point (Steiner)."""
    own, lever = _unit_moments(part.shape), subtract(part.position, point)
    turned = zip(*axes(part.rotation), strict=True)
    x, y, z = (
        mass * (sum(m * c * c for m, c in zip(own, row, strict=True)) + dot(lever, lever) - d * d)
        for row, d in zip(turned, lever, strict=True)
    )
    return x, y, z


def _unit_moments(shape: Shape) -> Vector:
    """About a shape's own axes, of 1 kg [m^2]."""
    if isinstance(shape, Cuboid):
        xx, yy, zz = (length * length / 12 for length in shape.size)
        return yy + zz, xx + zz, xx + yy
    square = shape.radius * shape.radius
    if isinstance(shape, Cylinder):
        across = square / 4 + shape.length * shape.length / 12
        return across, across, square / 2
    return 0.4 * square, 0.4 * square, 0.4 * square


def _volume(shape: Shape) -> float:
    """[m^3]."""
    if isinstance(shape, Cuboid):
        return math.prod(shape.size)
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius**2 * shape.length
    return 4 / 3 * math.pi * shape.radius**3
