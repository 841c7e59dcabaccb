"""Pictures as they come in messages: their size, their kind, and their pixels row by row.

Pure. What they look like in colour is not known here.
"""

import sys
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

from lcmtools.errors import DecodeError
from lcmtools.labs.nodes.picture.png import decode_png
from lcmtools.types.sensor_msgs import CompressedImage, Image

Pixel = int | tuple[int, int, int]
"""Depth in millimetres, 0 where there is none; grey; or red, green and blue from 0 to 255."""

_MOST_PIXELS = 1 << 26
_FARTHEST = 1e6  # [m]
_COMPRESSED_DEPTH_HEADER = 12  # bytes that ROS's compressedDepth puts before the PNG file


class Kind(Enum):
    """What a pixel is."""

    DEPTH = "depth"
    GREY = "grey"
    COLOR = "color"


@dataclass(frozen=True, slots=True)
class Layout:
    """How an encoding writes a pixel.

    Attributes:
        kind: What a pixel is.
        code: Type of a number, as of the array module.
        order: Places of red, green and blue among the numbers of a pixel; empty for one number.
        channels: Numbers of a pixel.
        white: Largest grey; 0 where that is not known, and the largest one there is counts.
    """

    kind: Kind
    code: str
    order: tuple[int, ...] = ()
    channels: int = 1
    white: int = 0


_RGB, _BGR = (0, 1, 2), (2, 1, 0)
LAYOUTS = {
    "16UC1": Layout(Kind.DEPTH, "H"),
    "32FC1": Layout(Kind.DEPTH, "f"),
    "mono8": Layout(Kind.GREY, "B", white=255),
    "8UC1": Layout(Kind.GREY, "B", white=255),
    "mono16": Layout(Kind.GREY, "H"),
    "rgb8": Layout(Kind.COLOR, "B", _RGB, 3),
    "bgr8": Layout(Kind.COLOR, "B", _BGR, 3),
    "8UC3": Layout(Kind.COLOR, "B", _BGR, 3),
    "rgba8": Layout(Kind.COLOR, "B", _RGB, 4),
    "bgra8": Layout(Kind.COLOR, "B", _BGR, 4),
    "8UC4": Layout(Kind.COLOR, "B", _BGR, 4),
}
"""By sensor_msgs/Image's encoding (those of OpenCV as cv_bridge reads them)."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture whose pixels are read when they are asked for.

    Attributes:
        width: [pixels]
        height: [pixels]
        encoding: As the message says.
        layout: What that means.
        data: The rows, from top to bottom.
        step: Bytes from one row to the next.
        is_swapped: The order of bytes in a number is not this computer's.
    """

    width: int
    height: int
    encoding: str
    layout: Layout
    data: bytes
    step: int
    is_swapped: bool

    def row(self, y: int, columns: Sequence[int] | None = None) -> list[Pixel]:
        """The pixels of a row; of some columns only, where they are given."""
        layout = self.layout
        numbers = array(layout.code)
        start = y * self.step
        numbers.frombytes(self.data[start : start + self.width * _pixel_bytes(layout)])
        if self.is_swapped:
            numbers.byteswap()
        pixels: Sequence[Pixel] = _READERS.get((layout.kind, layout.code), _as_it_is)(
            numbers, layout
        )
        return [pixels[x] for x in columns] if columns is not None else list(pixels)


def read_picture(message: Image | CompressedImage) -> Picture:
    """The picture in a message.

    Raises:
        DecodeError: It is broken, or of a kind that is not shown.
    """
    return _compressed(message) if isinstance(message, CompressedImage) else _raw(message)


def _raw(image: Image) -> Picture:
    layout = LAYOUTS.get(image.encoding)
    if layout is None:
        raise DecodeError(
            f"pictures in '{image.encoding}' are not shown", f"known: {', '.join(LAYOUTS)}"
        )
    row_bytes = image.width * _pixel_bytes(layout)
    needed = image.step * (image.height - 1) + row_bytes
    size = f"{image.width} x {image.height} {image.encoding}"
    if image.width < 1 or image.height < 1 or image.width * image.height > _MOST_PIXELS:
        raise DecodeError(f"a picture of {size} is not shown")
    if image.step < row_bytes or len(image.data) < needed:
        raise DecodeError(
            f"{size} does not fit its data: {len(image.data)} bytes in rows of {image.step}"
        )
    is_swapped = bool(image.is_bigendian) != (sys.byteorder == "big")
    return Picture(
        image.width, image.height, image.encoding, layout, bytes(image.data), image.step, is_swapped
    )


def _compressed(image: CompressedImage) -> Picture:
    data = bytes(image.data)
    if "compressedDepth" in image.format:
        data = data[_COMPRESSED_DEPTH_HEADER:]
    if data[:3] == b"\xff\xd8\xff":
        raise DecodeError("JPEG pictures are not shown", "those in PNG are, and the raw topic")
    png = decode_png(data)
    encoding = _ENCODINGS[png.channels, png.bits]
    layout = LAYOUTS[encoding]
    step = png.width * _pixel_bytes(layout)
    is_swapped = png.bits == 16 and sys.byteorder == "little"  # noqa: PLR2004 - PNG is big-endian
    return Picture(png.width, png.height, encoding, layout, png.rows, step, is_swapped)


_ENCODINGS = {(1, 8): "mono8", (1, 16): "16UC1", (3, 8): "rgb8", (4, 8): "rgba8"}
"""By channels and bits of what ``decode_png`` reads."""


def _pixel_bytes(layout: Layout) -> int:
    return layout.channels * array(layout.code).itemsize


def _as_it_is(numbers: Sequence[int], _layout: Layout) -> Sequence[int]:
    return numbers


def _millimetres(metres: Sequence[float], _layout: Layout) -> Sequence[int]:
    return [round(z * 1000) if 0 < z < _FARTHEST else 0 for z in metres]


def _colors(numbers: Sequence[int], layout: Layout) -> Sequence[tuple[int, int, int]]:
    red, green, blue = (numbers[place :: layout.channels] for place in layout.order)
    return list(zip(red, green, blue, strict=True))


_READERS: dict[tuple[Kind, str], Callable[..., Sequence[Pixel]]] = {
    (Kind.DEPTH, "f"): _millimetres,
    (Kind.COLOR, "B"): _colors,
}
