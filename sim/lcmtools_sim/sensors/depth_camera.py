"""A depth camera with a colour camera in the same place, as the Kinect is."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import CameraInfo, CompressedImage, Image, PointCloud2
from lcmtools.types.std_msgs import Header
from lcmtools_sim.sensors.eye import Eye
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header
from lcmtools_sim.sensors.settings import deviation, number
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.cloud import cloud_message
from lcmtools_sim.vision.color import Pixels, color_image
from lcmtools_sim.vision.depth import Sight
from lcmtools_sim.vision.encode import (
    METRES,
    MILLIMETRES,
    color_message,
    compressed_message,
    depth_message,
    in_millimetres,
)
from lcmtools_sim.vision.noise import DepthNoise, noisy
from lcmtools_sim.vision.surfaces import Field

RAW = "depth/image_raw"
METRIC = "depth/image"
COMPRESSED = "depth/image_raw/compressed"
INFO = "depth/camera_info"
POINTS = "depth/points"
COLOR = "rgb/image_raw"
COLOR_COMPRESSED = "rgb/image_raw/compressed"
COLOR_INFO = "rgb/camera_info"

BULKY = frozenset((METRIC, POINTS))
"""What other outputs tell too, in a fifth of the bytes: megabytes, thirty times a second."""

_COLORED = {COLOR, COLOR_COMPRESSED, POINTS}
_LOOKING = _COLORED | {RAW, METRIC, COMPRESSED}


@dataclass(frozen=True, slots=True)
class DepthCameraSettings(Settings):
    """What the camera is; as it stands, a Kinect without noise.

    Attributes:
        width: [pixels]
        height: [pixels]
        field_of_view: From the left to the right edge of the picture [rad].
        near: Least depth that is measured [m].
        far: Greatest depth that is measured [m].
        noise: Standard deviation of the depth at 1 m [m]; it grows with its square.
        step: Distance of two neighbouring readings at 1 m [m]; it grows with its square.
        dropout: Share of the pixels without a reading.
    """

    width: int = number(640, 1, 4096)
    height: int = number(480, 1, 4096)
    field_of_view: float = number(math.radians(57), 0.01, 3.1, angle=True)
    near: float = number(0.5, 0.001, 100.0)
    far: float = number(8.0, 0.01, 1000.0)
    noise: float = deviation()
    step: float = deviation()
    dropout: float = number(0.0, 0.0, 1.0)


class DepthCameraSensor:
    """Depth (16UC1 in mm and 32FC1 in m, REP-118), colour, and points, pixel by pixel the same.

    Both cameras have one optical frame and one camera_info, which is exact for their pixels.

    Args:
        mount: Where it is, and its settings.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {
        RAW: Image,
        METRIC: Image,
        COMPRESSED: CompressedImage,
        INFO: CameraInfo,
        POINTS: PointCloud2,
        COLOR: Image,
        COLOR_COMPRESSED: CompressedImage,
        COLOR_INFO: CameraInfo,
    }

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        settings = cast("DepthCameraSettings", mount.settings or DepthCameraSettings())
        camera = Camera(settings.width, settings.height, settings.field_of_view)
        self._settings = settings
        self._eye = Eye(camera, mount, carrier, "camera_depth_optical_frame")
        self._noise = DepthNoise(settings.noise, settings.step, settings.dropout)
        self._generator = carrier.generator(mount)

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The pictures of one step; what they have in common is computed once."""
        camera = self._eye.camera
        made: dict[str, Image | CompressedImage | CameraInfo | PointCloud2] = {}
        if _LOOKING.intersection(wanted):
            sight = self._eye.look(state)
            color = color_image(sight) if _COLORED.intersection(wanted) else None
            made.update(self._depth_messages(sight, color, wanted))
            if color is not None:
                made.update(_color_messages(color, wanted))
        made.update({name: camera.info() for name in (INFO, COLOR_INFO) if name in wanted})
        for message in made.values():
            self._stamp(message.header, state)
        return {name: encode(message) for name, message in made.items()}

    def _depth_messages(
        self, sight: Sight, color: Pixels | None, wanted: Collection[str]
    ) -> dict[str, Image | CompressedImage | PointCloud2]:
        depth, near, far = self._read(sight), self._settings.near, self._settings.far
        made: dict[str, Image | CompressedImage | PointCloud2] = {}
        if RAW in wanted:
            made[RAW] = depth_message(depth, MILLIMETRES, near, far)
        if METRIC in wanted:
            made[METRIC] = depth_message(depth, METRES, near, far)
        if COMPRESSED in wanted:
            made[COMPRESSED] = compressed_message(in_millimetres(depth, near, far))
        if POINTS in wanted:
            made[POINTS] = cloud_message(depth, sight.camera, near, far, color)
        return made

    def _read(self, sight: Sight) -> Field:
        """The depth as this camera measures it [m]."""
        return noisy(sight.depth, self._noise, self._generator)

    def _stamp(self, header: Header, state: RobotState) -> None:
        fill_header(header, state.time, self._eye.frame)


def _color_messages(color: Pixels, wanted: Collection[str]) -> dict[str, Image | CompressedImage]:
    made: dict[str, Image | CompressedImage] = {}
    if COLOR in wanted:
        made[COLOR] = color_message(color)
    if COLOR_COMPRESSED in wanted:
        made[COLOR_COMPRESSED] = compressed_message(color)
    return made
