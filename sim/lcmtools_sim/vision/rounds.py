"""Cylinders and balls as the rays of a scan meet them; scan.py says what nearness and forms are.

With e the eye as seen from the axis, across it (from the middle, for a ball), r the ray there and
R the radius, a round side is t away where |e + t r| = R. So its nearness w = 1 / t solves
c w^2 + 2 (e.r) w + |r|^2 = 0, with c = |e|^2 - R^2: w = m +- sqrt(m^2 - |r|^2 / c). There
m = -(e.r) / c is a linear form of the ray, and |r|^2 is 1 - p^2, p being the ray's part along the
axis, another one (0 for a ball).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from lcmtools_sim.vision.solids import SPHERE, Floats

TOUCH = 1e-9  # [m]; an eye so near to a surface is inside it

Complex = npt.NDArray[np.complex128]
Mask = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.intp]


class Sight(NamedTuple):
    """Solids as they are seen in one scan, by their planes across their axes: three, then opposite.

    Attributes:
        room: (6, n) how far it is from the eye to each plane, along the normal outwards [m].
        slopes: (6, n) the part of a ray along it, as linear forms.
        is_outside: (6, n) whether the eye is outside the plane.
        forms: (6, n) its nearness, as linear forms.
    """

    room: Floats
    slopes: Complex
    is_outside: Mask
    forms: Complex

    def only(self, part: slice) -> "Sight":
        """Some of the solids."""
        return Sight(
            self.room[:, part],
            self.slopes[:, part],
            self.is_outside[:, part],
            self.forms[:, part],
        )


class Rounds:
    """Cylinders and balls.

    Args:
        kinds: (n,) CYLINDER or SPHERE.
        half_sizes: (n, 3) [m]
    """

    def __init__(self, kinds: npt.NDArray[np.int8], half_sizes: Floats) -> None:
        radii = half_sizes[:, 0]
        is_ball = kinds == SPHERE
        self._reach = np.where(is_ball, radii, np.hypot(radii, half_sizes[:, 2]))
        self._half_sizes = half_sizes.T
        self._square, self._touch = radii**2, TOUCH * radii
        self._across = np.stack((np.ones_like(radii), np.ones_like(radii), is_ball))
        self._along = np.where(is_ball, 0.0, 1.0)

    def arcs(self, sight: Sight) -> Floats:
        """Where the balls around them begin and end (2, n) [rad]; all around if the eye is near."""
        middles = np.add.reduce((sight.room[:3] - self._half_sizes) * sight.slopes[:3])
        sines = self._reach / np.maximum(np.abs(middles), TOUCH)
        widths = np.where(sines < 1, np.arcsin(np.minimum(sines, 1.0)), math.pi)
        angles = np.arctan2(middles.imag, middles.real)
        return np.array((angles - widths, angles + widths))

    def entered(self, sight: Sight, solid: Numbers, rays: Complex) -> Floats:
        """The nearness (k,) where each of these rays enters the solid of this number, or 0."""
        eyes = self._half_sizes - sight.room[:3]
        across = eyes * self._across
        square = np.add.reduce(across * eyes) - self._square
        is_outside = square > self._touch
        square = np.where(is_outside, square, np.minimum(square, -self._touch))
        middle = -np.add.reduce(across * sight.slopes[:3]) / square
        forms = np.concatenate(((middle, sight.slopes[2] * self._along), sight.forms[2::3]))
        values = (forms.take(solid, axis=1) * rays).real
        middles, surfaces = values[0], values[1:]
        # Where a ray misses there is no root; with 0 it leaves where it enters.
        root = np.sqrt(np.maximum(middles**2 - (1 - surfaces[0] ** 2) / square.take(solid), 0.0))
        surfaces[0] = middles + root
        is_front = np.concatenate((is_outside[None], sight.is_outside[2::3])).take(solid, axis=1)
        enter = np.minimum.reduce(np.where(is_front, surfaces, np.inf))
        leave = np.maximum.reduce(np.where(is_front, -np.inf, surfaces))
        np.maximum(leave, middles - root, out=leave)  # which is behind the eye inside of the side
        return np.where((enter > leave) & (enter < np.inf), enter, 0.0)
