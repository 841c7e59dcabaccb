"""How far single rays go: exact distances for lasers, and the truth that pictures are tested with.

Float64, one solid at a time by the textbook's intersections (A. Glassner, An Introduction to Ray
Tracing, chapter 2). Deliberately nothing in common with depth.py but the solids.
"""

import numpy as np
import numpy.typing as npt

from lcmtools_sim.vision.solids import CUBOID, CYLINDER, Floats, Solids

_TOUCH = 1e-9  # [m]; a ray that starts so near to a surface starts on it


def cast(
    solids: Solids, origins: npt.ArrayLike, directions: npt.ArrayLike, longest: float = np.inf
) -> Floats:
    """Distances to the first hit [m], inf where nothing is hit within ``longest`` [m].

    A solid in which a ray starts, or on whose surface, is not hit by it.

    Args:
        solids: In some frame; their ground is z = 0 of it.
        origins: (n, 3) or (3,) [m], in that frame.
        directions: (n, 3), of any length but zero.
        longest: [m]
    """
    rays = np.atleast_2d(np.asarray(directions, np.float64))
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    starts = np.broadcast_to(np.asarray(origins, np.float64), rays.shape)
    distances = np.full(len(rays), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        if solids.ground is not None:
            distances = _within(*_slabs(starts[:, 2:], rays[:, 2:], np.array((-np.inf, 0.0))))
        for number in range(len(solids)):
            np.minimum(distances, _hits(solids, number, starts, rays), out=distances)
    return np.where(distances <= longest, distances, np.inf)


def _hits(solids: Solids, number: int, starts: Floats, rays: Floats) -> Floats:
    """Distances to one solid."""
    axes, half = solids.axes[number], solids.half_sizes[number]
    start, ray = (starts - solids.centres[number]) @ axes, rays @ axes
    kind = solids.kinds[number]
    if kind == CUBOID:
        return _within(*_slabs(start, ray, np.stack((-half, half))))
    if kind == CYLINDER:
        sides = _round(start[:, :2], ray[:, :2], half[0])
        caps = _slabs(start[:, 2:], ray[:, 2:], np.stack((-half[2:], half[2:])))
        return _within(np.maximum(sides[0], caps[0]), np.minimum(sides[1], caps[1]))
    return _within(*_round(start, ray, half[0]))


def _within(enter: Floats, leave: Floats) -> Floats:
    """Where rays enter, unless they miss (leave before, or NaN) or start inside or beyond."""
    return np.where((enter < leave) & (enter > _TOUCH), enter, np.inf)


def _slabs(start: Floats, ray: Floats, ends: Floats) -> tuple[Floats, Floats]:
    """Where rays enter and leave the space between ``ends`` (low, high) on all axes [m]."""
    near, far = (ends[0] - start) / ray, (ends[1] - start) / ray
    parallel = ray == 0
    inside = (start > ends[0]) & (start < ends[1])
    enter = np.where(parallel, np.where(inside, -np.inf, np.inf), np.minimum(near, far))
    leave = np.where(parallel, np.inf, np.maximum(near, far))
    return enter.max(axis=1), leave.min(axis=1)


def _round(start: Floats, ray: Floats, radius: float) -> tuple[Floats, Floats]:
    """Where rays enter and leave a circle or a ball about the origin [m]; NaN where they miss."""
    square = (ray * ray).sum(axis=1)
    towards = -(start * ray).sum(axis=1)
    foot = start + ray * (towards / square)[:, None]
    beyond = radius * radius - (foot * foot).sum(axis=1)
    root = np.sqrt(beyond / square)
    parallel = square == 0
    inside = parallel & ((start * start).sum(axis=1) < radius * radius)
    middle = towards / square
    enter = np.where(parallel, np.nan, middle - root)
    leave = np.where(parallel, np.nan, middle + root)
    return np.where(inside, -np.inf, enter), np.where(inside, np.inf, leave)
