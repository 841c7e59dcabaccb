"""Pictures as messages, with empty headers: images, PNG files and point clouds.

Depth follows REP-118 (https://ros.org/reps/rep-0118.html): 32FC1 is metres, NaN for no reading;
16UC1 is millimetres, 0 for no reading. Depth out of range is no reading. Numbers are
little-endian. Points are in the optical frame, in the picture's rows and columns. Their colour is
packed as PCL reads it: the field ``rgb`` is a float32 whose bits are 0x00RRGGBB.
"""

import zlib
from io import BytesIO

import numpy as np
import numpy.typing as npt

from lcmtools.types.sensor_msgs import CompressedImage, Image, PointCloud2, PointField
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.color import Pixels
from lcmtools_sim.vision.surfaces import Floats32

METRES, MILLIMETRES = "32FC1", "16UC1"
_MOST_MILLIMETRES = 65.535  # [m]
_ROUNDING = 1e-6  # relative, for float32: a wall exactly at the limit is measured
_FASTEST = {"compress_level": 1, "compress_type": zlib.Z_RLE}
"""Higher levels take longer (6: five times as long for noisy depth) and save a few percent."""


def in_metres(depth: Floats32, near: float, far: float) -> Floats32:
    """Return depth [m], with NaN outside of ``near`` to ``far`` [m]."""
    return np.where(_valid(depth, near, far), depth, np.float32(np.nan))


def in_millimetres(depth: Floats32, near: float, far: float) -> npt.NDArray[np.uint16]:
    """Return depth [m] rounded to millimetres, with 0 outside of ``near`` to ``far`` [m].

    Depth that does not fit into 16 bits, above 65.535 m, is also 0.
    """
    metric = depth * np.float32(1000)
    with np.errstate(invalid="ignore"):  # values out of range become 0 below
        millimetres: npt.NDArray[np.uint16] = np.rint(metric, out=metric).astype(np.uint16)
    millimetres *= _valid(depth, near, min(far, _MOST_MILLIMETRES))
    return millimetres


def depth_message(depth: Floats32, encoding: str, near: float, far: float) -> Image:
    """Return a depth picture (height, width) [m] as sensor_msgs/Image.

    Inf and NaN mean no reading. The encoding is METRES or MILLIMETRES, else ValueError; the sensor
    measures depths from near to far [m].
    """
    if encoding == METRES:
        return _image(in_metres(depth, near, far).astype("<f4", copy=False), encoding)
    if encoding == MILLIMETRES:
        return _image(in_millimetres(depth, near, far).astype("<u2", copy=False), encoding)
    raise ValueError(f"no encoding of depth: {encoding}")


def color_message(picture: Pixels) -> Image:
    """Return a colour picture (height, width, 3) as sensor_msgs/Image, rgb8."""
    return _image(picture, "rgb8")


def compressed_message(picture: Pixels | npt.NDArray[np.uint16]) -> CompressedImage:
    """Return a colour picture, or depth in millimetres, as PNG in sensor_msgs/CompressedImage."""
    message = CompressedImage()
    message.format = "png"
    message.data = png_file(picture)
    message.data_length = len(message.data)
    return message


def png_file(picture: Pixels | npt.NDArray[np.uint16]) -> bytes:
    """Return the content of a PNG file: (height, width, 3) uint8, or (height, width) uint16."""
    from PIL import Image as PillowImage

    file = BytesIO()
    PillowImage.fromarray(picture).save(file, "PNG", **_FASTEST)
    return file.getvalue()


def cloud_message(
    depth: Floats32, camera: Camera, near: float, far: float, color: Pixels | None = None
) -> PointCloud2:
    """Return a camera's depth picture (height, width) [m] as an organized sensor_msgs/PointCloud2.

    Inf and NaN mean no reading; the sensor measures depths from near to far [m]. ``color`` has
    the same pixels, (height, width, 3); without it, the points have no colour.
    """
    names = ("x", "y", "z") if color is None else ("x", "y", "z", "rgb")
    data = np.empty((*depth.shape, len(names)), "<f4")
    x, y = (slopes.astype(np.float32) for slopes in camera.slopes())
    metres = data[:, :, 2] = in_metres(depth, near, far)
    np.multiply(metres, x, out=data[:, :, 0])
    np.multiply(metres, y[:, None], out=data[:, :, 1])
    if color is not None:
        red, green, blue = np.moveaxis(color.astype(np.uint32), -1, 0)
        data.view("<u4")[:, :, 3] = red << 16 | green << 8 | blue
    message = PointCloud2()
    message.height, message.width = depth.shape
    message.fields = [_field(name, 4 * number) for number, name in enumerate(names)]
    message.fields_length = len(names)
    message.is_bigendian = False
    message.point_step = 4 * len(names)
    message.row_step = message.point_step * message.width
    message.data = data.tobytes()
    message.data_length = len(message.data)
    message.is_dense = False
    return message


def _valid(depth: Floats32, near: float, far: float) -> npt.NDArray[np.bool_]:
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


def _field(name: str, offset: int) -> PointField:
    field = PointField()
    field.name, field.offset = name, offset
    field.datatype, field.count = PointField.FLOAT32, 1
    return field
