"""A colour camera."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import CameraInfo, CompressedImage, Image
from lcmtools_sim.sensors.eye import Eye
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header
from lcmtools_sim.sensors.settings import number
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.encode import color_message, compressed_message

RAW = "image_raw"
COMPRESSED = "image_raw/compressed"
INFO = "camera_info"


@dataclass(frozen=True, slots=True)
class CameraSettings(Settings):
    """What the camera is.

    Attributes:
        width: [pixels]
        height: [pixels]
        field_of_view: From the left to the right edge of the picture [rad].
    """

    width: int = number(640, 1, 4096)
    height: int = number(480, 1, 4096)
    field_of_view: float = number(math.radians(60), 0.01, 3.1, angle=True)


class CameraSensor:
    """Pictures (rgb8) of a pinhole camera without distortion, raw and as PNG files.

    Args:
        mount: Where it is, and its settings.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {
        RAW: Image,
        COMPRESSED: CompressedImage,
        INFO: CameraInfo,
    }

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        settings = cast("CameraSettings", mount.settings or CameraSettings())
        camera = Camera(settings.width, settings.height, settings.field_of_view)
        self._eye = Eye(camera, mount, carrier, "camera_optical_frame")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The pictures of one step."""
        made: dict[str, Image | CompressedImage | CameraInfo] = {}
        if INFO in wanted:
            made[INFO] = self._eye.camera.info()
        if RAW in wanted or COMPRESSED in wanted:
            picture = color_image(self._eye.look(state))
            if RAW in wanted:
                made[RAW] = color_message(picture)
            if COMPRESSED in wanted:
                made[COMPRESSED] = compressed_message(picture)
        for message in made.values():
            fill_header(message.header, state.time, self._eye.frame)
        return {name: encode(message) for name, message in made.items()}
