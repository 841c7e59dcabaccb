"""From pixels to colours: depth by a colour map with a scale, grey as grey. Pure."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain

from lcmtools.errors import UsageError
from lcmtools.labs.nodes.picture.pixels import Kind, Picture, Pixel

Color = tuple[int, int, int]
"""Red, green and blue, from 0 to 255."""

NO_READING: Color = (0, 0, 0)
LEVELS = 64
"""Different colours of a map: few enough for the terminals that have 256 of them."""
_ROUNDING = 500  # [mm] a scale's ends: rounder, so that it stands still while things move
COLOR_MAPS: dict[str, tuple[Color, ...]] = {
    "warm": (
        (255, 245, 170), (253, 190, 90), (240, 115, 75), (200, 55, 105), (135, 40, 130),
        (70, 35, 125), (35, 35, 90),
    ),
    "grey": ((235, 235, 235), (45, 45, 45)),
}  # fmt: skip
"""By name: colours from near to far, evenly apart; what is nearer is lighter."""


@dataclass(frozen=True, slots=True)
class Scale:
    """What the ends of the colour map stand for.

    Attributes:
        near: Depth [mm], or least grey.
        far: Depth [mm], or largest grey.
    """

    near: int
    far: int

    def position(self, value: int) -> float:
        """Where a value is between the ends, from 0 to 1."""
        share = (value - self.near) / max(1, self.far - self.near)
        return min(1.0, max(0.0, share))


class Shades(dict[Pixel, Color]):
    """The colour of each pixel, made when it is first asked for."""

    def __init__(self, kind: Kind, scale: Scale, color_map: Sequence[Color]) -> None:
        super().__init__()
        self._kind = kind
        self._scale = scale
        self._levels = [mix(color_map, level / (LEVELS - 1)) for level in range(LEVELS)]

    def __missing__(self, pixel: Pixel) -> Color:
        """Make the colour of a pixel that was not there before."""
        self[pixel] = color = self._make(pixel)
        return color

    def _make(self, pixel: Pixel) -> Color:
        if isinstance(pixel, tuple):
            return pixel
        if self._kind is Kind.DEPTH:
            level = round(self._scale.position(pixel) * (LEVELS - 1))
            return self._levels[level] if pixel else NO_READING
        grey = round(self._scale.position(pixel) * 255)
        return grey, grey, grey


def mix(colors: Sequence[Color], position: float) -> Color:
    """The colour at a position from 0 to 1 in a row of colours that are evenly apart."""
    place = position * (len(colors) - 1)
    index = min(int(place), len(colors) - 2)
    share = place - index
    red, green, blue = (
        round(one + share * (other - one))
        for one, other in zip(colors[index], colors[index + 1], strict=True)
    )
    return red, green, blue


def scale_of(
    picture: Picture, rows: Iterable[Sequence[Pixel]], near: float | None, far: float | None
) -> Scale:
    """The scale for some pixels of a picture.

    Args:
        picture: Where they are from.
        rows: The pixels that are to be shown.
        near: Depth of the colour map's beginning [m]; None to find it in the pixels.
        far: Depth of its end [m]; None to find it in the pixels.
    """
    if picture.layout.kind is Kind.COLOR:
        return Scale(0, 255)
    if picture.layout.white:
        return Scale(0, picture.layout.white)
    values = set(chain.from_iterable(rows))
    if picture.layout.kind is Kind.DEPTH:
        values.discard(0)
    numbers = [value for value in values if isinstance(value, int)] or [0]
    if picture.layout.kind is Kind.GREY:
        return Scale(min(numbers), max(numbers))
    least = min(numbers) // _ROUNDING * _ROUNDING if near is None else round(near * 1000)
    most = math.ceil(max(numbers) / _ROUNDING) * _ROUNDING if far is None else round(far * 1000)
    return Scale(least, max(most, least + 1))


def check_scale(near: float | None, far: float | None) -> None:
    """Refuse a scale whose ends are exchanged.

    Raises:
        UsageError: They are.
    """
    if near is not None and far is not None and near >= far:
        raise UsageError(f"--near {near:g} is not below --far {far:g}")
