"""Sensors mounted on their robots: the topics of their outputs, and the choice of measured ones."""

from collections.abc import Callable, Sequence
from enum import Enum
from typing import NamedTuple, cast

from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message
from lcmtools_sim.robot import Robot, Robots
from lcmtools_sim.scene import Scene
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import BatchSensor, RobotState, Sensor, SensorContext, SensorMount


class Subscribers(Enum):
    """Knowledge about a topic's subscribers.

    Nodes announce their subscriptions; other programs do not, and may subscribe to any topic.
    """

    NONE = 0
    POSSIBLE = 1
    KNOWN = 2


class Sample(NamedTuple):
    """An encoded message, its type and its topic."""

    topic: str
    message_type: type[Message]
    payload: bytes

    @property
    def message(self) -> Message:
        """Return the decoded message."""
        return decode(self.message_type, self.payload)


class MountedSensor:
    """A sensor of a robot, and the topics of its messages."""

    def __init__(
        self, robot: Robot, mount: SensorMount, sensor: Sensor, bulky: frozenset[str] = frozenset()
    ) -> None:
        self.robot, self.mount, self.sensor = robot, mount, sensor
        self.rate = mount.rate  # [Hz]
        self._is_batchable = isinstance(sensor, BatchSensor) and sensor.is_batchable
        self._bulky = bulky
        # The topic and the type of each output.
        self.labels = {
            name: (_topic(robot.namespace, mount, name), kind)
            for name, kind in sensor.outputs.items()
        }
        self.active = tuple(self.labels)  # the outputs that are measured each time; initially all
        # Bulky outputs without a known subscriber: measured once a second.
        self.throttled: tuple[str, ...] = ()
        self._count = 0

    @property
    def is_idle(self) -> bool:
        """True if no output can have a subscriber."""
        return not (self.active or self.throttled)

    def select(self, subscribers: Callable[[str], Subscribers]) -> None:
        """From now on, measure only outputs that can have subscribers."""
        found = {name: subscribers(topic) for name, (topic, _) in self.labels.items()}
        if self.mount.always:
            found = dict.fromkeys(found, Subscribers.KNOWN)
        used = [name for name, state in found.items() if state is not Subscribers.NONE]
        self.throttled = tuple(
            name for name in used if found[name] is Subscribers.POSSIBLE and name in self._bulky
        )
        self.active = tuple(name for name in used if name not in self.throttled)

    def measure(self, state: RobotState) -> list[Sample]:
        """Return the messages of one step."""
        self._count += 1
        is_second = self.throttled and self._count % max(1, round(self.rate)) == 0
        wanted = self.active + self.throttled if is_second else self.active
        payloads = self.sensor.sample(state, wanted) if wanted else {}
        return [Sample(*self.labels[name], payload) for name, payload in payloads.items()]

    @property
    def batch(self) -> tuple[Robots, int] | None:
        """The robots with whose sensors this can be measured at once, and its index there."""
        return self.robot.batch if self._is_batchable else None


class MountedBatch:
    """Identically mounted sensors of robots whose state has arrays, measured at once.

    Each comes with its robot's index in the state.
    """

    def __init__(self, sensors: Sequence[tuple[MountedSensor, int]]) -> None:
        batch = [(cast("BatchSensor", one.sensor), index) for one, index in sensors]
        self._payloads = batch[0][0].batch(batch)
        self._labels = [one.labels[""] for one, _ in sensors]

    def measure(self, state: RobotState) -> list[Sample]:
        """Return the messages of one step, from the state of all the robots."""
        payloads = self._payloads(state)
        return [Sample(*label, one) for label, one in zip(self._labels, payloads, strict=True)]


def mount_sensors(robot: Robot, scene: Scene) -> list[MountedSensor]:
    """Return a robot's sensors in its model's order, but those that need frames last."""
    of_scene = scene.ground.color, scene.lines, scene.gravity, scene.seed
    context = SensorContext(robot.namespace, robot.body, robot.world, *of_scene)
    mounts = [(SENSORS[mount.kind], mount) for mount in robot.model.sensors]
    mounts.sort(key=lambda one: one[0].needs_frames)
    return [MountedSensor(robot, one, kind.make(one, context), kind.bulky) for kind, one in mounts]


def _topic(namespace: str, mount: SensorMount, output: str) -> str:
    name = f"{mount.topic}/{output}" if output else mount.topic
    return name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"
