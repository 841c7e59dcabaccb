"""The solid shapes that worlds and robots are made of, as frozen values.

What they weigh and how they move is not known here, nor who looks at them.
"""

from dataclasses import dataclass
from typing import TypeAlias

from lcmtools_sim.rotation import Quaternion, Vector

Color = tuple[float, float, float]
"""Red, green, blue, 0 to 1."""

GREY: Color = (0.6, 0.6, 0.62)
UNTURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Cuboid:
    """A box; its origin is its centre. Attributes: length (x), width (y), height (z) [m]."""

    size: Vector


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder along z; its origin is its centre. Attributes: [m]."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball about its origin. Attributes: [m]."""

    radius: float


Shape: TypeAlias = Cuboid | Cylinder | Sphere


@dataclass(frozen=True, slots=True)
class Part:
    """A shape in its place on a body, or in the world.

    Attributes:
        shape: What it is.
        position: Of its centre [m].
        rotation: Of its axes.
        color: How it looks.
    """

    shape: Shape
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = UNTURNED
    color: Color = GREY
