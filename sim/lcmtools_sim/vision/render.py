"""Rendering: depth and the number of the visible solid, pixel by pixel.

Geometry only; colours, noise and encoding are elsewhere. Inverse depth (see surfaces.py) is drawn
solid by solid, each within its bounds, in strips that stay in the processor's cache; the forms are
float64, the pixels float32.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lcmtools_sim.geometry import Quaternion, Vector
from lcmtools_sim.vision.camera import Camera, PixelBounds, pixel_bounds
from lcmtools_sim.vision.solids import Floats, Solids, matrix
from lcmtools_sim.vision.surfaces import Floats32, Surfaces, evaluate, ground, hollow_exit, surfaces

SKY = -2
GROUND = SKY + 1
_STRIP = 1 << 16  # [pixels]


@dataclass(frozen=True, slots=True, eq=False)
class Rendering:
    """The view of a camera from one place."""

    camera: Camera  # its intrinsics
    solids: Solids  # all solids, in the camera's optical frame
    bounds: Sequence[PixelBounds]  # of the solids in view
    turn: Floats  # rotation matrix of the optical frame in the world
    depth: Floats32  # (height, width) float32 along the optical axis [m]; inf for the sky
    # (height, width) int16, the number of the visible solid, GROUND or SKY; empty with only_depth.
    solid: npt.NDArray[np.int16]
    eye: Vector  # position of the camera in the world [m]


# Rays that miss a round side give NaN, and so does a body that the engine has lost.
@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def render(
    solids: Solids,
    camera: Camera,
    position: Vector,
    rotation: Quaternion,
    *,
    only_depth: bool = False,
) -> Rendering:
    """Render solids and the ground.

    Args:
        solids: Solids in the world; those around the eye are invisible.
        camera: The camera's intrinsics.
        position: Position of the optical frame in the world [m].
        rotation: Rotation of the optical frame in the world (see ``camera.optical``).
        only_depth: Do not determine which solid is visible.
    """
    local, turn = solids.seen_from(position, rotation), matrix(rotation)
    picture = _DepthBuffer(camera, only_depth=only_depth)
    form = ground(position[2], turn[2])
    if solids.ground is not None and form is not None:
        picture.fill(form)
    in_view = pixel_bounds(local, camera)
    for bounds in in_view:
        seen = surfaces(local, bounds.number)
        if seen is not None:
            picture.draw(bounds, seen)
    return Rendering(camera, local, in_view, turn, picture.depth(), picture.solid, position)


class _DepthBuffer:
    """Inverse depth and number of the nearest surface so far."""

    def __init__(self, camera: Camera, *, only_depth: bool) -> None:
        shape = camera.height, camera.width
        self._x, self._y = camera.slopes()
        self._inverse_depth = np.zeros(shape, np.float32)  # as for the sky
        self.solid = np.full((0, 0) if only_depth else shape, SKY, np.int16)
        self._buffers = [np.empty(max(_STRIP, camera.width), np.float32) for _ in range(4)]

    def fill(self, form: Floats) -> None:
        """Draw the ground into the empty picture."""
        a, b, c = form
        numbers = np.flatnonzero(b * self._y + c + np.abs(a * self._x).max() > 0)
        if len(numbers):  # rows below the horizon
            rows = slice(numbers[0], numbers[-1] + 1)
            inverse_depth = evaluate(form, self._x, self._y[rows], self._inverse_depth[rows])
            np.maximum(inverse_depth, 0, out=inverse_depth)
            if self.solid.size:  # a sum, because assigning by a mask takes far longer
                np.add(inverse_depth > 0, np.int16(SKY), out=self.solid[rows])

    def draw(self, bounds: PixelBounds, seen: Surfaces) -> None:
        """Draw a solid in front of more distant surfaces."""
        columns = slice(bounds.left, bounds.right)
        height = max(1, _STRIP // (bounds.right - bounds.left))
        for top in range(bounds.top, bounds.bottom, height):
            rows = slice(top, min(top + height, bounds.bottom))
            upper, lower = self._interval(seen, self._x[columns], self._y[rows])
            behind = self._inverse_depth[rows, columns]
            np.maximum(lower, behind, out=lower)
            visible = upper > lower  # False where NaN
            np.copyto(behind, upper, where=visible)
            if self.solid.size:
                np.copyto(self.solid[rows, columns], np.int16(bounds.number), where=visible)

    def depth(self) -> Floats32:
        """Return the depth [m]; it overwrites the buffer."""
        return np.divide(np.float32(1), self._inverse_depth, out=self._inverse_depth)

    def _interval(self, seen: Surfaces, x: Floats, y: Floats) -> tuple[Floats32, Floats32]:
        """The inverse depths of entering and leaving a solid; entering is less or NaN if missed."""
        upper, lower, spare, other = (
            buffer[: len(y) * len(x)].reshape(len(y), len(x)) for buffer in self._buffers
        )
        upper.fill(np.inf)
        lower.fill(0)
        for form in seen.front:
            np.minimum(upper, evaluate(form, x, y, spare), out=upper)
        for form in seen.back:
            np.maximum(lower, evaluate(form, x, y, spare), out=lower)
        if len(seen.side):
            root = _root(seen.side, x, y, (spare, other))
            middle = evaluate(seen.side[0], x, y, other)
            np.minimum(upper, middle + root, out=upper)
            np.maximum(lower, np.subtract(middle, root, out=middle), out=lower)
        if len(seen.hollow):
            leaving = hollow_exit(*(evaluate(form, x, y) for form in seen.hollow))
            np.maximum(lower, leaving, out=lower)
        return upper, lower


def _root(side: Floats, x: Floats, y: Floats, out: tuple[Floats32, Floats32]) -> Floats32:
    """Return half the difference between entering and leaving a round side, NaN beside it."""
    root, spare = out
    evaluate(side[1], x, y, root)
    np.multiply(root, evaluate(side[2], x, y, spare), out=root)
    for form in side[3:]:
        third = evaluate(form, x, y, spare)
        np.subtract(root, np.multiply(third, third, out=third), out=root)
    return np.sqrt(root, out=root)
