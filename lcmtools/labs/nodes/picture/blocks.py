"""Pictures as text: each character shows two pixels, one above the other, as a half block.

Pure: a terminal's size and its number of colours come in.
"""

from collections.abc import Sequence
from enum import Enum

from lcmtools.labs.nodes.picture.sample import View
from lcmtools.labs.nodes.picture.shades import Color, mix
from lcmtools.labs.nodes.picture.words import legend_ends

_HALF_BLOCK = "\N{UPPER HALF BLOCK}"
_RAMP = " .:-=+*#%@"
_RESET = "\x1b[0m"
_CUBE = (0, 95, 135, 175, 215, 255)  # what the 6 steps of xterm's 216 colours stand for
_GREYS = range(8, 239, 10)  # the 24 greys that follow
LEGEND_WIDTH = 24


class Depth(Enum):
    """How many colours a terminal has."""

    NONE = "none"
    COLORS_256 = "256"
    FULL = "full"


def color_depth(environment: dict[str, str], *, wanted: bool) -> Depth:
    """The colours that a terminal has, by its environment variables; none where none are wanted."""
    if not wanted:
        return Depth.NONE
    said = environment.get("COLORTERM", "").lower()
    return Depth.FULL if said in ("truecolor", "24bit") else Depth.COLORS_256


def draw_blocks(view: View, depth: Depth) -> list[str]:
    """A picture's lines: half as many as it has rows."""
    rows = [*view.rows, *([view.rows[-1]] if len(view.rows) % 2 else [])]
    pairs = zip(rows[::2], rows[1::2], strict=True)
    return [_line(upper, lower, depth) for upper, lower in pairs]


def draw_legend(view: View, depth: Depth) -> str:
    """The scale: a bar with the depth at its ends; "" where colours mean nothing but themselves."""
    if not view.is_depth:
        return ""
    steps = range(LEGEND_WIDTH)
    bar = [mix(view.color_map, step / (LEGEND_WIDTH - 1)) for step in steps]
    near, far = legend_ends(view.scale)
    return f"near {near} {_line(bar, bar, depth)} {far} far"


def nearest_256(color: Color) -> int:
    """The number of the nearest of xterm's 256 colours: its cube's, or a grey."""
    red, green, blue = (min(range(6), key=lambda i: abs(_CUBE[i] - part)) for part in color)
    in_cube = (_CUBE[red], _CUBE[green], _CUBE[blue])
    grey = min(range(24), key=lambda i: abs(_GREYS[i] - sum(color) / 3))
    in_greys = (_GREYS[grey],) * 3
    if _distance(color, in_greys) < _distance(color, in_cube):
        return 232 + grey
    return 16 + 36 * red + 6 * green + blue


def _distance(one: Sequence[int], other: Sequence[int]) -> int:
    return sum((a - b) ** 2 for a, b in zip(one, other, strict=True))


def _line(upper: Sequence[Color], lower: Sequence[Color], depth: Depth) -> str:
    if depth is Depth.NONE:
        return "".join(_RAMP[sum(color) * len(_RAMP) // 766] for color in upper)
    parts: list[str] = []
    codes = _Codes(depth)
    before: tuple[Color, Color] | None = None
    for pair in zip(upper, lower, strict=True):
        parts.append(_HALF_BLOCK if pair == before else f"{codes[pair]}{_HALF_BLOCK}")
        before = pair
    return "".join(parts) + _RESET


class _Codes(dict[tuple[Color, Color], str]):
    """The sequence that sets two colours (ECMA-48 SGR; 38 and 48 as xterm has them)."""

    def __init__(self, depth: Depth) -> None:
        super().__init__()
        self._depth = depth

    def __missing__(self, pair: tuple[Color, Color]) -> str:
        front, back = (self._code(color) for color in pair)
        self[pair] = code = f"\x1b[38;{front};48;{back}m"
        return code

    def _code(self, color: Color) -> str:
        if self._depth is Depth.FULL:
            return "2;{};{};{}".format(*color)
        return f"5;{nearest_256(color)}"
