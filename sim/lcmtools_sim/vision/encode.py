"""Pictures as messages, their headers left empty.

Depth follows REP-118 (https://ros.org/reps/rep-0118.html): 32FC1 is metres, NaN where there is no
reading; 16UC1 is millimetres, 0 where there is none. What is out of the sensor's range is no
reading. Numbers are little-endian.
"""

import numpy as np
import numpy.typing as npt

from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools_sim.vision.color import Pixels
from lcmtools_sim.vision.png import FASTEST, Picture, encode_png
from lcmtools_sim.vision.surfaces import Field

METRES, MILLIMETRES = "32FC1", "16UC1"
_MOST_MILLIMETRES = 65.535  # [m]
_ROUNDING = 1e-6  # relative, of float32: a wall at the very limit is measured


def in_metres(depth: Field, near: float, far: float) -> Field:
    """Depth [m] with NaN for all that is not from ``near`` to ``far`` [m]."""
    return np.where(_valid(depth, near, far), depth, np.float32(np.nan))


def in_millimetres(depth: Field, near: float, far: float) -> npt.NDArray[np.uint16]:
    """Depth [m] as the nearest millimetre, 0 for all that is not from ``near`` to ``far`` [m].

    What 16 bits cannot hold, above 65.535 m, is 0 too.
    """
    valid = _valid(depth, near, min(far, _MOST_MILLIMETRES))
    return np.rint(np.where(valid, depth, np.float32(0)) * np.float32(1000)).astype(np.uint16)


def depth_message(depth: Field, encoding: str, near: float, far: float) -> Image:
    """A depth picture [m] as sensor_msgs/Image.

    Args:
        depth: (height, width) [m]; inf and NaN are no reading.
        encoding: METRES or MILLIMETRES.
        near: Least depth that the sensor measures [m].
        far: Greatest [m].

    Raises:
        ValueError: The encoding is another one.
    """
    if encoding == METRES:
        return _image(in_metres(depth, near, far).astype("<f4", copy=False), encoding)
    if encoding == MILLIMETRES:
        return _image(in_millimetres(depth, near, far).astype("<u2", copy=False), encoding)
    raise ValueError(f"no encoding of depth: {encoding}")


def color_message(picture: Pixels) -> Image:
    """A colour picture (height, width, 3) as sensor_msgs/Image, rgb8."""
    return _image(picture, "rgb8")


def compressed_message(picture: Picture, level: int = FASTEST) -> CompressedImage:
    """A colour picture, or depth in millimetres, as a PNG file in sensor_msgs/CompressedImage."""
    message = CompressedImage()
    message.format = "png"
    message.data = encode_png(picture, level)
    message.data_length = len(message.data)
    return message


def _valid(depth: Field, near: float, far: float) -> npt.NDArray[np.bool_]:
    return (depth >= near * (1 - _ROUNDING)) & (depth <= far * (1 + _ROUNDING))


def _image(pixels: npt.NDArray[np.generic], encoding: str) -> Image:
    message = Image()
    message.height, message.width = pixels.shape[:2]
    message.encoding = encoding
    message.is_bigendian = 0
    message.data = pixels.tobytes()
    message.data_length = len(message.data)
    message.step = message.data_length // message.height
    return message
