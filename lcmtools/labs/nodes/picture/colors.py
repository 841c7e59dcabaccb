"""Colours for depth and grey by a scale, and a picture in words."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import PIL.Image

from lcmtools.errors import UsageError
from lcmtools.messages.pictures import Picture
from lcmtools.messages.pixels import Color, Kind

_NO_READING: Color = (0, 0, 0)
_ROUNDING = (
    500  # [mm] the ends of a scale are rounded, so that it does not change while things move
)
_LEVELS = 255


@dataclass(frozen=True, slots=True)
class ColorOptions:
    """The colours of depth.

    Raises:
        UsageError: ``near`` is not below ``far``.
    """

    color_map: Sequence[Color]  # its colours from near to far
    near: float | None = None  # depth of its beginning [m]; None: by the picture
    far: float | None = None  # depth of its end [m]; None: by the picture

    def __post_init__(self) -> None:
        """Check the ends."""
        if self.near is not None and self.far is not None and self.near >= self.far:
            raise UsageError(f"--near {self.near:g} is not below --far {self.far:g}")


@dataclass(frozen=True, slots=True)
class ColoredPicture:
    """A picture in colours."""

    image: PIL.Image.Image  # its pixels (RGB)
    # Depth of the lightest colour [mm]; None where the picture is not of depth.
    near: int | None = None
    far: int | None = None  # depth of the darkest colour [mm]

    @property
    def legend_ends(self) -> tuple[str, str]:
        """The depths at the ends of the colour map: ("0.5 m", "4 m")."""
        return f"{(self.near or 0) / 1000:g} m", f"{(self.far or 0) / 1000:g} m"


def colored(picture: Picture, options: ColorOptions) -> ColoredPicture:
    """Color a picture, at its own size."""
    if picture.kind is Kind.COLOR or picture.image.mode == "L":
        return ColoredPicture(picture.image.convert("RGB"))
    values = picture.values()
    if picture.kind is Kind.GREY:
        levels = _levels(values, min(values), max(values), _LEVELS)
        return ColoredPicture(_image(levels, picture).convert("RGB"))
    near, far = _scale([value for value in values if value] or [0], options)
    levels = _levels(values, near, far, _LEVELS - 1)
    shown = _image([1 + n if v else 0 for n, v in zip(levels, values, strict=True)], picture)
    steps = (mix(options.color_map, level / (_LEVELS - 1)) for level in range(_LEVELS))
    shown.putpalette([channel for color in (_NO_READING, *steps) for channel in color], "RGB")
    return ColoredPicture(shown.convert("RGB"), near, far)


def mix(colors: Sequence[Color], position: float) -> Color:
    """Interpolate between evenly spaced colours at a position from 0 to 1."""
    place = position * (len(colors) - 1)
    index = min(int(place), len(colors) - 2)
    share = place - index
    red, green, blue = (
        round(one + share * (other - one))
        for one, other in zip(colors[index], colors[index + 1], strict=True)
    )
    return red, green, blue


def facts(picture: Picture) -> dict[str, object]:
    """Return size, encoding, and min, max and middle in m, or in grey; None for no reading."""
    width, height = picture.image.size
    size: dict[str, object] = {"width": width, "height": height, "encoding": picture.encoding}
    if picture.kind is Kind.COLOR:
        return size
    values = picture.values()
    middle = values[height // 2 * width + width // 2]
    if picture.kind is Kind.GREY:
        return {**size, "min": min(values), "max": max(values), "middle": middle}
    readings = [value for value in values if value] or [0]
    known = {"min": min(readings), "max": max(readings), "middle": middle}
    return {**size, **{name: value / 1000 if value else None for name, value in known.items()}}


def sentence(known: Mapping[str, object]) -> str:
    """Format the facts as one line."""
    size = f"{known['width']} x {known['height']} {known['encoding']}"
    if "min" not in known:
        return size
    parts = [f"{name} {_value(known[name])}" for name in ("min", "max", "middle")]
    return f"{size}  {'  '.join(parts)}"


def _value(value: object) -> str:
    if value is None:
        return "none"
    return f"{value:.2f} m" if isinstance(value, float) else str(value)


def _scale(readings: Sequence[int], options: ColorOptions) -> tuple[int, int]:
    near = min(readings) // _ROUNDING * _ROUNDING
    far = math.ceil(max(readings) / _ROUNDING) * _ROUNDING
    near = near if options.near is None else round(options.near * 1000)
    far = far if options.far is None else round(options.far * 1000)
    return near, max(far, near + 1)


def _levels(values: Sequence[int], least: int, most: int, levels: int) -> list[int]:
    factor = levels / max(1, most - least)
    return [min(levels, max(0, round((value - least) * factor))) for value in values]


def _image(levels: Sequence[int], picture: Picture) -> PIL.Image.Image:
    return PIL.Image.frombytes("L", picture.image.size, bytes(levels))
