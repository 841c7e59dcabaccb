"""How far the rays of one scanner go: exact as rays.py, and fast for many boxes at once.

As in surfaces.py, nearness is 1 / distance and on a plane a linear form of the ray, so that all
planes of all boxes cost one product of matrices. A box is entered at the least nearness of the
planes with the eye outside, and left at the greatest of the others; the ray hits if it enters
first. Round solids are few and left to rays.py. What the scan's plane passes by is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lcmtools_sim.rotation import Quaternion, Vector
from lcmtools_sim.vision.rays import cast
from lcmtools_sim.vision.solids import CUBOID, Floats, Solids, matrix

_TOUCH = 1e-9  # [m]; an eye so near to a plane is inside it


@dataclass(frozen=True, slots=True, eq=False)
class Scannable:
    """Solids that keep together, prepared once; to place them elsewhere costs little.

    Attributes:
        normals: (n, 6, 3) outward, of each box.
        offsets: (n, 6) of its planes from the origin along their normals [m].
        centres: (n, 3) of the boxes [m].
        radii: (n,) of the balls around them [m].
        rounds: All that is no box.
        reach: How far anything of it is from its frame's origin, at most [m].
    """

    normals: Floats
    offsets: Floats
    centres: Floats
    radii: Floats
    rounds: Solids
    reach: float

    def placed(self, position: Vector, rotation: Quaternion) -> "Scannable":
        """The group as it is in the world when its frame is at this pose there."""
        place, turn = np.array(position), matrix(rotation)
        normals = self.normals @ turn.T
        return Scannable(
            normals,
            self.offsets + normals @ place,
            self.centres @ turn.T + place,
            self.radii,
            self.rounds.placed(position, rotation) if len(self.rounds) else self.rounds,
            self.reach,
        )


def scannable(solids: Solids) -> Scannable:
    """A group of solids, prepared; their ground is not in it."""
    boxes = solids.only(solids.kinds == CUBOID)
    axes, half = boxes.axes.transpose(0, 2, 1), boxes.half_sizes
    normals = np.concatenate((axes, -axes), axis=1)
    return Scannable(
        normals,
        np.concatenate((half, half), axis=1) + np.einsum("nki,ni->nk", normals, boxes.centres),
        boxes.centres,
        _norms(half),
        solids.only(solids.kinds != CUBOID),
        float((_norms(solids.centres) + _norms(solids.half_sizes)).max(initial=0.0)),
    )


def scan(
    groups: Sequence[Scannable], eye: Vector, rays: Floats, up: Vector, longest: float
) -> Floats:
    """Distances to what is hit first [m], inf where nothing is within ``longest`` [m].

    A solid in which the eye is, is not seen. The plane z = 0 is the ground.

    Args:
        groups: What stands in the world.
        eye: Where all rays start [m].
        rays: (n, 3) of length 1, all in one plane.
        up: The normal of that plane, of length 1.
        longest: [m]
    """
    place, normal = np.array(eye), np.array(up)
    nearness = np.maximum(-rays[:, 2] / eye[2], 0.0) if eye[2] > _TOUCH else np.zeros(len(rays))
    kept = [_met(group.centres, group.radii, place, normal, longest) for group in groups]
    boxes = [(g.normals[keep], g.offsets[keep]) for g, keep in zip(groups, kept, strict=True)]
    if boxes:
        normals, offsets = (np.concatenate(arrays) for arrays in zip(*boxes, strict=True))
        np.maximum(nearness, _boxes(normals, offsets, place, rays), out=nearness)
    with np.errstate(divide="ignore"):
        distances = 1 / nearness
    for group in groups:
        if len(group.rounds):
            others = _rounds(group.rounds, place, rays, normal, longest)
            np.minimum(distances, others, out=distances)
    return np.where(distances <= longest, distances, np.inf)


def _met(
    centres: Floats, radii: Floats, eye: Floats, up: Floats, longest: float
) -> npt.NDArray[np.bool_]:
    """Which balls the scanned disc can meet."""
    away = centres - eye
    is_met: npt.NDArray[np.bool_] = (_norms(away) <= longest + radii) & (np.abs(away @ up) <= radii)
    return is_met


def _boxes(normals: Floats, offsets: Floats, eye: Floats, rays: Floats) -> Floats:
    """The greatest nearness of boxes along each ray; 0 where none is hit."""
    room = offsets - normals @ eye
    front = room < -_TOUCH
    forms = normals / np.where(front, room, np.maximum(room, _TOUCH))[:, :, None]
    near = (forms.reshape(-1, 3) @ rays.T).reshape(*room.shape, len(rays))
    enter = np.where(front[:, :, None], near, np.inf).min(axis=1)
    leave = np.where(front[:, :, None], -np.inf, near).max(axis=1)
    is_hit = (enter > 0) & (enter > leave) & np.isfinite(enter)
    nearest: Floats = np.where(is_hit, enter, 0.0).max(axis=0, initial=0.0)
    return nearest


def _rounds(solids: Solids, eye: Floats, rays: Floats, up: Floats, longest: float) -> Floats:
    """Distances to cylinders and balls."""
    met = _met(solids.centres, _norms(solids.half_sizes), eye, up, longest)
    return cast(solids.only(met), eye, rays, longest)


def _norms(vectors: Floats) -> Floats:
    """The lengths of vectors (n, 3)."""
    lengths: Floats = np.sqrt((vectors * vectors).sum(axis=1))
    return lengths
