"""Solid shapes, of which worlds and robots consist, with their mass and inertia.

Terms are those of textbooks: the inertia tensor about the centre of mass, and the parallel
axis theorem (Steiner) for any other point.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools_sim.geometry import IDENTITY, ZERO, Frame, Quaternion, Vector, axes, dot, subtract

Color = tuple[float, float, float]  # red, green, blue, 0 to 1
GREY: Color = (0.6, 0.6, 0.62)


@dataclass(frozen=True, slots=True)
class Cuboid:
    """A box about its centre: length (x), width (y) and height (z) [m]."""

    size: Vector


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder along z, about its centre [m]."""

    radius: float
    length: float

    @property
    def size(self) -> Vector:
        """The dimensions of the box around it [m]."""
        return 2 * self.radius, 2 * self.radius, self.length


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere about its centre [m]."""

    radius: float

    @property
    def size(self) -> Vector:
        """The dimensions of the box around it [m]."""
        return 2 * self.radius, 2 * self.radius, 2 * self.radius


Shape: TypeAlias = Cuboid | Cylinder | Sphere


@dataclass(frozen=True, slots=True)
class Part:
    """A shape at a pose: the position of its centre [m] and the rotation of its axes."""

    shape: Shape
    position: Vector = ZERO
    rotation: Quaternion = IDENTITY
    color: Color = GREY

    def placed(self, position: Vector, rotation: Quaternion = IDENTITY) -> "Part":
        """Return the part in an outer frame in which its own frame has this pose."""
        place = Frame(position, rotation).place(Frame(self.position, self.rotation))
        return Part(self.shape, *place, self.color)

    def extent(self, axis: int) -> float:
        """The distance from the centre to the farthest point along an axis of the frame [m]."""
        shape = self.shape
        if isinstance(shape, Sphere):
            return shape.radius
        columns = [column[axis] for column in axes(self.rotation)]
        if isinstance(shape, Cuboid):
            return sum(abs(c) * side / 2 for c, side in zip(columns, shape.size, strict=True))
        along = abs(columns[2])
        return shape.radius * math.sqrt(max(0.0, 1 - along * along)) + shape.length / 2 * along


@dataclass(frozen=True, slots=True)
class Line:
    """A line on the ground: (x, y) of its points [m], its width [m] and its colour."""

    points: tuple[tuple[float, float], ...]
    width: float
    color: Color


@dataclass(frozen=True, slots=True)
class Inertial:
    """The mass properties of one body."""

    mass: float  # [kg]
    frame: Frame  # at the centre of mass, with the axes of the tensor
    # Inertia xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2].
    tensor: tuple[float, float, float, float, float, float] = (0.0,) * 6


def is_possible(inertial: Inertial) -> bool:
    """Return whether a body can have this inertia, within 1 %, as files have rounded numbers.

    Its second moments of mass must not be negative about any axis: neither are principal moments
    of inertia then, nor is one of them larger than the sum of the others.
    """
    xx, yy, zz, xy, xz, yz = inertial.tensor
    half = (xx + yy + zz) / 2
    a, b, c = (half * 1.01 - moment for moment in (xx, yy, zz))
    minors = a, b, c, a * b - xy * xy, a * c - xz * xz, b * c - yz * yz
    determinant = a * b * c - 2 * xy * xz * yz - a * yz * yz - b * xz * xz - c * xy * xy
    return min(*minors, determinant) >= 0


def inertials_of(parts: Sequence[Part], mass: float) -> list[Inertial]:
    """Return the mass properties of parts of one homogeneous material with this total mass [kg]."""
    density = mass / sum(_volume(part.shape) for part in parts)
    return [_inertial(part, density) for part in parts]


def centre_of_mass(bodies: Iterable[Inertial]) -> tuple[float, Vector]:
    """Return the total mass [kg] and the common centre; without mass, the origin."""
    bodies = list(bodies)
    mass = sum(body.mass for body in bodies)
    if not mass:
        return 0.0, ZERO
    x, y, z = (sum(body.mass * body.frame.position[i] for body in bodies) / mass for i in range(3))
    return mass, (x, y, z)


def moments(bodies: Iterable[Inertial], point: Vector) -> Vector:
    """Return the moments of inertia of all bodies about x, y, z through a point [kg m^2]."""
    found = [_moments(body, point) for body in bodies]
    x, y, z = (sum(values) for values in zip(*found, strict=True))
    return x, y, z


def _moments(body: Inertial, point: Vector) -> Vector:
    xx, yy, zz, xy, xz, yz = body.tensor
    lever = subtract(body.frame.position, point)
    rows = zip(*axes(body.frame.rotation), strict=True)
    x, y, z = (
        (a * a * xx + b * b * yy + c * c * zz + 2 * (a * b * xy + a * c * xz + b * c * yz))
        + body.mass * (dot(lever, lever) - d * d)
        for (a, b, c), d in zip(rows, lever, strict=True)
    )
    return x, y, z


def _inertial(part: Part, density: float) -> Inertial:
    mass = density * _volume(part.shape)
    xx, yy, zz = (mass * value for value in _unit_moments(part.shape))
    return Inertial(mass, Frame(part.position, part.rotation), (xx, yy, zz, 0.0, 0.0, 0.0))


def _unit_moments(shape: Shape) -> Vector:
    """Return the moments about a shape's own axes per kg of mass [m^2]."""
    if isinstance(shape, Cuboid):
        xx, yy, zz = (length * length / 12 for length in shape.size)
        return yy + zz, xx + zz, xx + yy
    square = shape.radius * shape.radius
    if isinstance(shape, Cylinder):
        across = square / 4 + shape.length * shape.length / 12
        return across, across, square / 2
    return 0.4 * square, 0.4 * square, 0.4 * square


def _volume(shape: Shape) -> float:
    """Return the volume of a shape [m^3]."""
    if isinstance(shape, Cuboid):
        return math.prod(shape.size)
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius**2 * shape.length
    return 4 / 3 * math.pi * shape.radius**3
