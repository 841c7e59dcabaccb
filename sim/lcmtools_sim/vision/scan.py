"""How far the rays of one scanner go: exact as rays.py, and fast for many solids at once.

The rays lie in one plane, whose directions are complex numbers here: forward is 1, left is i.
Nearness is 1 / distance, as in surfaces.py, and on a plane it is a linear form f of the ray r:
Re(f r*), r* being the conjugate. A convex solid is hit where the least nearness of its surfaces
with the eye outside is more than the greatest of the others. So a face f of a box is what is seen
where Re((f - g) r*) > 0 for each plane g with the eye inside, and Re((g - f) r*) > 0 for each
other face g. All of these are half turns, and together an arc: the rays in it need no test, and
others cost nothing. Cylinders and balls are tested within the arcs of the balls around them.

What takes the time is the number of calls of numpy; hence all solids together.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lcmtools_sim.rotation import Quaternion, Vector, axes, subtract
from lcmtools_sim.vision.rounds import TOUCH, Complex, Numbers, Rounds, Sight
from lcmtools_sim.vision.solids import CUBOID, Floats, Solids, joined

_EDGE = 1e-12  # [rad] that arcs reach over, or a ray could slip through where two of them meet
_MANY = 50  # boxes; with so many it pays to look which are in reach
_TINY = 1e-300
_QUARTERS = np.array(((-math.pi / 2,), (math.pi / 2,)))  # of a turn


@dataclass(frozen=True, slots=True, eq=False)
class Scannable:
    """Solids that keep together.

    Attributes:
        solids: In a frame of their own.
        reach: How far anything of them is from its origin, at most [m].
    """

    solids: Solids
    reach: float


Standing = tuple[Scannable, Vector, Quaternion]
"""A group, and where its frame is in the world."""


def scannable(solids: Solids) -> Scannable:
    """A group of solids; their ground is not in it."""
    reach = _norms(solids.centres) + _norms(solids.half_sizes)
    return Scannable(solids, float(reach.max(initial=0.0)))


class Scanner:
    """Rays from one point, all in one plane.

    Args:
        angles: (n,) of the rays in the scanner's x-y plane [rad], rising or falling.
        longest: What is farther is not seen [m].
    """

    def __init__(self, angles: Floats, longest: float) -> None:
        self._longest = longest
        self._is_falling = bool(angles[-1] < angles[0])
        self._angles = angles[::-1].copy() if self._is_falling else angles
        self._rays = np.exp(-1j * self._angles)
        first, last = self._angles[0] / math.tau, self._angles[-1] / math.tau
        # Arcs are within a turn of 0, either way; rays can be in them some turns further.
        turns = math.tau * np.arange(math.ceil(first) - 1, math.floor(last) + 2)
        self._turns = np.array((turns - _EDGE, turns + _EDGE))[:, None]
        self._groups: tuple[Scannable, ...] = ()
        self._crowd: _Crowd | None = None

    def scan(self, eye: Vector, rotation: Quaternion, standing: Sequence[Standing]) -> Floats:
        """Distances to what is hit first [m], inf where nothing is within the longest.

        A solid in which the eye is, is not seen. The plane z = 0 is the ground.

        Args:
            eye: Where all rays start [m].
            rotation: Of the scanner.
            standing: What there is.
        """
        forward, left, _ = axes(rotation)
        inverse_depth = np.full(len(self._rays), 0.5 / self._longest)  # too far to be seen
        if TOUCH < eye[2] <= self._longest * math.hypot(forward[2], left[2]):
            ground = complex(forward[2], left[2]) / -eye[2]
            np.maximum(inverse_depth, (ground * self._rays).real, out=inverse_depth)
        near = [one for one in standing if math.dist(one[1], eye) <= self._longest + one[0].reach]
        if near:
            views = [number for one in near for number in _view(one, eye, forward, left)]
            crowd = self._together(tuple([group for group, _, _ in near]))
            self._draw(inverse_depth, crowd, np.array(views).reshape(-1, 3, 3))
        distances: Floats = 1 / inverse_depth
        distances[distances > self._longest] = np.inf
        return distances[::-1] if self._is_falling else distances

    def _together(self, groups: tuple[Scannable, ...]) -> "_Crowd":
        """These groups prepared; mostly they are those of the last scan."""
        if self._crowd is None or groups != self._groups:
            self._groups, self._crowd = groups, _Crowd(groups)
        return self._crowd

    def _draw(self, inverse_depth: Floats, crowd: "_Crowd", views: Floats) -> None:
        """Raise the nearness to that of solids, when their groups are seen so."""
        boxes, rounds = slice(crowd.boxes), slice(crowd.boxes, None)
        seen = crowd.seen(views, self._longest)
        faces, arcs = _faces(seen.only(boxes))
        if crowd.rounds:
            arcs = np.concatenate((arcs, crowd.rounds.arcs(seen.only(rounds))), axis=1)
        ray, arc = self._rays_within(arcs)
        rays, flat = self._rays.take(ray), int(arc.searchsorted(len(faces)))
        entered: Floats = (faces.take(arc[:flat]) * rays[:flat]).real
        if crowd.rounds and flat < len(arc):
            solid = arc[flat:] - len(faces)
            sides = crowd.rounds.entered(seen.only(rounds), solid, rays[flat:])
            entered = np.concatenate((entered, sides))
        np.maximum.at(inverse_depth, ray, entered)

    def _rays_within(self, arcs: Floats) -> tuple[Numbers, Numbers]:
        """The numbers of the rays in all arcs (2, n) [rad], and those of the arcs, which rise."""
        starts, stops = self._angles.searchsorted((arcs[:, :, None] + self._turns).reshape(2, -1))
        counts = np.maximum(stops - starts, 0)
        arc = np.arange(len(counts)).repeat(counts)
        ray = np.arange(len(arc)) + (stops - np.add.accumulate(counts)).take(arc)
        return ray, arc // self._turns.shape[2]


class _Crowd:
    """Solids of several groups, prepared: boxes first, and all with six planes.

    Args:
        groups: The solids', each in a frame of its own.

    Attributes:
        boxes: How many are boxes.
        rounds: The others; None where there are none.
    """

    def __init__(self, groups: Sequence[Scannable]) -> None:
        solids = joined(*(group.solids for group in groups))
        owners = np.arange(len(groups)).repeat([len(group.solids) for group in groups])
        order = (solids.kinds != CUBOID).argsort(kind="stable")
        kinds, turns, half = solids.kinds[order], solids.axes[order], solids.half_sizes[order]
        self.boxes = int((kinds == CUBOID).sum())
        self.rounds = (
            Rounds(kinds[self.boxes :], half[self.boxes :]) if self.boxes < len(order) else None
        )
        self._owners = owners[order]
        self._normals = np.concatenate((turns, -turns), axis=2)
        middles = np.einsum("ni,nik->kn", solids.centres[order], self._normals)
        self._offsets = middles + np.concatenate((half, half), axis=1).T

    def seen(self, views: Floats, longest: float) -> Sight:
        """The solids when their groups are seen so (groups, 3, 3), rows as of ``_view``.

        Boxes farther than ``longest`` [m] may have no faces, as if the eye were inside.
        """
        eyes, forward, left = (views.take(self._owners, axis=0) @ self._normals).transpose(1, 2, 0)
        room, slopes = self._offsets - eyes, forward + 1j * left
        is_outside = room < -TOUCH
        forms = slopes / np.where(is_outside, room, np.maximum(room, TOUCH))
        if self.boxes > _MANY:
            is_outside[:, : self.boxes] &= np.minimum.reduce(room[:, : self.boxes]) >= -longest
        return Sight(room, slopes, is_outside, forms)


def _faces(boxes: Sight) -> tuple[Complex, Floats]:
    """The faces (n,) as linear forms, and the arcs (2, n) where each of them is seen [rad]."""
    _, _, is_face, forms = boxes
    box = is_face.nonzero()[1]
    faces, signs = forms[is_face], np.where(is_face, -1.0, 1.0)
    bounds = (faces - forms.take(box, axis=1)) * (signs.take(box, axis=1) * faces.conj())
    # Away from the face's own direction; itself, 0 or -0, bounds nothing.
    turned = np.arctan2(bounds.imag, bounds.real + _TINY)
    arcs = np.array((np.maximum.reduce(turned), np.minimum.reduce(turned)))
    arcs += np.arctan2(faces.imag, faces.real) + _QUARTERS
    return faces, arcs


def _view(standing: Standing, eye: Vector, forward: Vector, left: Vector) -> list[float]:
    """The eye and the scanner's axes as a group's own frame has them, one after the other."""
    _, position, rotation = standing
    frame = axes(rotation)
    seen = subtract(eye, position), forward, left
    return [x * a + y * b + z * c for x, y, z in seen for a, b, c in frame]


def _norms(vectors: Floats) -> Floats:
    """The lengths of vectors (n, 3)."""
    lengths: Floats = np.sqrt((vectors * vectors).sum(axis=1))
    return lengths
