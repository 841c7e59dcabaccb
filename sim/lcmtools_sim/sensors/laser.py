"""A laser scanner that turns in its own x-y plane."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header, placed
from lcmtools_sim.sensors.settings import deviation, number
from lcmtools_sim.vision.rays import cast as cast_rays
from lcmtools_sim.vision.solids import Floats, matrix, solids_of

_CLEARANCE = 1e-3  # [m] that a ray starts before the robot's own body ends


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
        self._frame = carrier.frame(mount.frame or "laser")
        carrier.frames[self._frame] = mount.pose.position, mount.pose.rotation
        angles = np.linspace(settings.first_angle, settings.last_angle, settings.rays)
        self._rays = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=1)
        self._begin = self._beyond_body(carrier)

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
        rays = self._rays @ matrix(rotation).T
        settings, begin = self._settings, self._begin
        starts = np.array(place) + rays * begin[:, None]
        ends = np.array(place) + rays * settings.longest
        fractions = np.array(self._around.cast(starts.tolist(), ends.tolist()))
        ranges = begin + fractions * (settings.longest - begin)
        if settings.noise:
            ranges += self._generator.normal(0.0, settings.noise, len(ranges))
        ranges[fractions >= 1.0] = np.inf
        ranges[ranges < settings.shortest] = -np.inf
        ranges[ranges > settings.longest] = np.inf
        return ranges

    def _beyond_body(self, carrier: Carrier) -> Floats:
        """How far along each ray the robot's own body ends [m]: seen from outside, backwards."""
        longest = self._settings.longest
        pose = self._mount.pose
        rays = self._rays @ matrix(pose.rotation).T
        outside = np.array(pose.position) + rays * longest
        back = cast_rays(solids_of(carrier.parts), outside, -rays, longest)
        return np.where(np.isfinite(back), longest - back + _CLEARANCE, 0.0)
