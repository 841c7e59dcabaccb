"""The surfaces of solids as seen from the origin: inverse depth as a function of the pixel.

Inverse depth is 1 / depth along the optical axis [1/m]. On any plane it is a linear form of the ray
(x, y, 1): a point t (x, y, 1) of the plane n.p = s has 1/t = n.(x, y, 1) / s. A convex solid is
where inverse depth is at most that of each surface with the eye outside (its ``front``), and at
least that of each surface with the eye inside (its ``back``); the visible surface is the least of
the front. So the picture of a plane costs one addition per pixel, and no division.

A round side, in a frame whose first axis leads from the eye at (-e, 0, 0) to its axis, is hit where
c w^2 - 2 e u w + (u^2 + v^2) = 0, with w the inverse depth, (u, v) the ray there, r the radius and
c = e^2 - r^2 > 0: w = (e u +- sqrt(r^2 u^2 - c v^2)) / c. The root's argument is the product of two
linear forms, and so exact in float32 where the difference of squares would not be. A sphere adds a
third coordinate to v^2.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from lcmtools_sim.vision.solids import CUBOID, CYLINDER, Floats, Solids

_TOUCH = 1e-9  # [m]; an eye this close to a plane counts as inside
Floats32 = npt.NDArray[np.float32]
NOTHING = np.empty((0, 3))


class Surfaces(NamedTuple):
    """One solid's surfaces as linear forms of (x, y, 1), each a row of a (k, 3) array."""

    front: Floats  # planes with the eye outside
    back: Floats  # planes with the eye inside
    # For a round side seen from outside: e u / c, the two factors of the root's argument, and for a
    # sphere the third coordinate.
    side: Floats = NOTHING
    hollow: Floats = NOTHING  # for a round side with the eye inside: e u, u, v and -c


def surfaces(solids: Solids, number: int) -> Surfaces | None:
    """Return the surfaces of a solid in the optical frame; None if the eye is inside it.

    As for the engine's rays, a solid is invisible from within: a camera sees out of its housing.
    """
    axes, centre = solids.axes[number], solids.centres[number]
    half, kind = solids.half_sizes[number], solids.kinds[number]
    eye = -(centre @ axes)
    if kind == CUBOID:
        planes = _planes(axes, eye, half)
        return planes if len(planes.front) else None
    if kind == CYLINDER:
        return _cylinder(axes, eye, half)
    return _sphere(centre, float(half[0]))


def ground(height: float, up: Floats) -> Floats | None:
    """Return the ground's linear form for an eye ``height`` [m] above it; None from below."""
    return -up / height if height > _TOUCH else None


def _planes(axes: Floats, eye: Floats, half: Floats) -> Surfaces:
    """Return the two planes across each of these axes (columns), ``half`` [m] from the centre."""
    room = np.concatenate((half - eye, half + eye))
    normals = np.concatenate((axes.T, -axes.T))
    is_front = room < -_TOUCH
    forms = normals / np.where(is_front, room, np.maximum(room, _TOUCH))[:, None]
    return Surfaces(forms[is_front], forms[~is_front])


def _cylinder(axes: Floats, eye: Floats, half: Floats) -> Surfaces | None:
    caps = _planes(axes[:, 2:], eye[2:], half[2:])
    away, radius = float(np.hypot(eye[0], eye[1])), float(half[0])
    inwards = -eye[:2] / away if away else np.array((1.0, 0.0))
    u = axes[:, :2] @ inwards
    v = axes[:, :2] @ np.array((-inwards[1], inwards[0]))
    if away > radius + _TOUCH:
        return caps._replace(side=_side(u, v, away, radius))
    if not len(caps.front):
        return None
    depth = max((radius - away) * (radius + away), _TOUCH)
    return caps._replace(hollow=np.stack((away * u, u, v, np.array((0, 0, depth)))))


def _sphere(centre: Floats, radius: float) -> Surfaces | None:
    away = float(np.linalg.norm(centre))
    if away <= radius + _TOUCH:
        return None
    u = centre / away
    v = np.cross(u, np.eye(3)[np.argmin(np.abs(u))])
    v /= np.linalg.norm(v)
    third = np.cross(u, v) / np.sqrt((away - radius) * (away + radius))
    return Surfaces(NOTHING, NOTHING, np.vstack((_side(u, v, away, radius), third)))


def _side(u: Floats, v: Floats, away: float, radius: float) -> Floats:
    """The forms of a round side seen from outside, scaled so that the root needs no factor."""
    square = (away - radius) * (away + radius)
    middle = away * u / square
    width, slope = radius * u / square, v / np.sqrt(square)
    return np.stack((middle, width - slope, width + slope))


def evaluate(form: Floats, x: Floats, y: Floats, out: Floats32 | None = None) -> Floats32:
    """Evaluate a linear form for the rays (x[i], y[j], 1): (len(y), len(x)) float32."""
    a, b, c = form
    rows = (b * y + c).astype(np.float32)
    result: Floats32 = np.add(rows[:, None], (a * x).astype(np.float32), out=out)
    return result


def hollow_exit(along: Floats32, u: Floats32, v: Floats32, depth: Floats32) -> Floats32:
    """Return the inverse depth of leaving an infinite cylinder through its side, from inside it.

    Args:
        along: e u, with e the distance from the axis [m].
        u: Component of the ray towards the axis.
        v: Component of the ray across.
        depth: r^2 - e^2 [m^2].
    """
    square = u * u + v * v
    root = np.sqrt(along * along + square * depth)
    # Of two forms of the same root, use the one without a difference of nearly equal numbers.
    return np.where(along > 0, square / (root + along), (root - along) / depth)
