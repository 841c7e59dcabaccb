"""What there is to be seen: solid shapes as arrays, and the ground.

Only where things are and how they look; who looks is not known here. Arrays are prepared once for
a group of parts that keep together (the world's walls, the body of a robot); ``placed`` moves a
group, ``joined`` makes one of several.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from lcmtools_sim.rotation import Quaternion, Vector, axes
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part, Shape, Sphere

Floats = npt.NDArray[np.float64]

CUBOID, CYLINDER, SPHERE = range(3)


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """A group of solids in one frame.

    Attributes:
        kinds: (n,) CUBOID, CYLINDER (along its z) or SPHERE.
        centres: (n, 3) [m].
        axes: (n, 3, 3) rotation matrices; the columns are the solid's axes.
        half_sizes: (n, 3) [m] from the centre to the sides along its axes.
        colors: (n, 3) red, green, blue, 0 to 1.
        ground: The colour of the plane z = 0, which is solid below; None where there is none.
    """

    kinds: npt.NDArray[np.int8]
    centres: Floats
    axes: Floats
    half_sizes: Floats
    colors: Floats
    ground: Color | None = None

    def __len__(self) -> int:
        """How many solids, the ground not counted."""
        return len(self.kinds)

    def only(self, mask: npt.NDArray[np.bool_]) -> "Solids":
        """Those of the group where ``mask`` (n,) is true, without the ground."""
        return Solids(
            self.kinds[mask],
            self.centres[mask],
            self.axes[mask],
            self.half_sizes[mask],
            self.colors[mask],
        )

    def placed(self, position: Vector, rotation: Quaternion) -> "Solids":
        """The group as it is in the world when its frame is at this pose there."""
        turn = matrix(rotation)
        return replace(
            self, centres=self.centres @ turn.T + np.array(position), axes=turn @ self.axes
        )

    def seen_from(self, position: Vector, rotation: Quaternion) -> "Solids":
        """The group in the frame of an eye at this pose: the inverse of ``placed``."""
        turn = matrix(rotation)
        return replace(
            self, centres=(self.centres - np.array(position)) @ turn, axes=turn.T @ self.axes
        )


def solids_of(parts: Sequence[Part], ground: Color | None = None) -> Solids:
    """A group of parts, in their order."""
    kinds, sizes = (
        zip(*(_measure(part.shape) for part in parts), strict=True) if parts else ((), ())
    )
    return Solids(
        kinds=np.array(kinds, np.int8),
        centres=_array([part.position for part in parts], 3),
        axes=_array([axes(part.rotation) for part in parts], 3, 3).transpose(0, 2, 1),
        half_sizes=_array(sizes, 3),
        colors=_array([part.color for part in parts], 3),
        ground=ground,
    )


def joined(*groups: Solids) -> Solids:
    """All the groups as one, in this order; the ground is that of the first that has one."""
    grounds = [group.ground for group in groups if group.ground is not None]
    return Solids(
        kinds=np.concatenate([group.kinds for group in groups]),
        centres=np.concatenate([group.centres for group in groups]),
        axes=np.concatenate([group.axes for group in groups]),
        half_sizes=np.concatenate([group.half_sizes for group in groups]),
        colors=np.concatenate([group.colors for group in groups]),
        ground=grounds[0] if grounds else None,
    )


def matrix(rotation: Quaternion) -> Floats:
    """The 3x3 matrix of a rotation."""
    return np.array(axes(rotation)).T


def _measure(shape: Shape) -> tuple[int, Vector]:
    """A shape's kind and half sizes [m]."""
    match shape:
        case Cuboid(size=(length, width, height)):
            return CUBOID, (length / 2, width / 2, height / 2)
        case Cylinder(radius=radius, length=length):
            return CYLINDER, (radius, radius, length / 2)
        case Sphere(radius=radius):
            return SPHERE, (radius, radius, radius)


def _array(rows: object, *shape: int) -> Floats:
    """Rows as an array of this shape, also when there are none."""
    return np.array(rows, np.float64).reshape(-1, *shape)
