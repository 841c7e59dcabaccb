"""A laser scanner that turns in its own x-y plane."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import Carrier, RobotState, placed
from lcmtools_sim.sensors.settings import deviation, number
from lcmtools_sim.shapes import UNTURNED, Part
from lcmtools_sim.vision.scan import Scannable, Scanner, Standing, scannable
from lcmtools_sim.vision.solids import Floats, solids_of

_MOST_KNOWN = 10_000  # bodies
_IN_THE_WORLD = (0.0, 0.0, 0.0), UNTURNED


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
        frame = carrier.put_frame(mount, "laser", mount.pose.rotation)
        self._fill = _template(frame, settings, mount.rate).fill
        angles = np.linspace(settings.first_angle, settings.last_angle, settings.rays)
        self._scanner = Scanner(angles, settings.longest)
        self._known: dict[int, tuple[tuple[Part, ...], Scannable]] = {}

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The scan of one step."""
        del wanted
        return {"": self._fill(state.stamp, self._ranges(state).tolist())}

    def _ranges(self, state: RobotState) -> Floats:
        """Distances along all rays [m], with inf as the message has it."""
        settings = self._settings
        ranges = self._scanner.scan(*placed(state, self._mount.pose), self._standing())
        if settings.noise:
            ranges += self._generator.normal(0.0, settings.noise, len(ranges))
            ranges[ranges > settings.longest] = np.inf
        ranges[ranges < settings.shortest] = -np.inf
        return ranges

    def _standing(self) -> list[Standing]:
        """What is around, and where; shapes are prepared when they are seen first."""
        prepared, around = self._prepared, self._around
        return [
            (prepared(around.fixed_parts()), *_IN_THE_WORLD),
            *[(prepared(parts), place, turn) for parts, place, turn in around.moving_bodies()],
        ]

    def _prepared(self, parts: tuple[Part, ...]) -> Scannable:
        """These shapes, which are the same as long as they are the same object."""
        known = self._known.get(id(parts))
        if known is None or known[0] is not parts:
            if len(self._known) > _MOST_KNOWN:  # bodies that have gone
                self._known.clear()
            known = self._known[id(parts)] = parts, scannable(solids_of(parts))
        return known[1]


def _template(frame: str, settings: LaserSettings, rate: float) -> PayloadTemplate:
    """The message but for its time and the ranges."""
    message = LaserScan()
    message.header.frame_id = frame
    message.angle_min, message.angle_max = settings.first_angle, settings.last_angle
    message.angle_increment = (settings.last_angle - settings.first_angle) / (settings.rays - 1)
    message.scan_time = 1 / rate
    message.range_min, message.range_max = settings.shortest, settings.longest
    message.ranges = [0.0] * settings.rays
    return PayloadTemplate(message, "header.stamp", "ranges")
