"""A laser scanner that turns in its own x-y plane."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.rotation import Vector, axes
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header, placed
from lcmtools_sim.sensors.settings import deviation, number
from lcmtools_sim.shapes import Part
from lcmtools_sim.vision.scan import Scannable, scan, scannable
from lcmtools_sim.vision.solids import Floats, matrix, solids_of

_MOST_KNOWN = 10_000  # bodies


@dataclass(frozen=True, slots=True)
class LaserSettings(Settings):
    """What a scanner is.

    Attributes:
        rays: How many, from the first angle to the last.
        first_angle: [rad] counter-clockwise, 0 along the sensor's x axis.
        last_angle: [rad]
        shortest: What is nearer cannot be measured [m].
        longest: What is farther cannot be measured [m].
        noise: Standard deviation of a range [m].
    """

    rays: int = number(360, 2, 20_000)
    first_angle: float = number(-np.pi / 2, -2 * np.pi, 2 * np.pi, angle=True)
    last_angle: float = number(np.pi / 2, -2 * np.pi, 2 * np.pi, angle=True)
    shortest: float = number(0.05, 0.0, 1e3)
    longest: float = number(10.0, 0.01, 1e3)
    noise: float = deviation()


class LaserSensor:
    """sensor_msgs/LaserScan by REP-117: +inf for no return, -inf for what is too near.

    All rays are measured in the same instant. The robot's own body is transparent to them.

    Args:
        mount: Where it is, and its settings.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {"": LaserScan}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        self._mount = mount
        self._around = carrier.around
        self._settings = settings = cast("LaserSettings", mount.settings or LaserSettings())
        self._generator = carrier.generator(mount)
        self._frame = carrier.put_frame(mount, "laser", mount.pose.rotation)
        angles = np.linspace(settings.first_angle, settings.last_angle, settings.rays)
        self._rays = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=1)
        self._known: dict[int, tuple[tuple[Part, ...], Scannable]] = {}

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The scan of one step."""
        del wanted
        settings, message = self._settings, LaserScan()
        fill_header(message.header, state.time, self._frame)
        message.angle_min, message.angle_max = settings.first_angle, settings.last_angle
        message.angle_increment = (settings.last_angle - settings.first_angle) / (settings.rays - 1)
        message.scan_time = 1 / self._mount.rate
        message.range_min, message.range_max = settings.shortest, settings.longest
        message.ranges = self._ranges(state).tolist()
        return {"": message}

    def _ranges(self, state: RobotState) -> Floats:
        """Distances along all rays [m], with inf as the message has it."""
        place, rotation = placed(state, self._mount.pose)
        settings, (_, _, up) = self._settings, axes(rotation)
        rays = self._rays @ matrix(rotation).T
        ranges = scan(self._groups(place), place, rays, up, settings.longest)
        if settings.noise:
            ranges += self._generator.normal(0.0, settings.noise, len(ranges))
        ranges[ranges < settings.shortest] = -np.inf
        ranges[ranges > settings.longest] = np.inf
        return ranges

    def _groups(self, eye: Vector) -> list[Scannable]:
        """What is around and not too far; shapes are prepared when they are seen first."""
        groups = [self._prepared(self._around.fixed_parts())]
        for parts, position, rotation in self._around.moving_bodies():
            group = self._prepared(parts)
            if math.dist(position, eye) <= self._settings.longest + group.reach:
                groups.append(group.placed(position, rotation))
        return groups

    def _prepared(self, parts: tuple[Part, ...]) -> Scannable:
        """These shapes, which are the same as long as they are the same object."""
        known = self._known.get(id(parts))
        if known is None or known[0] is not parts:
            if len(self._known) > _MOST_KNOWN:  # bodies that have gone
                self._known.clear()
            known = self._known[id(parts)] = parts, scannable(solids_of(parts))
        return known[1]
