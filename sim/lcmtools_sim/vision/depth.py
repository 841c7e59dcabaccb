"""What a camera sees: depth and which solid, pixel by pixel.

Geometry only; colours, noise and encoding are elsewhere. Nearness (1 / depth, see surfaces.py) is
drawn solid by solid, each within its outline, in strips that stay in the processor's cache; the
forms are float64, the pixels float32.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lcmtools_sim.rotation import Quaternion, Vector
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.outlines import Outline, outlines
from lcmtools_sim.vision.solids import Floats, Solids, matrix
from lcmtools_sim.vision.surfaces import Field, Surfaces, field, ground, hollow_exit, surfaces

GROUND = -1
SKY = -2
_REACH = 1e-6  # relative; what is at the greatest depth is still seen
_STRIP = 1 << 16  # [pixels]


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What a camera sees from one place.

    Attributes:
        camera: That looks.
        solids: What there is, in the camera's optical frame.
        outlines: Of those that are in view.
        turn: Rotation matrix of the optical frame in the world.
        depth: (height, width) float32 along the optical axis [m]; inf where nothing is hit.
        solid: (height, width) int16, the number of the solid that is seen, GROUND or SKY.
    """

    camera: Camera
    solids: Solids
    outlines: Sequence[Outline]
    turn: Floats
    depth: Field
    solid: npt.NDArray[np.int16]


# Rays that miss a round side make NaN, and so does a body that the engine has lost.
@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def look(
    solids: Solids,
    camera: Camera,
    position: Vector,
    rotation: Quaternion,
    far: float = np.inf,
) -> Sight:
    """See solids and the ground.

    Args:
        solids: In the world; those that the eye is within are not seen.
        camera: Its intrinsics.
        position: Of the optical frame in the world [m].
        rotation: Of the optical frame in the world (see ``camera.optical``).
        far: Greatest depth that is seen [m].
    """
    local, turn = solids.seen_from(position, rotation), matrix(rotation)
    picture = _Picture(camera, (1 - _REACH) / far)
    form = ground(position[2], turn[2])
    if solids.ground is not None and form is not None:
        picture.fill(form)
    in_view = outlines(local, camera, far * (1 + _REACH))
    for outline in in_view:
        seen = surfaces(local, outline.number)
        if seen is not None:
            picture.draw(outline, seen)
    return Sight(camera, local, in_view, turn, picture.depth(), picture.solid)


def depth_image(
    solids: Solids,
    camera: Camera,
    position: Vector,
    rotation: Quaternion,
    far: float = np.inf,
) -> Field:
    """Only the depth of ``look``: (height, width) float32 [m], inf where nothing is hit."""
    return look(solids, camera, position, rotation, far).depth


class _Picture:
    """Nearness and number of what is nearest so far."""

    def __init__(self, camera: Camera, least: float) -> None:
        shape = camera.height, camera.width
        self._x, self._y = camera.slopes()
        self._least = np.float32(least)
        self._inverse_depth = np.full(shape, self._least)
        self.solid = np.full(shape, SKY, np.int16)
        self._buffers = [np.empty(max(_STRIP, camera.width), np.float32) for _ in range(4)]

    def fill(self, form: Floats) -> None:
        """Draw the ground into the empty picture."""
        inverse_depth = field(form, self._x, self._y, self._inverse_depth)
        np.maximum(inverse_depth, self._least, out=inverse_depth)
        self.solid[inverse_depth > self._least] = GROUND

    def draw(self, outline: Outline, seen: Surfaces) -> None:
        """Draw a solid over what is there."""
        for rows, columns in _strips(outline):
            upper, lower = self._bounds(seen, self._x[columns], self._y[rows])
            behind = self._inverse_depth[rows, columns]
            np.maximum(lower, behind, out=lower)
            visible = upper > lower  # False where NaN
            np.copyto(behind, upper, where=visible)
            np.copyto(self.solid[rows, columns], np.int16(outline.number), where=visible)

    def depth(self) -> Field:
        """The depth [m]; the picture is used up."""
        inverse_depth = self._inverse_depth
        inverse_depth[self.solid == SKY] = 0
        return np.divide(np.float32(1), inverse_depth, out=inverse_depth)

    def _bounds(self, seen: Surfaces, x: Floats, y: Floats) -> tuple[Field, Field]:
        """Nearness of entering and leaving a solid; where it is missed, entering is less or NaN."""
        upper, lower, spare, other = (
            buffer[: len(y) * len(x)].reshape(len(y), len(x)) for buffer in self._buffers
        )
        upper.fill(np.inf)
        lower.fill(0)
        for form in seen.faces:
            np.minimum(upper, field(form, x, y, spare), out=upper)
        for form in seen.backs:
            np.maximum(lower, field(form, x, y, spare), out=lower)
        if len(seen.side):
            root = _root(seen.side, x, y, (spare, other))
            middle = field(seen.side[0], x, y, other)
            np.minimum(upper, middle + root, out=upper)
            np.maximum(lower, np.subtract(middle, root, out=middle), out=lower)
        if len(seen.hollow):
            np.maximum(lower, hollow_exit(*(field(form, x, y) for form in seen.hollow)), out=lower)
        return upper, lower


def _root(side: Floats, x: Floats, y: Floats, out: tuple[Field, Field]) -> Field:
    """Half the difference of entering and leaving a round side, NaN beside it."""
    root, spare = out
    field(side[1], x, y, root)
    np.multiply(root, field(side[2], x, y, spare), out=root)
    for form in side[3:]:
        third = field(form, x, y, spare)
        np.subtract(root, np.multiply(third, third, out=third), out=root)
    return np.sqrt(root, out=root)


def _strips(outline: Outline) -> Iterator[tuple[slice, slice]]:
    """An outline's rows and columns, some rows at a time."""
    columns = slice(outline.left, outline.right)
    height = max(1, _STRIP // (outline.right - outline.left))
    for top in range(outline.top, outline.bottom, height):
        yield slice(top, min(top + height, outline.bottom)), columns
