"""The pixels in messages of images: their meaning, number format and rows.

Belongs here: what needs no image file to be read, and the colours of depth. Must not know
Pillow.
"""

from array import array
from dataclasses import dataclass, replace
from enum import Enum

from lcmtools.errors import DecodeError
from lcmtools.types.sensor_msgs import CompressedImage, Image

Color = tuple[int, int, int]  # red, green and blue, from 0 to 255

MOST_PIXELS = 1 << 26
COLOR_MAPS: dict[str, tuple[Color, ...]] = {
    "warm": (
        (255, 245, 170), (253, 190, 90), (240, 115, 75), (200, 55, 105), (135, 40, 130),
        (70, 35, 125), (35, 35, 90),
    ),
    "grey": ((235, 235, 235), (45, 45, 45)),
}  # fmt: skip
"""Colours from near to far by the map's name, evenly spaced; nearer is lighter."""
_COMPRESSED_DEPTH_HEADER = 12  # bytes that ROS's compressedDepth puts before the PNG file


class Kind(Enum):
    """The meaning of a pixel."""

    DEPTH = "depth"
    GREY = "grey"
    COLOR = "color"


@dataclass(frozen=True, slots=True)
class PixelFormat:
    """The format of a pixel."""

    kind: Kind
    number: str = "B"  # the type code of its numbers, as in ``array``: B, H or f
    channels: str = "v"  # the order of its numbers: "rgb", "bgra", or one letter for a single one

    @property
    def size(self) -> int:
        """The bytes of a pixel."""
        return array(self.number).itemsize * len(self.channels)

    @property
    def unit(self) -> str:
        """The unit of depth: mm in whole numbers, else m (REP-118); "" if not depth."""
        return {"H": "mm", "f": "m"}[self.number] if self.kind is Kind.DEPTH else ""


_FILES = frozenset({"jpeg", "jpg", "png"})
"""Encodings of messages of pixels whose data are an image file."""
_WIDE = {"16SC1": ("h", 1e-3), "64FC1": ("d", 1.0)}
"""Numbers that are shown as float32, in metres: their type code, and their unit in metres."""
_GREY = PixelFormat(Kind.GREY)
_GREY_16 = PixelFormat(Kind.GREY, "H")
_BAYER = ("rggb", "bggr", "gbrg", "grbg")
FORMATS = {
    "16UC1": PixelFormat(Kind.DEPTH, "H"),
    "32FC1": PixelFormat(Kind.DEPTH, "f"),
    "mono8": _GREY,
    "8UC1": _GREY,
    "mono16": _GREY_16,
    "rgb8": PixelFormat(Kind.COLOR, channels="rgb"),
    "bgr8": PixelFormat(Kind.COLOR, channels="bgr"),
    "8UC3": PixelFormat(Kind.COLOR, channels="bgr"),
    "rgba8": PixelFormat(Kind.COLOR, channels="rgba"),
    "bgra8": PixelFormat(Kind.COLOR, channels="bgra"),
    "8UC4": PixelFormat(Kind.COLOR, channels="bgra"),
    **{f"bayer_{order}8": _GREY for order in _BAYER},
    **{f"bayer_{order}16": _GREY_16 for order in _BAYER},
}
"""By sensor_msgs/Image.encoding. OpenCV's are read as by cv_bridge, Bayer mosaics as grey."""


@dataclass(frozen=True, slots=True)
class Pixels:
    """The pixels of an image, from top to bottom and from left to right, without gaps."""

    width: int  # number of columns
    height: int  # number of rows
    format: PixelFormat
    data: bytes  # their numbers, little-endian

    def every(self, step: int) -> "Pixels":
        """Return every ``step``-th pixel of every ``step``-th row, beginning with the first."""
        if step == 1:
            return self
        width, height = -(-self.width // step), -(-self.height // step)
        size = self.format.size
        used = min(self.width, width * step) * size  # used bytes of a row
        rows = memoryview(self.data)
        starts = range(0, self.height * self.width * size, self.width * size * step)
        padding = bytes(width * step * size - used)  # so that pixels are evenly spaced across rows
        kept = b"".join(part for at in starts for part in (rows[at : at + used], padding))
        return replace(self, width=width, height=height, data=_strided(kept, size, step))


def _strided(data: bytes, size: int, step: int) -> bytes:
    """Return every ``step``-th element, of ``size`` bytes each."""
    if code := {1: "B", 2: "H", 4: "I"}.get(size):
        return array(code, data)[::step].tobytes()
    kept = bytearray(len(data) // step)
    for part in range(size):
        kept[part::size] = data[part :: size * step]
    return bytes(kept)


def read_pixels(message: Image) -> Pixels:
    """Read the pixels of a message.

    Raises:
        DecodeError: Its encoding is not known, or its sizes do not fit its data.
    """
    wide, unit = _WIDE.get(message.encoding, ("", 1.0))
    if message.encoding not in FORMATS and not wide:
        known = ", ".join([*FORMATS, *_WIDE, *sorted(_FILES)])
        raise DecodeError(f"pictures in '{message.encoding}' are not shown", f"known: {known}")
    pixel = PixelFormat(Kind.DEPTH, wide) if wide else FORMATS[message.encoding]
    what = f"{message.width} x {message.height} {message.encoding}"
    check_size(message.width, message.height, message.encoding)
    row_bytes = message.width * pixel.size
    least = message.step * (message.height - 1) + row_bytes  # the last row may lack padding
    if message.step < row_bytes or len(message.data) < least:
        raise DecodeError(
            f"{what} does not fit its data: {len(message.data)} bytes in rows of {message.step}"
        )
    data = bytes(message.data[: message.height * message.step])
    if message.step != row_bytes:
        rows, starts = memoryview(data), range(0, message.height * message.step, message.step)
        data = b"".join(rows[at : at + row_bytes] for at in starts)
    if message.is_bigendian and pixel.number != "B":
        numbers = array(pixel.number, data)
        numbers.byteswap()
        data = numbers.tobytes()
    if wide:
        data = array("f", (number * unit for number in array(wide, data))).tobytes()
        pixel = FORMATS["32FC1"]
    return Pixels(message.width, message.height, pixel, data)


def as_file(message: Image | CompressedImage) -> CompressedImage | None:
    """Return the image file that a message has; None if it has pixels."""
    if isinstance(message, CompressedImage):
        return message
    if message.encoding.lower() not in _FILES:
        return None
    return CompressedImage(header=message.header, format=message.encoding, data=message.data)


def image_file(message: CompressedImage) -> bytes:
    """Return the image file in a message, without the header of ROS's compressedDepth."""
    is_depth = "compressedDepth" in message.format
    return bytes(message.data)[_COMPRESSED_DEPTH_HEADER * is_depth :]


def check_size(width: int, height: int, encoding: str) -> None:
    """Refuse images without pixels, and those that would exhaust the memory.

    Raises:
        DecodeError: The size is refused; the error has it.
    """
    if width < 1 or height < 1 or width * height > MOST_PIXELS:
        raise DecodeError(f"a picture of {width} x {height} {encoding} is not shown")
