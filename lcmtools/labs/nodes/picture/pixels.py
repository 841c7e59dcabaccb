"""Pictures in messages: their size, their kind, and their pixels as a Pillow image."""

import warnings
from array import array
from dataclasses import dataclass
from enum import Enum
from io import BytesIO

from lcmtools.errors import DecodeError, MissingExtra
from lcmtools.types.sensor_msgs import CompressedImage, Image

try:
    import PIL.Image
    from PIL import UnidentifiedImageError
except ImportError as error:
    raise MissingExtra(
        "showing pictures needs Pillow, which is not installed",
        "install the extra 'view' of lcmtools-robotics, or type: pip install pillow textual-image",
    ) from error

_MOST_PIXELS = 1 << 26
_FARTHEST = 1e6  # [m]
_COMPRESSED_DEPTH_HEADER = 12  # bytes that ROS's compressedDepth puts before the PNG file


class Kind(Enum):
    """The meaning of a pixel."""

    DEPTH = "depth"
    GREY = "grey"
    COLOR = "color"


# By sensor_msgs/Image's encoding (those of OpenCV as cv_bridge reads them): kind, Pillow's mode,
# its raw modes for little-endian and big-endian data, and the bytes of a pixel.
_ENCODINGS = {
    "16UC1": (Kind.DEPTH, "I", "I;16", "I;16B", 2),
    "32FC1": (Kind.DEPTH, "F", "F;32F", "F;32BF", 4),
    "mono8": (Kind.GREY, "L", "L", "L", 1),
    "8UC1": (Kind.GREY, "L", "L", "L", 1),
    "mono16": (Kind.GREY, "I", "I;16", "I;16B", 2),
    "rgb8": (Kind.COLOR, "RGB", "RGB", "RGB", 3),
    "bgr8": (Kind.COLOR, "RGB", "BGR", "BGR", 3),
    "8UC3": (Kind.COLOR, "RGB", "BGR", "BGR", 3),
    "rgba8": (Kind.COLOR, "RGB", "RGBX", "RGBX", 4),
    "bgra8": (Kind.COLOR, "RGB", "BGRX", "BGRX", 4),
    "8UC4": (Kind.COLOR, "RGB", "BGRX", "BGRX", 4),
}


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture.

    Attributes:
        image: Its pixels: depth in mm (mode I) or m (mode F), grey (L or I), or colour (RGB).
        encoding: The message's.
        kind: The meaning of a pixel.
    """

    image: PIL.Image.Image
    encoding: str
    kind: Kind

    def fitted(self, width: int, height: int) -> "Picture":
        """Return the picture in its own proportions, as large as a room [pixels] allows.

        The nearest pixel is taken: a mean of depths would show what is not there, between a thing
        and the background.
        """
        scale = min(width / self.image.width, height / self.image.height)
        size = max(1, round(self.image.width * scale)), max(1, round(self.image.height * scale))
        shown = self.image.resize(size, PIL.Image.Resampling.NEAREST)
        return Picture(shown, self.encoding, self.kind)

    def values(self) -> list[int]:
        """Return depth in mm, 0 where there is none, or grey, row by row.

        Raises:
            ValueError: The picture is of colours.
        """
        if self.kind is Kind.COLOR:
            raise ValueError("colours are no values")
        data = self.image.tobytes()
        if self.image.mode == "F":
            return [round(z * 1000) if 0 < z < _FARTHEST else 0 for z in array("f", data)]
        return list(data) if self.image.mode == "L" else array("i", data).tolist()


def read_picture(message: Image | CompressedImage) -> Picture:
    """Read the picture in a message.

    Raises:
        DecodeError: It is broken, or of an encoding that cannot be shown.
    """
    return _compressed(message) if isinstance(message, CompressedImage) else _raw(message)


def read_file(data: bytes) -> Picture:
    """Read a PNG or JPEG file.

    Raises:
        DecodeError: It is broken, or of another format.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # Pillow warns of sizes that exhaust the memory
            image = PIL.Image.open(BytesIO(data), formats=("PNG", "JPEG"))
        _check_size(*image.size, image.format or "")
        image.load()
    except UnidentifiedImageError:
        raise DecodeError("broken picture: it is no PNG or JPEG file") from None
    except (OSError, SyntaxError, ValueError, Warning, PIL.Image.DecompressionBombError) as error:
        raise DecodeError(f"broken picture: {error}") from None
    if image.mode.startswith("I"):
        return Picture(image.convert("I"), "16UC1", Kind.DEPTH)
    if image.mode in ("1", "L", "LA"):
        return Picture(image.convert("L"), "mono8", Kind.GREY)
    return Picture(image.convert("RGB"), "rgb8", Kind.COLOR)


def _compressed(message: CompressedImage) -> Picture:
    data = bytes(message.data)
    return read_file(data[_COMPRESSED_DEPTH_HEADER * ("compressedDepth" in message.format) :])


def _raw(message: Image) -> Picture:
    if message.encoding not in _ENCODINGS:
        raise DecodeError(
            f"pictures in '{message.encoding}' are not shown", f"known: {', '.join(_ENCODINGS)}"
        )
    kind, mode, little, big, pixel_bytes = _ENCODINGS[message.encoding]
    what = f"{message.width} x {message.height} {message.encoding}"
    _check_size(message.width, message.height, message.encoding)
    row_bytes = message.width * pixel_bytes
    least = message.step * (message.height - 1) + row_bytes  # the last row may be short
    if message.step < row_bytes or len(message.data) < least:
        raise DecodeError(
            f"{what} does not fit its data: {len(message.data)} bytes in rows of {message.step}"
        )
    raw_mode = big if message.is_bigendian else little
    size = message.width, message.height
    data = bytes(message.data).ljust(message.step * message.height, b"\0")
    image = PIL.Image.frombytes(mode, size, data, "raw", raw_mode, message.step)
    return Picture(image, message.encoding, kind)


def _check_size(width: int, height: int, encoding: str) -> None:
    if width < 1 or height < 1 or width * height > _MOST_PIXELS:
        raise DecodeError(f"a picture of {width} x {height} {encoding} is not shown")
