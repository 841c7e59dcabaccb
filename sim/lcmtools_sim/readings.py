"""Sensors on their robots: which topic each output of each sensor belongs on."""

from collections.abc import Callable

from lcmtools.messages.registry import Message
from lcmtools_sim.robot import Robot
from lcmtools_sim.robots.model import Body
from lcmtools_sim.scene import Scene
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, Sensor
from lcmtools_sim.shapes import Part


class Reading:
    """A sensor of a robot, and the topics of its messages.

    Args:
        robot: That carries it.
        mount: How.
        sensor: What measures.

    Attributes:
        robot: As given.
        rate: [Hz]
        wanted: The outputs that somebody can be listening to; at first all.
    """

    def __init__(self, robot: Robot, mount: SensorMount, sensor: Sensor) -> None:
        self.robot = robot
        self.rate = mount.rate
        self._sensor = sensor
        self._always = mount.always
        self._topics = {name: _topic(robot.namespace, mount, name) for name in sensor.outputs}
        self.wanted = tuple(self._topics)

    def topics(self) -> dict[str, type[Message]]:
        """Its topics and their types."""
        outputs = self._sensor.outputs
        return {topic: outputs[name] for name, topic in self._topics.items()}

    def ask(self, is_wanted: Callable[[str], bool]) -> None:
        """Find out anew which outputs are wanted; from now on no other is measured."""
        topics = self._topics.items()
        self.wanted = tuple(name for name, topic in topics if self._always or is_wanted(topic))

    def measure(self, state: RobotState) -> dict[str, Message]:
        """The messages of one step by their topics."""
        messages = self._sensor.sample(state, self.wanted)
        return {self._topics[name]: message for name, message in messages.items()}


def mount_sensors(robot: Robot, scene: Scene) -> list[Reading]:
    """Everything that a robot measures with, in the order of its model."""
    body = robot.model.body
    carrier = Carrier(robot.namespace, _in_base_link(body), scene.gravity, scene.seed, robot)
    return [
        Reading(robot, mount, SENSORS[mount.kind].make(mount, carrier))
        for mount in robot.model.sensors
    ]


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
