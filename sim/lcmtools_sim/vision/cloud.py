"""Depth pictures as organised point clouds, the headers left empty.

Points are in the optical frame, in the picture's rows and columns. Colour is packed as PCL reads
it: the field ``rgb`` is a float32 whose bits are 0x00RRGGBB.
"""

import numpy as np

from lcmtools.types.sensor_msgs import PointCloud2, PointField
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.color import Pixels
from lcmtools_sim.vision.encode import in_metres
from lcmtools_sim.vision.surfaces import Field


def points(depth: Field, camera: Camera, near: float, far: float) -> Field:
    """Where each pixel's point is: (height, width, 3) [m], NaN outside of ``near`` to ``far``."""
    result = np.empty((*depth.shape, 3), np.float32)
    _fill(result, in_metres(depth, near, far), camera)
    return result


def cloud_message(
    depth: Field, camera: Camera, near: float, far: float, color: Pixels | None = None
) -> PointCloud2:
    """A depth picture [m] as sensor_msgs/PointCloud2.

    Args:
        depth: (height, width) [m]; inf and NaN are no reading.
        camera: That made the picture.
        near: Least depth that the sensor measures [m].
        far: Greatest [m].
        color: (height, width, 3) of the same pixels; without it the points have none.
    """
    names = ("x", "y", "z") if color is None else ("x", "y", "z", "rgb")
    data = np.empty((*depth.shape, len(names)), "<f4")
    _fill(data, in_metres(depth, near, far), camera)
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


def _fill(result: Field, depth: Field, camera: Camera) -> None:
    """Set x, y and z of each point: the pixel's ray, as long as the depth says."""
    x, y = (slopes.astype(np.float32) for slopes in camera.slopes())
    np.multiply(depth, x, out=result[:, :, 0])
    np.multiply(depth, y[:, None], out=result[:, :, 1])
    result[:, :, 2] = depth


def _field(name: str, offset: int) -> PointField:
    field = PointField()
    field.name, field.offset = name, offset
    field.datatype, field.count = PointField.FLOAT32, 1
    return field
