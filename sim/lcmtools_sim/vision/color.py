"""What a colour camera sees: the solids' colours in plain light, registered with the depth.

The light is a sun with a fixed direction, without shadows. Shading is Lambert's, wrapped round so
that faces in the shade still differ from each other (J. Mitchell et al., Shading in Valve's Source
Engine, SIGGRAPH 2006: half Lambert).
"""

import numpy as np
import numpy.typing as npt

from lcmtools_sim.shapes import Color
from lcmtools_sim.vision.depth import GROUND, Sight
from lcmtools_sim.vision.outlines import Outline
from lcmtools_sim.vision.solids import CUBOID, CYLINDER, Floats
from lcmtools_sim.vision.surfaces import field, surfaces

Pixels = npt.NDArray[np.uint8]

SKY_COLOR: Color = (0.68, 0.80, 0.92)
SUN = np.array((-0.4, -0.6, 1.0)) / np.linalg.norm((-0.4, -0.6, 1.0))
"""Direction towards the sun, in the world."""
AMBIENT = 0.35
"""Brightness of what faces away from the sun; what faces it has 1."""
_UP = np.array((0.0, 0.0, 1.0))
_ON_FACE = 1 + 1e-5  # a pixel is of a cap whose nearness is at most so many times the pixel's


def color_image(sight: Sight, sky: Color = SKY_COLOR) -> Pixels:
    """The picture: (height, width, 3) uint8, red, green, blue; where nothing is hit, the sky."""
    picture = np.empty((*sight.depth.shape, 4), np.uint8)
    packed = picture.view(np.uint32)[:, :, 0]
    floor = _lit(np.array(sight.solids.ground or sky), _UP)
    packed[:] = np.where(sight.solid == GROUND, _packed(floor), _packed(np.array(sky)))
    for outline in sight.outlines:
        area = slice(outline.top, outline.bottom), slice(outline.left, outline.right)
        mask = sight.solid[area] == outline.number
        if not mask.any():
            continue
        if sight.solids.kinds[outline.number] == CUBOID:
            np.copyto(packed[area], _flat(sight, outline), where=mask)
        else:
            picture[area][mask] = _bytes(_round(sight, outline, mask))
    return np.ascontiguousarray(picture[:, :, :3])


def _flat(sight: Sight, outline: Outline) -> npt.NDArray[np.uint32]:
    """A cuboid's packed colours all over its outline: those of its nearest face."""
    seen = surfaces(sight.solids, outline.number)
    assert seen is not None  # for it is in the picture
    color = sight.solids.colors[outline.number]
    x, y = _slopes(sight, outline)
    colors = np.full((len(y), len(x)), _packed(_lit(color, _normal(sight, seen.faces[0]))))
    nearest = field(seen.faces[0], x, y)
    for form in seen.faces[1:]:
        other = field(form, x, y)
        shade = _packed(_lit(color, _normal(sight, form)))
        np.copyto(colors, shade, where=other < nearest)
        np.minimum(nearest, other, out=nearest)
    return colors


def _round(sight: Sight, outline: Outline, mask: npt.NDArray[np.bool_]) -> Floats:
    """The colours of the pixels of a ball or cylinder, (n, 3)."""
    solids, number = sight.solids, outline.number
    x, y = _slopes(sight, outline)
    rows, columns = np.nonzero(mask)
    depth = sight.depth[rows + outline.top, columns + outline.left]
    rays = np.stack((x[columns], y[rows], np.ones(len(rows))), axis=-1)
    normals = rays * depth[:, None] - solids.centres[number]
    if solids.kinds[number] == CYLINDER:
        axis = solids.axes[number][:, 2]
        normals -= np.outer(normals @ axis, axis)
    normals = normals @ sight.turn.T / solids.half_sizes[number, 0]
    seen = surfaces(solids, number)
    for form in seen.faces if seen else ():
        normals[(rays @ form) * depth <= _ON_FACE] = _normal(sight, form)
    return _lit(solids.colors[number], normals)


def _slopes(sight: Sight, outline: Outline) -> tuple[Floats, Floats]:
    x, y = sight.camera.slopes()
    return x[outline.left : outline.right], y[outline.top : outline.bottom]


def _normal(sight: Sight, form: Floats) -> Floats:
    """The normal, in the world, of the plane of a face; it looks towards the eye."""
    normal: Floats = -sight.turn @ form
    return normal / np.linalg.norm(normal)


def _lit(color: Floats, normals: Floats) -> Floats:
    """A colour on surfaces with these normals (..., 3) in the world."""
    facing = (1 + normals @ SUN) / 2
    lit: Floats = (AMBIENT + (1 - AMBIENT) * facing)[..., None] * color
    return lit


def _bytes(colors: Floats) -> Pixels:
    """Colours (..., 3) from 0 to 1 as (..., 4) bytes, the last one unused."""
    levels = np.rint(np.clip(colors, 0, 1) * 255).astype(np.uint8)
    return np.concatenate((levels, np.zeros((*levels.shape[:-1], 1), np.uint8)), axis=-1)


def _packed(color: Floats) -> np.uint32:
    """A colour's four bytes as one number, in the order in which they are in memory."""
    return np.uint32(_bytes(color).view(np.uint32)[0])
