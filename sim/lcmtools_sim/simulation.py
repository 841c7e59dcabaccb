"""The simulation: robots in a world, from command messages to sensor messages.

It knows no bus and no wall clock: bridge.py connects it to the bus, loop.py to the wall clock.
"""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager

from lcmtools.clock import CLOCK_TOPIC, NANOSECONDS, split_stamp
from lcmtools.errors import InvalidFile
from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools_sim.fleet import Fleet
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import MountedBatch, MountedSensor, Sample, Subscribers, mount_sensors
from lcmtools_sim.robot import Robot, Robots
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.schedule import Timetable
from lcmtools_sim.sensors.sensor import RobotState
from lcmtools_sim.vision.solids import Solids, solids_of
from lcmtools_sim.world import START_OVERLAP, MovableObject, World

CLOCK_RATE = 50.0  # [Hz] lowest rate of the clock; it also ticks with every step that publishes
_TICK = None  # due if only the clock is due
_CLOCK = PayloadTemplate(Clock(), "clock")
_Plan = list[tuple[Robot | Robots, MountedSensor | MountedBatch]]


class Simulation(AbstractContextManager["Simulation"]):
    """A running scene. A context manager: it owns the engine's world.

    A simulation that does not lead leaves the clock to another process.

    Raises:
        MissingExtra: There is no engine (see engines.chosen_engine).
        InvalidFile: A robot starts inside another body.
    """

    def __init__(self, scene: Scene, *, engine: str = "", leads: bool = True) -> None:
        self.scene, self.leads = scene, leads
        self.publishes_clock = leads  # True if its steps return the clock; else only ``tick`` does
        self._plans: dict[frozenset[float], _Plan] = {}
        """The sensors that are measured when these rates are due, until the fleet changes."""
        self._world = World(scene, engine=engine)
        try:
            self._begin()
        except InvalidFile:
            self._world.close()
            raise

    def __exit__(self, *_: object) -> None:
        """Close the engine's world."""
        self._world.close()

    @property
    def time(self) -> int:
        """Simulated nanoseconds since the start."""
        return round(self.steps * self.scene.dt * NANOSECONDS)

    @property
    def robots(self) -> Sequence[Robot]:
        """The robots in the order of the scene, then in order of addition."""
        return self._fleet.robots

    @property
    def objects(self) -> Sequence[MovableObject]:
        """The movable objects, in the order of the scene."""
        return self._objects

    def place(self, body: Robot | MovableObject, pose: Pose) -> None:
        """Put a robot or an object at a pose; UsageError, and no move, if inside another body."""
        self._fleet.hold_all()
        body.place(pose)

    def tick(self) -> Sample:
        """Return the current clock message."""
        return Sample(CLOCK_TOPIC, Clock, _CLOCK.fill(split_stamp(self.time)))

    def warnings(self) -> list[str]:
        """Return the engine's warnings since the last call, only the first of each kind."""
        return self._world.warnings()

    def solids(self) -> Solids:
        """Return all shapes and the ground, in the world."""
        parts = [*self._world.fixed_parts(), *self._world.moving_parts()]
        return solids_of(parts, self.scene.ground.color, self.scene.lines)

    def topics(self) -> dict[str, type[Message]]:
        """Return every topic of its samples, with the type."""
        found: dict[str, type[Message]] = {CLOCK_TOPIC: Clock} if self.leads else {}
        for robot in self.robots:
            for sensor in self._sensors[robot.namespace]:
                found.update(sensor.labels.values())
        return found

    def select(self, subscribers: Callable[[str], Subscribers]) -> None:
        """From now on, measure only topics that can have subscribers.

        Before the first call everything is measured, and so are the sensors of robots added later.
        """
        self.publishes_clock = self.leads and subscribers(CLOCK_TOPIC) is not Subscribers.NONE
        for sensors in self._sensors.values():
            for sensor in sensors:
                sensor.select(subscribers)
        self._plans = {}

    def step(self) -> list[Sample]:
        """Simulate one dt and return the samples that are due and selected, all with the same time.

        The clock comes first, so that no stamp is ahead of it.
        """
        self._fleet.step()
        self.steps += 1
        rates = self._timetable.due(self.steps)
        return self._measure(rates) if rates else []

    def reset(self, steps: int = 0) -> None:
        """Start again, bit for bit like a new process with this scene.

        The number of steps begins at ``steps``.
        """
        self._world.reset(self.scene)
        self._begin(steps)

    def add(self, placement: RobotPlacement) -> Robot:
        """Add a robot, until ``reset``; InvalidFile, and no robot, if inside another body."""
        self._fleet.hold_all()
        (robot,) = self._add([placement])
        return robot

    def remove(self, robot: Robot) -> None:
        """Remove a robot; ``reset`` restores it if it is the scene's."""
        self._timetable.remove(self._sensors.pop(robot.namespace))
        self._fleet.remove(robot)

    def _begin(self, steps: int = 0) -> None:
        self.steps = steps  # so far
        self._fleet = Fleet(self._world, self.scene)
        self._plans, self._planned_changes = {}, 0
        things = self._world.movable_objects()
        self._objects = [MovableObject(self._world, *thing) for thing in things]
        self._sensors: dict[str, list[MountedSensor]] = {}
        self._timetable: Timetable[MountedSensor | None] = Timetable(self.scene.dt)
        self._timetable.add(CLOCK_RATE, _TICK, after=steps)
        self._add(self.scene.robots)
        # warnings of movable objects that start inside another body, one line each
        self.misplaced = [
            f"{thing.where or self.scene.name}: {thing.name} starts {depth:.2f} m inside {other},"
            " and is thrown out of it"
            for thing, depth, other in self._world.overlaps()
            if depth > START_OVERLAP
        ]

    def _add(self, placements: Sequence[RobotPlacement]) -> list[Robot]:
        robots = [Robot(self._world, self.scene, placement) for placement in placements]
        self._world.detect_contacts()
        try:
            # Of two robots in one place the later one is the mistake.
            for robot, placement in reversed([*zip(robots, placements, strict=True)]):
                robot.check_start(placement.where)
        except InvalidFile:
            for robot in robots:
                robot.remove()
            raise
        for robot in robots:
            self._fleet.add(robot)
            sensors = self._sensors[robot.namespace] = mount_sensors(robot, self.scene)
            for sensor in sensors:
                self._timetable.add(sensor.rate, sensor, after=self.steps)
        return robots

    def _measure(self, rates: frozenset[float]) -> list[Sample]:
        """Return the samples of the selected sensors that are due at these rates."""
        if self._planned_changes != self._fleet.changes:
            self._plans, self._planned_changes = {}, self._fleet.changes
        if rates not in self._plans:
            self._plans[rates] = self._plan(rates)
        plan, time = self._plans[rates], self.time
        ticks = self.publishes_clock and (plan or CLOCK_RATE in rates)
        samples = [self.tick()] if ticks else []
        states: dict[Robot | Robots, RobotState] = {}
        for robots, sensor in plan:
            if robots not in states:
                states[robots] = robots.state(time)
            samples += sensor.measure(states[robots])
        return samples

    def _plan(self, rates: frozenset[float]) -> _Plan:
        """Return the selected sensors with these rates, each alone or with identical ones."""
        plan: _Plan = []
        alike: dict[tuple[Robots, int], list[tuple[MountedSensor, int]]] = {}
        for sensor in self._timetable.items(rates):
            if sensor is _TICK or sensor.is_idle:
                continue
            if batch := sensor.batch:
                robots, index = batch
                alike.setdefault((robots, id(sensor.mount)), []).append((sensor, index))
            else:
                plan.append((sensor.robot, sensor))
        plan += [(robots, MountedBatch(sensors)) for (robots, _), sensors in alike.items()]
        return plan
