"""Solid shapes as arrays, by their kinds, poses, sizes and colours.

Arrays are prepared once for a group of parts that stay together (the world's walls, the body of a
robot); ``placed`` moves a group, ``joined`` makes one of several.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from lcmtools.forks import cached_property
from lcmtools_sim.geometry import Quaternion, Vector, axes
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Line, Part, Shape, Sphere

Floats = npt.NDArray[np.float64]

CUBOID, CYLINDER, SPHERE = range(3)
_KINDS: dict[type[Shape], int] = {Cuboid: CUBOID, Cylinder: CYLINDER, Sphere: SPHERE}


@dataclass(frozen=True, eq=False)
class Solids:
    """A group of solids in one frame."""

    kinds: npt.NDArray[np.int8]  # (n,) CUBOID, CYLINDER (along its z) or SPHERE
    centres: Floats  # (n, 3) [m]
    axes: Floats  # (n, 3, 3) rotation matrices; the columns are the solid's axes
    half_sizes: Floats  # (n, 3) [m] from the centre to the sides, along its axes
    colors: Floats  # (n, 3) red, green, blue, 0 to 1
    # The colour of the plane z = 0, below which everything is solid; None for no ground.
    ground: Color | None = None
    lines: tuple[Line, ...] = ()  # painted on the ground, in the world

    def __len__(self) -> int:
        """Return the number of solids, without the ground."""
        return len(self.kinds)

    @cached_property
    def reach(self) -> float:
        """An upper bound of the distance of the solids' points from the frame's origin [m]."""
        lengths = np.linalg.norm(self.centres, axis=1) + np.linalg.norm(self.half_sizes, axis=1)
        return float(lengths.max(initial=0.0))

    def placed(self, position: Vector, rotation: Quaternion) -> "Solids":
        """Return the group in an outer frame in which its own frame has this pose."""
        turn = matrix(rotation)
        centres = self.centres @ turn.T + np.array(position)
        return replace(self, centres=centres, axes=turn @ self.axes)

    def seen_from(self, position: Vector, rotation: Quaternion) -> "Solids":
        """Return the group in the frame of an eye at this pose: the inverse of ``placed``."""
        turn = matrix(rotation)
        centres = (self.centres - np.array(position)) @ turn
        return replace(self, centres=centres, axes=turn.T @ self.axes)


PlacedSolids = tuple[Solids, Vector, Quaternion]
"""Solids that stay together, and the pose of their frame in the world."""


def solids_of(
    parts: Sequence[Part], ground: Color | None = None, lines: tuple[Line, ...] = ()
) -> Solids:
    """Return a group of parts, in order."""
    return Solids(
        kinds=np.array([_KINDS[type(part.shape)] for part in parts], np.int8),
        centres=_array([part.position for part in parts], 3),
        axes=_array([axes(part.rotation) for part in parts], 3, 3).transpose(0, 2, 1),
        half_sizes=_array([part.shape.size for part in parts], 3) / 2,
        colors=_array([part.color for part in parts], 3),
        ground=ground,
        lines=lines,
    )


def joined(*groups: Solids) -> Solids:
    """Return all groups as one, in this order; the ground is from the first group that has one."""
    return Solids(
        kinds=np.concatenate([group.kinds for group in groups]),
        centres=np.concatenate([group.centres for group in groups]),
        axes=np.concatenate([group.axes for group in groups]),
        half_sizes=np.concatenate([group.half_sizes for group in groups]),
        colors=np.concatenate([group.colors for group in groups]),
        ground=next((group.ground for group in groups if group.ground is not None), None),
        lines=next((group.lines for group in groups if group.lines), ()),
    )


def matrix(rotation: Quaternion) -> Floats:
    """Return the 3x3 matrix of a rotation."""
    return np.array(axes(rotation)).T


def _array(rows: object, *shape: int) -> Floats:
    """Return rows as an array of this shape, even without any row."""
    return np.array(rows, np.float64).reshape(-1, *shape)
