"""Pictures in messages and files, as Pillow's images."""

import warnings
from array import array
from dataclasses import dataclass
from io import BytesIO
from typing import cast

import PIL.Image
from PIL import UnidentifiedImageError

from lcmtools.errors import DecodeError
from lcmtools.messages.pixels import Kind, as_file, check_size, image_file, read_pixels
from lcmtools.types.sensor_msgs import CompressedImage, Image

_FARTHEST = 1e6  # [m]

# Pillow's modes and its raw modes for little-endian numbers, by those of an image
_MODES = {"B": ("L", "L"), "H": ("I", "I;16"), "f": ("F", "F;32F")}
_RAW_COLORS = {"rgb": "RGB", "bgr": "BGR", "rgba": "RGBX", "bgra": "BGRX"}


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture."""

    # Its pixels: depth in mm (mode I) or m (mode F), grey (L or I), or colour (RGB).
    image: PIL.Image.Image
    encoding: str  # the message's
    kind: Kind

    def fitted(self, width: int, height: int) -> "Picture":
        """Scale the picture to fit into a size [pixels], with its aspect ratio.

        Nearest pixels are used: averages of depths between an object and the background would show
        something that does not exist.
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
            raise ValueError("colours have no values")
        data = self.image.tobytes()
        if self.image.mode == "F":
            return [round(z * 1000) if 0 < z < _FARTHEST else 0 for z in array("f", data)]
        return list(data) if self.image.mode == "L" else array("i", data).tolist()


def read_picture(message: Image | CompressedImage) -> Picture:
    """Read the picture in a message.

    Raises:
        DecodeError: It is broken, or of an encoding that cannot be shown.
    """
    file = as_file(message)
    return read_file(image_file(file)) if file else _raw(cast("Image", message))


def read_file(data: bytes) -> Picture:
    """Read a PNG, JPEG or PGM file; DecodeError if it is broken, or of another format."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # Pillow warns of sizes that exhaust the memory
            image = PIL.Image.open(BytesIO(data), formats=("PNG", "JPEG", "PPM"))
        check_size(*image.size, image.format or "")
        image.load()
    except UnidentifiedImageError:
        raise DecodeError("broken picture: it is not a PNG, JPEG or PGM file") from None
    except (OSError, SyntaxError, ValueError, Warning, PIL.Image.DecompressionBombError) as error:
        raise DecodeError(f"broken picture: {error}") from None
    if image.mode.startswith("I"):
        return Picture(image.convert("I"), "16UC1", Kind.DEPTH)
    if image.mode in ("1", "L", "LA"):
        return Picture(image.convert("L"), "mono8", Kind.GREY)
    return Picture(image.convert("RGB"), "rgb8", Kind.COLOR)


def _raw(message: Image) -> Picture:
    pixels = read_pixels(message)
    raw_color = _RAW_COLORS.get(pixels.format.channels)
    mode, raw_mode = ("RGB", raw_color) if raw_color else _MODES[pixels.format.number]
    size = pixels.width, pixels.height
    image = PIL.Image.frombytes(mode, size, pixels.data, "raw", raw_mode)
    return Picture(image, message.encoding, pixels.format.kind)
