"""Images as text for a terminal: each character shows two pixels, one above the other. Pure."""

from collections.abc import Mapping, Sequence
from enum import Enum
from itertools import chain

import PIL.Image

_UPPER_HALF = "\N{UPPER HALF BLOCK}"
_RESET = "\x1b[0m"
_SHADES = " \N{LIGHT SHADE}\N{MEDIUM SHADE}\N{DARK SHADE}\N{FULL BLOCK}"  # from dark to bright
# xterm's colours 16 to 255: a cube of six levels each of red, green and blue, then 24 greys
_FIRST = 16
_LEVELS = (0, 95, 135, 175, 215, 255)
_CUBE = [(red, green, blue) for red in _LEVELS for green in _LEVELS for blue in _LEVELS]
_GREYS = [(grey, grey, grey) for grey in range(8, 248, 10)]


class TerminalColors(Enum):
    """The colours that a terminal shows."""

    NONE = "none"
    INDEXED = "256"
    FULL = "24 bits"


def terminal_colors(environment: Mapping[str, str], *, wants_color: bool) -> TerminalColors:
    """Return the colours of the terminal that an environment describes, if colour is wanted."""
    if not wants_color:
        return TerminalColors.NONE
    has_all = environment.get("COLORTERM", "").lower() in ("truecolor", "24bit")
    return TerminalColors.FULL if has_all else TerminalColors.INDEXED


def blocks(image: PIL.Image.Image, colors: TerminalColors) -> list[str]:
    """Return an RGB image as lines, each of two rows of pixels."""
    width, height = image.width, -(-image.height // 2)
    even = image.crop((0, 0, width, 2 * height))  # a row that is missing becomes black
    if colors is TerminalColors.NONE:
        grey = even.convert("L").resize((width, height), PIL.Image.Resampling.BOX).tobytes()
        shades = "".join(_SHADES[level * len(_SHADES) // 256] for level in grey)
        return [shades[start : start + width] for start in range(0, len(shades), width)]
    codes = _indexed(even) if colors is TerminalColors.INDEXED else _full(even)
    rows = [codes[start : start + width] for start in range(0, len(codes), width)]
    return [_line(upper, lower) for upper, lower in zip(rows[::2], rows[1::2], strict=True)]


def _full(image: PIL.Image.Image) -> list[str]:
    """Return the colour of each pixel as in an escape sequence."""
    data = image.tobytes()
    pixels = zip(data[::3], data[1::3], data[2::3], strict=True)
    return [f"2;{red};{green};{blue}" for red, green, blue in pixels]


def _indexed(image: PIL.Image.Image) -> list[str]:
    """Return the nearest of xterm's colours for each pixel, likewise."""
    palette = PIL.Image.new("P", (1, 1))
    palette.putpalette([*chain.from_iterable(_CUBE + _GREYS)])
    nearest = image.quantize(palette=palette, dither=PIL.Image.Dither.NONE).tobytes()
    return [f"5;{_FIRST + index}" for index in nearest]


def _line(upper: Sequence[str], lower: Sequence[str]) -> str:
    """Return the characters of two rows; a colour is written only where it changes."""
    parts = []
    before = ("", "")
    for pair in zip(upper, lower, strict=True):
        if pair != before:
            parts.append(f"\x1b[38;{pair[0]};48;{pair[1]}m")
            before = pair
        parts.append(_UPPER_HALF)
    return "".join([*parts, _RESET])
