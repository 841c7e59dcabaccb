"""The simulation without its surroundings: robots in a world, stepped from messages to messages.

It knows no bus and no wall clock: commands come in as messages, each step gives back the messages
that are due. bridge.py connects it to the bus, loop.py to the wall clock.
"""

from collections.abc import Callable, Iterable

from lcmtools.clock import NANOSECONDS, split_stamp
from lcmtools.errors import InvalidFile
from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools_sim.readings import Interest, Reading, Sample, mount_sensors
from lcmtools_sim.robot import Robot
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.schedule import Timetable
from lcmtools_sim.sensors.sensor import RobotState
from lcmtools_sim.shapes import Part
from lcmtools_sim.world import World

CLOCK_TOPIC = "/clock"
CLOCK_RATE = 50.0
"""[Hz] Least rate of the clock; besides, it ticks with every step that publishes something."""

_TICK = None  # what is due when only the clock is
_CLOCK = PayloadTemplate(Clock(), "clock")


class Simulation:
    """A scene come to life. A context manager: it owns the engine's world.

    Args:
        scene: What stands where.
        window: Whether to show it (see World).

    Attributes:
        scene: As given.
        robots: In the order of the scene, then as they were added.
        steps: How many have been done.

    Raises:
        MissingExtra: pybullet is not installed.
        InvalidFile: A robot starts inside something else.
    """

    def __init__(self, scene: Scene, *, window: bool = False) -> None:
        self.scene = scene
        self._is_clock_heard = True
        self._world = World(scene, window=window)
        try:
            self._begin()
        except InvalidFile:
            self._world.close()
            raise

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

    @property
    def is_clock_heard(self) -> bool:
        """Whether its steps give the clock; else who wants it now and then asks for ``tick``."""
        return self._is_clock_heard

    def tick(self) -> Sample:
        """The clock as it stands."""
        return Sample(CLOCK_TOPIC, Clock, _CLOCK.fill(split_stamp(self.time)))

    def is_open(self) -> bool:
        """Whether it can go on; not after its window was closed."""
        return self._world.is_open()

    def parts(self) -> list[Part]:
        """Every shape that there is, in the world now."""
        return [*self._world.fixed_parts(), *self._world.moving_parts()]

    def topics(self) -> dict[str, type[Message]]:
        """Every topic of its samples, with the type."""
        found: dict[str, type[Message]] = {CLOCK_TOPIC: Clock}
        for robot in self.robots:
            for reading in self._readings[robot.namespace]:
                found.update(reading.topics())
        return found

    def ask(self, interest: Callable[[str], Interest]) -> None:
        """Measure only what is wanted from now on: topics that somebody can be listening to.

        Until it is asked everything is measured, and so are the sensors of robots that come later.
        """
        is_leader = CLOCK_TOPIC in self.topics()
        self._is_clock_heard = is_leader and interest(CLOCK_TOPIC) is not Interest.NONE
        for readings in self._readings.values():
            for reading in readings:
                reading.ask(interest)

    def step(self) -> list[Sample]:
        """Let dt pass and return what is due then and heard, all with the same time.

        The clock comes first, so that nobody sees a stamp that is ahead of it.
        """
        for robot in self.robots:
            robot.drive()
        self._world.step()
        for robot in self.robots:
            robot.observe()
        self.steps += 1
        due = [item for item in self._timetable.due(self.steps) if self._is_wanted(item)]
        return self._samples(due) if due else []

    def reset(self, steps: int = 0) -> None:
        """Begin anew: the same start, to the bit, as that of a new process with this scene.

        Args:
            steps: As if so many had been done with everything standing still.
        """
        self._world.reset(self.scene)
        self._begin(steps)

    def add(self, placement: RobotPlacement) -> Robot:
        """Put up one more robot; ``reset`` takes it away again.

        Raises:
            InvalidFile: It would stand inside something else; nothing has been added.
        """
        robot = Robot(self._world, self.scene, placement)
        try:
            robot.check_start(placement.where)
        except InvalidFile:
            robot.remove()
            raise
        self.robots.append(robot)
        readings = mount_sensors(robot, self.scene)
        self._readings[robot.namespace] = readings
        for reading in readings:
            self._timetable.add(reading.rate, reading, after=self.steps)
        return robot

    def remove(self, robot: Robot) -> None:
        """Take a robot away; ``reset`` brings it back if it is the scene's."""
        gone = self._readings.pop(robot.namespace)
        self._timetable.remove(gone)
        self.robots.remove(robot)
        robot.remove()

    def _begin(self, steps: int = 0) -> None:
        self.steps = steps
        self.robots: list[Robot] = []
        self._readings: dict[str, list[Reading]] = {}
        self._timetable: Timetable[Reading | None] = Timetable(self.scene.dt)
        self._timetable.add(CLOCK_RATE, _TICK, after=steps)
        for placement in self.scene.robots:
            self.add(placement)

    def _is_wanted(self, item: Reading | None) -> bool:
        return self._is_clock_heard if item is _TICK else not item.is_idle

    def _samples(self, due: Iterable[Reading | None]) -> list[Sample]:
        samples = [self.tick()] if self._is_clock_heard else []
        time = self.time
        states: dict[str, RobotState] = {}
        for reading in due:
            if reading is _TICK:
                continue
            namespace = reading.robot.namespace
            if namespace not in states:
                states[namespace] = reading.robot.state(time)
            samples += reading.measure(states[namespace])
        return samples
