"""A laser scanner that turns in its own x-y plane."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Annotated, cast

import numpy as np

from lcmtools.formats.typed import Within
from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.geometry import IDENTITY, ZERO
from lcmtools_sim.sensors.sensor import (
    BatchSensor,
    Deviation,
    MeasureBatch,
    RobotState,
    SensorContext,
    SensorMount,
    Settings,
)
from lcmtools_sim.vision.scan import Scanner
from lcmtools_sim.vision.solids import Floats, PlacedSolids

if TYPE_CHECKING:
    from typing_extensions import Self


@dataclass(frozen=True, slots=True)
class LaserSettings(Settings):
    """The properties of a scanner."""

    rays: Annotated[int, Within(2, 20_000)] = 360  # from the first angle to the last
    # [rad] counter-clockwise, 0 along the sensor's x axis.
    first_angle: Annotated[float, Within(-2 * np.pi, 2 * np.pi, unit="rad")] = -np.pi / 2
    last_angle: Annotated[float, Within(-2 * np.pi, 2 * np.pi, unit="rad")] = np.pi / 2  # [rad]
    shortest: Annotated[float, Within(0.0, 1e3)] = 0.05  # least range [m]
    longest: Annotated[float, Within(0.01, 1e3, above="shortest")] = 10.0  # greatest range [m]
    noise: Deviation = 0.0  # standard deviation of a range [m]


class LaserSensor(BatchSensor):
    """sensor_msgs/LaserScan by REP-117: +inf for no return, -inf for a return that is too near.

    All rays are measured in the same instant. The robot's own body is transparent to them.
    """

    outputs: Mapping[str, type[Message]] = {"": LaserScan}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        self._pose, self.body, self._world = mount.pose, context.body, context.world
        self._settings = settings = cast("LaserSettings", mount.settings or LaserSettings())
        self._noise = context.noise(mount)
        angles = np.linspace(settings.first_angle, settings.last_angle, settings.rays)
        self._scanner = Scanner(angles, settings.longest)
        message = LaserScan()
        message.header.frame_id = context.add_frame(mount, "laser", mount.pose.rotation)
        message.angle_min, message.angle_max = settings.first_angle, settings.last_angle
        message.angle_increment = (settings.last_angle - settings.first_angle) / (settings.rays - 1)
        message.scan_time = 1 / mount.rate
        message.range_min, message.range_max = settings.shortest, settings.longest
        message.ranges = [0.0] * settings.rays
        self._template = PayloadTemplate(message, "header.stamp", "ranges")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the scan of one step."""
        del wanted
        bodies = dict(self._world.moving_bodies())
        del bodies[self.body]
        around = [self._fixed(), *bodies.values()]
        ranges = self._scanner.scan(*state.sensor_frame(self._pose), around)
        return {"": self.payload(state, ranges)}

    def batch(self, sensors: Sequence[tuple["Self", int]]) -> MeasureBatch:
        """Return the function that measures these sensors at once; see BatchSensor."""
        return partial(self._scans, sensors)

    def _scans(self, sensors: Sequence[tuple["Self", int]], state: RobotState) -> Iterator[bytes]:
        count = np.size(state.wheel_speeds.left)
        indices = [index for _, index in sensors]
        eyes, rotations = (
            np.array([np.broadcast_to(values, count)[indices] for values in vector])
            for vector in state.sensor_frame(self._pose)
        )
        bodies = self._world.moving_bodies()
        numbers = {body: number for number, body in enumerate(bodies, 1)}
        own = np.array([numbers[sensor.body] for sensor, _ in sensors])
        around = [self._fixed(), *bodies.values()]
        scans = self._scanner.scan_batch(eyes, rotations, around, own)
        for (sensor, _), ranges in zip(sensors, scans, strict=True):
            yield sensor.payload(state, ranges)

    def payload(self, state: RobotState, ranges: Floats) -> bytes:
        """Return the message of these ranges [m], with noise, and infinities as in REP-117."""
        settings = self._settings
        if settings.noise:
            ranges += self._noise.at(state.time).normal(0.0, settings.noise, len(ranges))
            ranges[ranges > settings.longest] = np.inf
        ranges[ranges < settings.shortest] = -np.inf
        stamp = np.array(state.stamp, ">i4")
        return self._template.fill_packed((stamp.tobytes(), ranges.astype(">f4").tobytes()))

    def _fixed(self) -> PlacedSolids:
        return self._world.fixed_solids(), ZERO, IDENTITY
