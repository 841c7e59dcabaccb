"""Sensors on their robots: which topic each output of each sensor belongs on."""

from collections.abc import Callable
from enum import Enum
from typing import NamedTuple

from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message
from lcmtools_sim.robot import Robot
from lcmtools_sim.robots.model import Body
from lcmtools_sim.scene import Scene
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, Sensor
from lcmtools_sim.shapes import Part


class Interest(Enum):
    """Whether somebody listens to a topic.

    Nodes announce what they listen to; other programs do not, and may hear anything.
    """

    NONE = 0
    POSSIBLE = 1
    SURE = 2


class Sample(NamedTuple):
    """A message as it goes out, its type, and the topic that it belongs on."""

    topic: str
    message_type: type[Message]
    payload: bytes

    @property
    def message(self) -> Message:
        """What the payload says."""
        return decode(self.message_type, self.payload)


class Reading:
    """A sensor of a robot, and the topics of its messages.

    Args:
        robot: That carries it.
        mount: How.
        sensor: What measures.
        bulky: Its outputs that are sent seldom where nobody is known to listen.

    Attributes:
        robot: As given.
        rate: [Hz]
        wanted: The outputs that are measured each time; at first all.
        seldom: Bulky outputs that nobody is known to listen to: measured once a second.
    """

    def __init__(
        self, robot: Robot, mount: SensorMount, sensor: Sensor, bulky: frozenset[str] = frozenset()
    ) -> None:
        self.robot = robot
        self.rate = mount.rate
        self._sensor = sensor
        self._bulky = bulky
        self._always = mount.always
        self._labels = {
            name: (_topic(robot.namespace, mount, name), kind)
            for name, kind in sensor.outputs.items()
        }
        """The topic and the type of each output."""
        self.wanted = tuple(self._labels)
        self.seldom: tuple[str, ...] = ()
        self._times = 0

    def topics(self) -> dict[str, type[Message]]:
        """Its topics and their types."""
        return dict(self._labels.values())

    @property
    def is_idle(self) -> bool:
        """Whether nobody can be listening to any output."""
        return not (self.wanted or self.seldom)

    def ask(self, interest: Callable[[str], Interest]) -> None:
        """Find out anew who listens to which outputs; from now on no other is measured."""
        found = {name: interest(topic) for name, (topic, _) in self._labels.items()}
        if self._always:
            found = dict.fromkeys(found, Interest.SURE)
        maybe = [name for name, how in found.items() if how is Interest.POSSIBLE]
        self.seldom = tuple(name for name in maybe if name in self._bulky)
        unheard = {name for name, how in found.items() if how is Interest.NONE}
        self.wanted = tuple(name for name in found if name not in unheard.union(self.seldom))

    def measure(self, state: RobotState) -> list[Sample]:
        """The messages of one step."""
        self._times += 1
        is_their_turn = self.seldom and self._times % max(1, round(self.rate)) == 0
        wanted = self.wanted + self.seldom if is_their_turn else self.wanted
        payloads = self._sensor.sample(state, wanted) if wanted else {}
        return [Sample(*self._labels[name], payload) for name, payload in payloads.items()]


def mount_sensors(robot: Robot, scene: Scene) -> list[Reading]:
    """Everything that a robot measures with, in the order of its model."""
    body = robot.model.body
    carrier = Carrier(robot.namespace, _in_base_link(body), scene.gravity, scene.seed, robot)
    mounts = [(SENSORS[mount.kind], mount) for mount in robot.model.sensors]
    return [Reading(robot, mount, kind.make(mount, carrier), kind.bulky) for kind, mount in mounts]


def _topic(namespace: str, mount: SensorMount, output: str) -> str:
    name = f"{mount.topic}/{output}" if output else mount.topic
    return name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"


def _in_base_link(body: Body) -> tuple[Part, ...]:
    """A body's shapes in base_link, which hangs above base_footprint."""
    return tuple(
        Part(
            part.shape,
            (part.position[0], part.position[1], part.position[2] - body.base_height),
            part.rotation,
            part.color,
        )
        for part in body.parts
    )
