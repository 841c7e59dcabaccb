"""A laser scanner that turns in its own x-y plane."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.geometry import IDENTITY, ZERO
from lcmtools_sim.sensors.sensor import (
    RobotState,
    SensorContext,
    SensorMount,
    Settings,
    deviation,
    number,
)
from lcmtools_sim.shapes import Part
from lcmtools_sim.vision.scan import Body, Scanner
from lcmtools_sim.vision.solids import Floats, Solids, solids_of

_MOST_PREPARED = 10_000  # bodies


@dataclass(frozen=True, slots=True)
class LaserSettings(Settings):
    """The properties of a scanner.

    Attributes:
        rays: Their number, from the first angle to the last.
        first_angle: [rad] counter-clockwise, 0 along the sensor's x axis.
        last_angle: [rad]
        shortest: Least range [m].
        longest: Greatest range [m].
        noise: Standard deviation of a range [m].
    """

    rays: int = number(360, 2, 20_000)
    first_angle: float = number(-np.pi / 2, -2 * np.pi, 2 * np.pi, angle=True)
    last_angle: float = number(np.pi / 2, -2 * np.pi, 2 * np.pi, angle=True)
    shortest: float = number(0.05, 0.0, 1e3)
    longest: float = number(10.0, 0.01, 1e3)
    noise: float = deviation()


class LaserSensor:
    """sensor_msgs/LaserScan by REP-117: +inf for no return, -inf for a return that is too near.

    All rays are measured in the same instant. The robot's own body is transparent to them.
    """

    outputs: Mapping[str, type[Message]] = {"": LaserScan}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        self._pose = mount.pose
        self._context = context
        self._settings = settings = cast("LaserSettings", mount.settings or LaserSettings())
        self._noise = context.noise(mount)
        angles = np.linspace(settings.first_angle, settings.last_angle, settings.rays)
        self._scanner = Scanner(angles, settings.longest)
        self._prepared: dict[int, tuple[tuple[Part, ...], Solids]] = {}
        message = LaserScan()
        message.header.frame_id = context.add_frame(mount, "laser", mount.pose.rotation)
        message.angle_min, message.angle_max = settings.first_angle, settings.last_angle
        message.angle_increment = (settings.last_angle - settings.first_angle) / (settings.rays - 1)
        message.scan_time = 1 / mount.rate
        message.range_min, message.range_max = settings.shortest, settings.longest
        message.ranges = [0.0] * settings.rays
        self._fill = PayloadTemplate(message, "header.stamp", "ranges").fill

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The scan of one step."""
        del wanted
        return {"": self._fill(state.stamp, self._ranges(state).tolist())}

    def _ranges(self, state: RobotState) -> Floats:
        """The ranges of all rays [m], with inf as the message has it."""
        settings = self._settings
        ranges = self._scanner.scan(*state.sensor_frame(self._pose), self._bodies())
        if settings.noise:
            ranges += self._noise.at(state.time).normal(0.0, settings.noise, len(ranges))
            ranges[ranges > settings.longest] = np.inf
        ranges[ranges < settings.shortest] = -np.inf
        return ranges

    def _bodies(self) -> list[Body]:
        solids, world = self._solids, self._context.world
        moving = world.moving_bodies(self._context.body)
        return [
            (solids(world.fixed_parts()), ZERO, IDENTITY),
            *[(solids(parts), place, turn) for parts, place, turn in moving],
        ]

    def _solids(self, parts: tuple[Part, ...]) -> Solids:
        """These shapes as arrays; shapes are the same as long as they are the same object."""
        known = self._prepared.get(id(parts))
        if known is None or known[0] is not parts:
            if len(self._prepared) > _MOST_PREPARED:  # bodies that are deleted
                self._prepared.clear()
            known = self._prepared[id(parts)] = parts, solids_of(parts)
        return known[1]
