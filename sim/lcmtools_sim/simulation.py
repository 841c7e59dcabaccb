"""The simulation without its surroundings: robots in a world, stepped from messages to messages.

It knows no bus and no wall clock: commands come in as messages, each step gives back the messages
that are due. bridge.py connects it to the bus, loop.py to the wall clock.
"""

from dataclasses import dataclass

from lcmtools.clock import NANOSECONDS, split_stamp
from lcmtools.errors import InvalidFile
from lcmtools.messages.registry import Message
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools_sim.robot import Robot
from lcmtools_sim.scene import Scene
from lcmtools_sim.schedule import Timetable
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import RobotState, Sensor
from lcmtools_sim.world import World

CLOCK_TOPIC = "/clock"
CLOCK_RATE = 50.0
"""[Hz] Least rate of the clock; besides, it ticks with every step that publishes something."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A message, and the topic that it belongs on."""

    topic: str
    message: Message


@dataclass(frozen=True, slots=True)
class _Reading:
    """A sensor of a robot, and the topic of its messages."""

    topic: str
    robot: Robot
    sensor: Sensor


class Simulation:
    """A scene come to life. A context manager: it owns the engine's world.

    Args:
        scene: What stands where.
        window: Whether to show it (see World).

    Attributes:
        scene: As given.
        robots: In the order of the scene.
        steps: How many have been done.

    Raises:
        MissingExtra: pybullet is not installed.
        InvalidFile: A robot starts inside something else.
    """

    def __init__(self, scene: Scene, *, window: bool = False) -> None:
        self.scene = scene
        self.steps = 0
        self._world = World(scene, window=window)
        self.robots = [Robot(self._world, scene, placement) for placement in scene.robots]
        self._check_starts()
        self._readings: list[_Reading] = []
        self._timetable: Timetable[_Reading | None] = Timetable(scene.dt)
        self._timetable.add(CLOCK_RATE, None)
        for robot in self.robots:
            self._mount_sensors(robot)

    def __enter__(self) -> "Simulation":
        """Use it in a with statement."""
        return self

    def __exit__(self, *_: object) -> None:
        """Give the engine back."""
        self._world.close()

    @property
    def time(self) -> int:
        """Simulated nanoseconds since the start."""
        return round(self.steps * self.scene.dt * NANOSECONDS)

    def is_open(self) -> bool:
        """Whether it can go on; not after its window was closed."""
        return self._world.is_open()

    def topics(self) -> dict[str, type[Message]]:
        """Every topic of its samples, with the type."""
        sensors = {reading.topic: reading.sensor.message_type for reading in self._readings}
        return {CLOCK_TOPIC: Clock, **sensors}

    def step(self) -> list[Sample]:
        """Let dt pass and return what is due then, all with the same time.

        The clock comes first, so that nobody sees a stamp that is ahead of it.
        """
        for robot in self.robots:
            robot.drive()
        self._world.step()
        for robot in self.robots:
            robot.observe()
        self.steps += 1
        due = self._timetable.due(self.steps)
        return self._samples(due) if due else []

    def _check_starts(self) -> None:
        try:
            for robot, placement in zip(self.robots, self.scene.robots, strict=True):
                robot.check_start(placement.where)
        except InvalidFile:
            self._world.close()
            raise

    def _mount_sensors(self, robot: Robot) -> None:
        for mount in robot.model.sensors:
            sensor = SENSORS[mount.kind](robot.namespace)
            topic = f"{robot.namespace.rstrip('/')}/{mount.topic}"
            reading = _Reading(topic, robot, sensor)
            self._readings.append(reading)
            self._timetable.add(mount.rate, reading)

    def _samples(self, due: list[_Reading | None]) -> list[Sample]:
        time = self.time
        samples = [Sample(CLOCK_TOPIC, _clock(time))]
        states: dict[str, RobotState] = {}
        for reading in due:
            if reading is None:  # the clock's own turn
                continue
            namespace = reading.robot.namespace
            if namespace not in states:
                states[namespace] = reading.robot.state(time)
            samples.append(Sample(reading.topic, reading.sensor.sample(states[namespace])))
        return samples


def _clock(time: int) -> Clock:
    message = Clock()
    message.clock.sec, message.clock.nsec = split_stamp(time)
    return message
