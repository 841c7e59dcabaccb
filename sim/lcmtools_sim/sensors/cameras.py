"""A colour camera, and a depth camera with a colour camera in the same place, like the Kinect.

Source of the Kinect's errors: K. Khoshelham, S. Oude Elberink, Accuracy and Resolution of Kinect
Depth Data for Indoor Mapping Applications, Sensors 12(2), 2012: the random error grows with the
square of the depth, 1.4 mm at 1 m and about 4 cm at 5 m; so does the resolution, 2.85 mm at 1 m.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Annotated, cast

import numpy as np

from lcmtools.formats.typed import Within
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.processes.memory import keep_freed_memory
from lcmtools.types.sensor_msgs import CameraInfo, CompressedImage, Image, PointCloud2
from lcmtools_sim.sensors.sensor import (
    Deviation,
    RobotState,
    SensorContext,
    SensorMount,
    Settings,
    fill_header,
)
from lcmtools_sim.vision import messages
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import Pixels, color_image
from lcmtools_sim.vision.render import Rendering, render
from lcmtools_sim.vision.solids import Solids, joined, solids_of
from lcmtools_sim.vision.surfaces import Floats32


def noisy(
    depth: Floats32,
    random: np.random.Generator,
    *,
    spread: float = 0.0,
    step: float = 0.0,
    dropout: float = 0.0,
) -> Floats32:
    """Return depth [m] with the errors; inf stays inf, a dropped reading is NaN.

    The number of random numbers depends only on the picture's size, so that runs are repeatable.

    Args:
        depth: Exact depth [m].
        random: The random numbers.
        spread: Standard deviation at 1 m [m]; at z metres it is z^2 times this.
        step: Distance between two neighbouring readings at 1 m [m]; at z metres it is z^2 times
            this, because the sensor counts steps of disparity, which is 1/z. With 0, depth is
            continuous, and 16UC1 rounds it to millimetres. The spread was measured including the
            steps: using both adds z^2 step / sqrt(12) to it, in quadrature.
        dropout: Share of the pixels without a reading, 0 to 1.
    """
    if spread:
        error = random.standard_normal(depth.shape, np.float32) * np.float32(spread)
        with np.errstate(invalid="ignore"):
            depth = np.where(np.isinf(depth), depth, depth + depth * depth * error)
    if step:
        size = np.float32(step)
        with np.errstate(divide="ignore"):
            depth = np.float32(1) / (np.rint(1 / (depth * size)) * size)
    if dropout:
        lost = random.random(depth.shape, np.float32) < dropout
        depth = np.where(lost, np.float32(np.nan), depth)
    return depth


RAW = "image_raw"
COMPRESSED = "image_raw/compressed"
INFO = "camera_info"
DEPTH_RAW = "depth/image_raw"
DEPTH_METRES = "depth/image"
DEPTH_COMPRESSED = "depth/image_raw/compressed"
DEPTH_INFO = "depth/camera_info"
POINTS = "depth/points"
COLOR_RAW = "rgb/image_raw"
COLOR_COMPRESSED = "rgb/image_raw/compressed"
COLOR_INFO = "rgb/camera_info"

BULKY = frozenset((DEPTH_METRES, POINTS))
"""The same data as other outputs in five times the size: megabytes, thirty times a second."""

_COLORED = {COLOR_RAW, COLOR_COMPRESSED, POINTS}
_PICTURES = _COLORED | {DEPTH_RAW, DEPTH_METRES, DEPTH_COMPRESSED}
_Makers = dict[str, Callable[[], Image | CompressedImage | CameraInfo | PointCloud2]]
"""The functions that create the message of each output, by its name."""


@dataclass(frozen=True, slots=True)
class CameraSettings(Settings):
    """The properties of a camera."""

    width: Annotated[int, Within(1, 4096)] = 640  # [pixels]
    height: Annotated[int, Within(1, 4096)] = 480  # [pixels]
    field_of_view: Annotated[float, Within(0.01, 3.1, unit="rad")] = math.radians(60)

    @property
    def camera(self) -> Camera:
        """The intrinsics."""
        return Camera(self.width, self.height, self.field_of_view)


class _MountedCamera:
    """A camera on a robot, at its mount's pose (x into the scene). It does not see the robot.

    ``frame`` is the usual name of its optical frame (z into the scene, x right, y down), without
    the prefix.
    """

    def __init__(
        self, camera: Camera, mount: SensorMount, context: SensorContext, frame: str
    ) -> None:
        self.camera = camera
        self._frame = context.add_frame(mount, frame, optical(mount.pose.rotation))
        self._pose, self._context = mount.pose, context
        self._fixed: Solids | None = None
        self._fixed_parts: object = None
        keep_freed_memory()  # a picture's arrays are as large as the previous picture's

    def view(self, state: RobotState, *, only_depth: bool = False) -> Rendering:
        """Return the view after one step."""
        position, rotation = state.sensor_frame(self._pose)
        view = optical(rotation)
        return render(self._solids(), self.camera, position, view, only_depth=only_depth)

    def encoded(
        self, makers: _Makers, wanted: Collection[str], state: RobotState
    ) -> dict[str, bytes]:
        """Return the payloads of the wanted messages, with their headers."""
        made = {name: make() for name, make in makers.items() if name in wanted}
        for message in made.values():
            fill_header(message.header, state.time, self._frame)
        return {name: encode(message) for name, message in made.items()}

    def _solids(self) -> Solids:
        """Return all shapes except the robot's; the immovable ones are prepared once."""
        context, world = self._context, self._context.world
        parts = world.fixed_parts()
        if self._fixed is None or parts is not self._fixed_parts:
            self._fixed = solids_of(parts, context.ground_color, context.lines)
            self._fixed_parts = parts
        moving = world.moving_parts(context.body)
        return joined(self._fixed, solids_of(moving)) if moving else self._fixed


class CameraSensor:
    """Pictures (rgb8) of a pinhole camera without distortion, raw and as PNG files."""

    outputs: Mapping[str, type[Message]] = {
        RAW: Image,
        COMPRESSED: CompressedImage,
        INFO: CameraInfo,
    }

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        settings = cast("CameraSettings", mount.settings or CameraSettings())
        self._mounted = _MountedCamera(settings.camera, mount, context, "camera_optical_frame")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the pictures of one step."""
        makers: _Makers = {INFO: self._mounted.camera.info}
        if RAW in wanted or COMPRESSED in wanted:
            picture = color_image(self._mounted.view(state))
            makers |= _color_makers(picture, RAW, COMPRESSED)
        return self._mounted.encoded(makers, wanted, state)


@dataclass(frozen=True, slots=True)
class DepthCameraSettings(CameraSettings):
    """The properties of a depth camera; the defaults are a Kinect without noise."""

    field_of_view: Annotated[float, Within(0.01, 3.1, unit="rad")] = math.radians(57)
    near: Annotated[float, Within(0.001, 100.0)] = 0.5  # least depth that is measured [m]
    # greatest depth that is measured [m]
    far: Annotated[float, Within(0.01, 1000.0, above="near")] = 8.0
    noise: Deviation = 0.0  # standard deviation at a depth of 1 m [m]; grows with its square
    step: Deviation = 0.0  # between two neighbouring readings at 1 m [m]; grows with its square
    dropout: Annotated[float, Within(0.0, 1.0)] = 0.0  # share of the pixels without a reading


class DepthCameraSensor:
    """Depth (16UC1 in mm and 32FC1 in m, REP-118), colour, and points, registered pixel by pixel.

    Both cameras have one optical frame and one camera_info, which is exact for their pixels.
    """

    outputs: Mapping[str, type[Message]] = {
        DEPTH_RAW: Image,
        DEPTH_METRES: Image,
        DEPTH_COMPRESSED: CompressedImage,
        DEPTH_INFO: CameraInfo,
        POINTS: PointCloud2,
        COLOR_RAW: Image,
        COLOR_COMPRESSED: CompressedImage,
        COLOR_INFO: CameraInfo,
    }

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        settings = cast("DepthCameraSettings", mount.settings or DepthCameraSettings())
        self._settings = settings
        spread, step, dropout = settings.noise, settings.step, settings.dropout
        self._errors = {"spread": spread, "step": step, "dropout": dropout}
        frame = "camera_depth_optical_frame"
        self._mounted = _MountedCamera(settings.camera, mount, context, frame)
        self._noise = context.noise(mount)

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the pictures of one step; their common view is rendered once."""
        makers: _Makers = {}
        if _PICTURES.intersection(wanted):
            is_colored = bool(_COLORED.intersection(wanted))
            view = self._mounted.view(state, only_depth=not is_colored)
            color = color_image(view) if is_colored else None
            depth = noisy(view.depth, self._noise.at(state.time), **self._errors)
            makers |= self._depth_makers(depth, color)
            if color is not None:
                makers |= _color_makers(color, COLOR_RAW, COLOR_COMPRESSED)
        makers |= dict.fromkeys((DEPTH_INFO, COLOR_INFO), self._mounted.camera.info)
        return self._mounted.encoded(makers, wanted, state)

    def _depth_makers(self, depth: Floats32, color: Pixels | None) -> _Makers:
        near, far, camera = self._settings.near, self._settings.far, self._mounted.camera
        return {
            DEPTH_RAW: lambda: messages.depth_message(depth, messages.MILLIMETRES, near, far),
            DEPTH_METRES: lambda: messages.depth_message(depth, messages.METRES, near, far),
            DEPTH_COMPRESSED: lambda: messages.compressed_message(
                messages.in_millimetres(depth, near, far)
            ),
            POINTS: lambda: messages.cloud_message(depth, camera, near, far, color),
        }


def _color_makers(color: Pixels, raw: str, compressed: str) -> _Makers:
    return {
        raw: lambda: messages.color_message(color),
        compressed: lambda: messages.compressed_message(color),
    }
