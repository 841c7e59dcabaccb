"""Pictures as sixels: strips of six rows, one colour after the other. Pure.

DEC, VT330/VT340 Programmer Reference Manual, volume 2, chapter 14.
"""

import re
from collections.abc import Sequence

from lcmtools.labs.nodes.picture.sample import View
from lcmtools.labs.nodes.picture.shades import Color

_MOST_COLORS = 256
_STRIP = 6
_STEP = 51  # from one of the 6 levels of red, green and blue to the next
_RUN = re.compile(r"(.)\1{3,}")


def draw_sixel(view: View) -> str:
    """A picture from the cursor on; its background is black."""
    rows = _few_colors(view.rows)
    numbers = {color: number for number, color in enumerate(sorted(set().union(*rows)))}
    palette = "".join(f"#{number};2;{_percent(color)}" for color, number in numbers.items())
    strips = [_strip(rows[at : at + _STRIP], numbers) for at in range(0, len(rows), _STRIP)]
    return f'\x1bP0;1q"1;1;{view.width};{view.height}{palette}{"-".join(strips)}\x1b\\'


def _few_colors(rows: list[list[Color]]) -> list[list[Color]]:
    """The rows as they are, or with each colour's parts in six levels where there are too many."""
    colors = set().union(*rows)
    if len(colors) <= _MOST_COLORS:
        return rows
    nearest = {color: tuple(round(part / _STEP) * _STEP for part in color) for color in colors}
    return [[nearest[color] for color in row] for row in rows]  # type: ignore[misc] # three parts


def _percent(color: Color) -> str:
    return ";".join(str(round(part / 2.55)) for part in color)


def _strip(rows: Sequence[Sequence[Color]], numbers: dict[Color, int]) -> str:
    """Six rows at most: for each colour in them, which of the six pixels of a column have it."""
    width = len(rows[0])
    planes: dict[Color, bytearray] = {}
    for bit, row in enumerate(rows):
        for x, color in enumerate(row):
            plane = planes.get(color)
            if plane is None:
                plane = planes[color] = bytearray(b"?" * width)
            plane[x] += 1 << bit  # "?" is none of the six
    return "$".join(f"#{numbers[color]}{_packed(plane)}" for color, plane in planes.items())


def _packed(plane: bytearray) -> str:
    text = plane.decode("ascii").rstrip("?")
    return _RUN.sub(lambda run: f"!{len(run.group())}{run.group()[0]}", text)
