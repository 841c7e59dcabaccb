"""The ranges of a laser scanner: rays from one point, all in one plane.

The bounding sphere of a solid cuts the scan's plane in a circle. A solid is tested only with the
rays towards its circle, and all such pairs of a ray and a solid are tested at once, by textbook
intersections (A. Glassner, An Introduction to Ray Tracing, chapter 2): a box is three
slabs, a cylinder or a sphere a quadratic equation. bench/vision.py shows what the circles save.
The pairs of many scanners are tested at once, too.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from lcmtools_sim.geometry import Quaternion, Vector, axes, subtract
from lcmtools_sim.vision.solids import (
    CUBOID,
    SPHERE,
    Floats,
    PlacedSolids,
    Solids,
    joined,
    solids_of,
)

_TOUCH = 1e-9  # [m]; an eye this close to a surface counts as inside
_TINY = 1e-300  # in place of 0 as a divisor
_EDGE = 1 + 1e-12  # a ray through an edge leaves where it enters, except for rounding
_MARGIN = 1e-9  # [rad] by which arcs are widened
_BOUNDING = np.array(((1, 1, 1), (1, 0, 1), (1, 0, 0)))
"""By kind, the half sizes whose squares add up to the square of the bounding sphere's radius."""

_BATCH = 32  # scanners at a time, so that the arrays stay in the processor's cache

Numbers = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]


class Scanner:
    """Rays from one point, all in one plane, up to the longest range [m].

    Their angles (n,) in the scanner's x-y plane [rad] are rising or falling.
    """

    def __init__(self, angles: Floats, longest: float) -> None:
        self._longest = longest
        self._is_falling = bool(angles[-1] < angles[0])
        self._angles = angles[::-1].copy() if self._is_falling else angles
        self._cosines, self._sines = np.cos(self._angles), np.sin(self._angles)
        first, last = self._angles[0] / math.tau, self._angles[-1] / math.tau
        # Arcs are within one turn of 0 in both directions; rays may lie in them some turns further.
        turns = math.tau * np.arange(math.ceil(first) - 1, math.floor(last) + 2)
        self._turns = np.array((turns - _MARGIN, turns + _MARGIN))[:, None]
        self._groups: tuple[Solids, ...] = ()
        self._targets = _targets(())

    def scan(self, eye: Vector, rotation: Quaternion, bodies: Sequence[PlacedSolids]) -> Floats:
        """Return the ranges from an eye [m], inf if nothing is within the longest.

        A solid around the eye is invisible. The plane z = 0 is the ground.
        """
        forward, left, _ = axes(rotation)
        ranges = np.full(len(self._angles), np.inf)
        if _TOUCH < eye[2] <= self._longest * math.hypot(forward[2], left[2]):
            down = -forward[2] * self._cosines - left[2] * self._sines
            np.divide(eye[2], down, out=ranges, where=down > 0)
        near = [body for body in bodies if math.dist(body[1], eye) <= self._longest + body[0].reach]
        if near:
            views = [number for body in near for number in _view(body, eye, forward, left)]
            targets = self._prepared(tuple([solids for solids, _, _ in near]))
            self._measure(ranges, targets, np.array(views).reshape(-1, 3, 3))
        ranges[ranges > self._longest] = np.inf
        return ranges[::-1] if self._is_falling else ranges

    # A body that the engine has lost, at NaN or beyond the range of numbers, is near nothing.
    @np.errstate(invalid="ignore", over="ignore")
    def scan_batch(
        self, eyes: Floats, rotations: Floats, bodies: Sequence[PlacedSolids], own: Numbers
    ) -> Floats:
        """Return the ranges (k, n) of several such scanners, bit for bit as from ``scan``.

        They are at eyes (3, k) [m] with rotations (4, k); ``own`` (k,) is, for each scanner, the
        index among the bodies of the one that it does not see.
        """
        groups, positions, turns = zip(*bodies, strict=True)
        targets, around = self._prepared(groups), _around(groups, positions, turns)
        forward, left, _ = np.array(axes(cast("Quaternion", tuple(rotations))))
        down = -forward[2][:, None] * self._cosines - left[2][:, None] * self._sines
        is_low = eyes[2] <= self._longest * np.hypot(forward[2], left[2])
        where = (down > 0) & (is_low & (eyes[2] > _TOUCH))[:, None]
        ranges = np.full(down.shape, np.inf)
        np.divide(eyes[2][:, None], down, out=ranges, where=where)
        for first in range(0, len(own), _BATCH):
            some = slice(first, first + _BATCH)
            apart, views = around.seen(eyes[:, some], forward[:, some], left[:, some])
            near = apart <= self._longest + around.reaches
            near[np.arange(len(near)), own[some]] = False
            seen = targets.seen_by(near, len(self._angles))
            self._measure(ranges[some].reshape(-1), seen, views)
        ranges[ranges > self._longest] = np.inf
        return ranges[:, ::-1] if self._is_falling else ranges

    def _prepared(self, groups: tuple[Solids, ...]) -> "_Targets":
        """Return these groups prepared; mostly they are the last scan's."""
        if groups != self._groups:
            self._groups, self._targets = groups, _targets(groups)
        return self._targets

    def _measure(self, ranges: Floats, targets: "_Targets", views: Floats) -> None:
        """Reduce the ranges to the distances of the solids, seen from these views of their groups.

        The ranges of all scanners follow one another.
        """
        eye, forward, left = targets.seen(views)
        ray, solid = self._pairs(targets.arcs(eye, forward, left, self._longest))
        along, across = self._cosines.take(ray), self._sines.take(ray)
        rays = forward.take(solid, axis=1) * along + left.take(solid, axis=1) * across
        if targets.first_rays is not None:
            ray += targets.first_rays.take(solid)
        np.minimum.at(ranges, ray, targets.entered(eye.take(solid, axis=1), rays, solid))

    def _pairs(self, arcs: Floats) -> tuple[Numbers, Numbers]:
        """Return all pairs of a ray and an arc (2, n) [rad] that contains it, in order of arcs."""
        starts, stops = self._angles.searchsorted((arcs[:, :, None] + self._turns).reshape(2, -1))
        counts = np.maximum(stops - starts, 0)
        arc = np.arange(len(counts)).repeat(counts)
        ray = np.arange(len(arc)) + (stops - np.add.accumulate(counts)).take(arc)
        return ray, arc // self._turns.shape[2]


@dataclass(frozen=True, slots=True, eq=False)
class _Targets:
    """The solids of several groups, each in its own frame, as arrays: boxes first."""

    owners: Numbers  # (n,) indices of their groups' views
    axes: Floats  # (n, 3, 3) in their groups
    centres: Floats  # (3, n) in their groups [m]
    half_sizes: Floats  # (3, n) [m]
    boxes: int  # the number of boxes
    reach_squares: Floats  # (n,) of the bounding spheres [m^2]
    roundness: Floats  # (3, n) 1 for an axis in which a solid is round, else 0
    first_rays: Numbers | None = None  # (n,) index of the first ray of its scanner

    def seen_by(self, near: Mask, rays: int) -> "_Targets":
        """Return the solids of near groups (k, groups), repeated for each of k scanners."""
        number, scanner = near[:, self.owners].T.nonzero()
        return replace(
            self,
            owners=scanner * near.shape[1] + self.owners.take(number),
            axes=self.axes.take(number, axis=0),
            centres=self.centres.take(number, axis=1),
            half_sizes=self.half_sizes.take(number, axis=1),
            boxes=int(number.searchsorted(self.boxes)),
            reach_squares=self.reach_squares.take(number),
            roundness=self.roundness.take(number, axis=1),
            first_rays=scanner * rays,
        )

    def seen(self, views: Floats) -> tuple[Floats, Floats, Floats]:
        """The eye, forward and left (3, n) in the axes of each solid, relative to its centre.

        ``views`` (groups, 3, 3) has them in the groups' frames, as rows.
        """
        eye, forward, left = (views.take(self.owners, axis=0) @ self.axes).transpose(1, 2, 0)
        return eye - self.centres, forward, left

    def arcs(self, eye: Floats, forward: Floats, left: Floats, longest: float) -> Floats:
        """Return the arcs (2, n) [rad] of the bounding spheres' circles in the plane of the scan.

        An arc ends before it begins for a solid around the eye, without a circle, or without one
        within ``longest`` [m].
        """
        x, y = -np.add.reduce(eye * forward), -np.add.reduce(eye * left)
        square = x * x + y * y
        radius_square = self.reach_squares - np.add.reduce(eye * eye) + square
        distance, radius = np.sqrt(square), np.sqrt(np.maximum(radius_square, 0.0))
        sines = radius / np.maximum(distance, _TOUCH)
        widths = np.where(sines < 1, np.arcsin(np.minimum(sines, 1.0)), math.pi)
        hidden = (radius_square <= 0) | (distance - radius > longest) | self._around(eye)
        widths[hidden] = -1.0
        middles = np.arctan2(y, x)
        return np.array((middles - widths, middles + widths))

    def _around(self, eye: Floats) -> Mask:
        """Return True for each solid that contains or touches the eye."""
        gaps = np.abs(eye) - self.half_sizes
        radial = np.sqrt(np.add.reduce(eye * eye * self.roundness))
        gaps[:2, self.boxes :] = (radial - self.half_sizes[0])[self.boxes :]
        around: Mask = gaps.max(axis=0) <= _TOUCH
        return around

    def entered(self, eye: Floats, rays: Floats, solid: Numbers) -> Floats:
        """The distance (m,) at which each ray (3, m) enters its solid, or inf; by solid."""
        half = self.half_sizes.take(solid, axis=1)
        inverse = 1 / np.where(rays == 0, _TINY, rays)
        middle, reach = -eye * inverse, half * np.abs(inverse)
        enter, leave = middle - reach, middle + reach
        boxes = int(solid.searchsorted(self.boxes))
        found = [_first(enter[:, :boxes].max(axis=0), leave[:, :boxes].min(axis=0))]
        if boxes < len(solid):
            eye, rays, radius = eye[:, boxes:], rays[:, boxes:], half[0, boxes:]
            sides = _round(eye, rays, radius, self.roundness.take(solid[boxes:], axis=1))
            caps = enter[2, boxes:], leave[2, boxes:]
            found.append(_first(np.maximum(sides[0], caps[0]), np.minimum(sides[1], caps[1])))
        return np.concatenate(found)


def _targets(groups: Sequence[Solids]) -> _Targets:
    solids = joined(solids_of(()), *groups)
    order = (solids.kinds != CUBOID).argsort(kind="stable")
    kinds, half, turns = solids.kinds[order], solids.half_sizes[order], solids.axes[order]
    return _Targets(
        owners=np.arange(len(groups)).repeat([len(group) for group in groups])[order],
        axes=turns,
        centres=np.einsum("ni,nij->jn", solids.centres[order], turns),
        half_sizes=half.T.copy(),
        boxes=int((kinds == CUBOID).sum()),
        reach_squares=(half * half * _BOUNDING[kinds]).sum(axis=1),
        # A cylinder is round in x and y, a sphere also in z.
        roundness=np.array((kinds >= 0, kinds >= 0, kinds == SPHERE), np.float64),
    )


class _Around(NamedTuple):
    """The poses of bodies as arrays, and how far each reaches."""

    positions: Floats  # (n, 3) [m]
    frames: Floats  # (3, 3, n) their axes
    reaches: Floats  # (n,) [m]

    def seen(self, eyes: Floats, forward: Floats, left: Floats) -> tuple[Floats, Floats]:
        """The distance (k, n) from each scanner to each body, and its view (k * n, 3, 3) there."""
        offsets = eyes.T[:, None] - self.positions
        apart = np.sqrt(np.einsum("kni,kni->kn", offsets, offsets))
        views = np.empty((*apart.shape, 3, 3))
        for row, vectors in enumerate((offsets, forward.T[:, None], left.T[:, None])):
            x, y, z = np.moveaxis(vectors, -1, 0)
            for axis, (a, b, c) in enumerate(self.frames):
                views[:, :, row, axis] = x * a + y * b + z * c  # as in _view
        return apart, views.reshape(-1, 3, 3)


def _around(
    groups: Sequence[Solids], positions: Sequence[Vector], turns: Sequence[Quaternion]
) -> _Around:
    frames = axes(cast("Quaternion", tuple(np.array(turns).T)))
    return _Around(np.array(positions), np.array(frames), np.array([g.reach for g in groups]))


def _round(eye: Floats, rays: Floats, radius: Floats, roundness: Floats) -> tuple[Floats, Floats]:
    """The distances at which rays enter and leave a cylinder's side or a sphere; NaN for a miss."""
    across = rays * roundness
    square = np.add.reduce(across * rays)
    closest = -np.add.reduce(across * eye) / np.maximum(square, _TINY)
    foot = eye + rays * closest
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt((radius * radius - np.add.reduce(foot * foot * roundness)) / square)
        return closest - root, closest + root


def _first(enter: Floats, leave: Floats) -> Floats:
    """The distance of entering; inf if the ray misses or starts inside or beyond the solid."""
    return np.where((enter <= leave * _EDGE) & (enter > _TOUCH), enter, np.inf)


def _view(body: PlacedSolids, eye: Vector, forward: Vector, left: Vector) -> list[float]:
    """Return the eye and the scanner's axes in a body's own frame, concatenated."""
    _, position, rotation = body
    frame = axes(rotation)
    seen = subtract(eye, position), forward, left
    return [x * a + y * b + z * c for x, y, z in seen for a, b, c in frame]
