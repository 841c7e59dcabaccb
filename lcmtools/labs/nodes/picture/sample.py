"""As many of a picture's pixels as there is room for, in colour. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.labs.nodes.picture.pixels import Kind, Picture
from lcmtools.labs.nodes.picture.shades import Color, Scale, Shades, scale_of


@dataclass(frozen=True, slots=True)
class View:
    """What is to be seen of a picture.

    Attributes:
        rows: The colours from top to bottom, each row as long as the others.
        scale: What the colours stand for.
        is_depth: Whether they stand for depth.
        color_map: The colours from near to far.
    """

    rows: list[list[Color]]
    scale: Scale
    is_depth: bool
    color_map: Sequence[Color]

    @property
    def width(self) -> int:
        """In pixels."""
        return len(self.rows[0])

    @property
    def height(self) -> int:
        """In pixels."""
        return len(self.rows)

    def to_bytes(self) -> bytes:
        """Red, green and blue, a byte each, row by row."""
        return b"".join(bytes(channel for color in row for channel in color) for row in self.rows)


@dataclass(frozen=True, slots=True)
class Look:
    """How pictures are to be coloured.

    Attributes:
        color_map: The colours of depth from near to far.
        near: Where the map begins [m]; None: by the picture.
        far: Where it ends [m]; None: by the picture.
    """

    color_map: Sequence[Color]
    near: float | None = None
    far: float | None = None


def fitting_size(picture: Picture, width: int, height: int) -> tuple[int, int]:
    """The largest size in the picture's proportions that is not over a width and a height."""
    scale = min(width / picture.width, height / picture.height)
    return max(1, round(picture.width * scale)), max(1, round(picture.height * scale))


def take_view(picture: Picture, look: Look, width: int, height: int) -> View:
    """A picture in a size [pixels], which may be larger or smaller than its own.

    The pixel in the middle of each part stands for it: a mean of depths would show what is not
    there, between a thing and what is behind it.
    """
    columns = _middles(picture.width, width)
    rows = [picture.row(y, columns) for y in _middles(picture.height, height)]
    scale = scale_of(picture, rows, look.near, look.far)
    kind = picture.layout.kind
    shades = Shades(kind, scale, look.color_map)
    colored = [[shades[pixel] for pixel in row] for row in rows]
    return View(colored, scale, kind is Kind.DEPTH, look.color_map)


def _middles(size: int, parts: int) -> list[int]:
    return [(2 * part + 1) * size // (2 * parts) for part in range(parts)]
