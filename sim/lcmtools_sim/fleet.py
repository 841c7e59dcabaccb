"""All robots of a running simulation, and the decision which of them the engine moves.

Every robot has a row in a `Vehicles` (vehicles.py), alone or with others. It always moves the
robot's motors, wheels and encoders, and also its body while the robot is free: on level ground,
with nothing that it or others could reach until the next update. Otherwise, the engine moves the
body, and its tyres pull it before each of the engine's steps: with floats (`Robot.pull`) or, if
many robots of one `Vehicles` are in the engine, with arrays (`RobotsInEngine`).
`_choose_in_engine` decides again ten times a second, and `Robot.hand_to` takes the body's motion
along to its next owner, before it can touch anything.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lcmtools_sim.in_engine import RobotsInEngine
from lcmtools_sim.robot import Robot
from lcmtools_sim.scene import Scene
from lcmtools_sim.vehicles import Vehicles
from lcmtools_sim.vision.solids import Floats, solids_of
from lcmtools_sim.world import World

_MANY = 8  # from this number of robots on, arrays are faster than floats
_PERIOD = 0.1  # [s] between two updates
_FASTER = 1.0  # [m/s] by which a body may accelerate until then
_MARGIN = 0.02  # [m]


class Fleet:
    """The robots of a world, in order of addition."""

    def __init__(self, world: World, scene: Scene) -> None:
        self.changes = 0  # how often the groups that step together have changed
        self.robots: list[Robot] = []
        self._world = world
        self._dt, self._fall = scene.dt, scene.gravity * scene.dt
        self._period = max(1, round(_PERIOD / scene.dt))
        self._steps = 0  # steps since the last change of the robots
        self._groups: list[tuple[Vehicles, list[Robot]]] = []
        self._in_engine: list[Robot] = []  # robots that the engine moves, one by one
        self._many: list[RobotsInEngine] = []  # the others that it moves, in groups
        self._free: list[bool] | None = None
        """For each robot of the groups, True if it needs no engine; None initially."""
        self._sizes = [solids_of(thing.parts).reach for thing, _ in world.movable_objects()]

    def add(self, robot: Robot) -> None:
        """Add a robot."""
        self.robots.append(robot)
        self._in_engine.append(robot)
        self._steps = 0

    def remove(self, robot: Robot) -> None:
        """Remove a robot."""
        self.robots.remove(robot)
        robot.remove()
        self._steps = 0

    def hold_all(self) -> None:
        """Make the engine know where all bodies are, to find overlaps."""
        for robot in self.robots:
            robot.hand_to(self._world)
        self._steps = 0

    def step(self) -> None:
        """Simulate one dt."""
        if not self._steps:
            self._join()
        if self._steps % self._period == 0:
            self._choose_in_engine()
        self._steps += 1
        for vehicles, _ in self._groups:
            vehicles.step()
        in_engine: list[Robot | RobotsInEngine] = [*self._many, *self._in_engine]
        for robots in in_engine:
            robots.pull()
        self._world.step()
        for robots in in_engine:
            robots.observe()

    def _join(self) -> None:
        """Let robots with the same kind of tyres step together, if they are many."""
        kinds: dict[object, list[Robot]] = {}
        for robot in self.robots:
            drive = robot.model.drive
            alone = robot if robot.vehicles.noise else None
            kinds.setdefault((alone, drive.skids and drive.wheels), []).append(robot)
        self._groups, self._free = [], None
        for robots in kinds.values():
            parts = [robots] if len(robots) >= _MANY else [[robot] for robot in robots]
            self._groups += [(_joined(part), part) for part in parts]

    def _choose_in_engine(self) -> None:
        """Determine which robots the engine must move until the next update."""
        self._world.find_rest()
        robots = [robot for _, group in self._groups for robot in group]
        near = self._near(robots) if robots else []
        free = [
            not is_near and (robot.is_free or robot.stands)
            for robot, is_near in zip(robots, near, strict=True)
        ]
        if free == self._free:
            return
        self._free = free
        self.changes += 1
        for robot, is_free in zip(robots, free, strict=True):
            robot.hand_to(robot.vehicles if is_free else self._world)
        self._in_engine, self._many = [], []
        for vehicles, group in self._groups:
            in_engine = [robot for robot in group if not robot.is_free]
            if len(in_engine) < _MANY:
                self._in_engine += in_engine
            else:
                self._group_in_engine(vehicles, in_engine)

    def _group_in_engine(self, vehicles: Vehicles, robots: Sequence[Robot]) -> None:
        rows = [(robot.index, robot.body, robot.motions) for robot in robots]
        group = RobotsInEngine(self._world, vehicles, rows, self._fall)
        self._many.append(group)
        for index, robot in enumerate(robots):
            robot.hand_to(group, index)

    def _near(self, robots: Sequence[Robot]) -> list[bool]:
        """Return True for each robot that may touch something until the next update."""
        values = [vehicles.now for vehicles, _ in self._groups]
        x, y, vx, vy = (
            np.concatenate([np.atleast_1d(getattr(now, name)) for now in values])
            for name in ("x", "y", "vx", "vy")
        )
        places = np.stack((x, y, [robot.model.body.centre_of_mass for robot in robots]), axis=-1)
        velocities = np.stack((vx, vy, np.zeros_like(vx)), axis=-1)
        for i, robot in enumerate(robots):
            if not robot.is_free:
                places[i], _, velocities[i], _ = robot.motion
        return self._meet(places, self._reach([robot.reach for robot in robots], velocities))

    def _meet(self, places: Floats, reaches: Floats) -> list[bool]:
        """Return True for each robot, at this place and with this reach, that may meet a body."""
        fixed, objects = self._world.fixed_solids(), self._world.movable_objects()
        offsets = places[:, None] - fixed.centres
        outside = np.abs(np.einsum("nmi,mij->nmj", offsets, fixed.axes)) - fixed.half_sizes
        squares = np.square(np.maximum(outside, 0.0)).sum(axis=-1)
        near = (squares < np.square(reaches)[:, None]).any(axis=1)
        others, other_reaches = places, reaches
        if objects:
            motions = [self._world.motion(body) for _, body in objects]
            others = np.concatenate((places, [motion.position for motion in motions]))
            moving = self._reach(self._sizes, [motion.velocity for motion in motions])
            other_reaches = np.concatenate((reaches, moving))
        squares = np.square(places[:, :1] - others[:, 0]) + np.square(places[:, 1:2] - others[:, 1])
        met = squares < np.square(reaches[:, None] + other_reaches)
        found: list[bool] = (near | (met.sum(axis=1) > 1)).tolist()  # each one meets itself
        return found

    def _reach(self, sizes: Sequence[float], velocities: npt.ArrayLike) -> Floats:
        """Return the farthest that bodies of these sizes can get until the next update [m]."""
        speeds = np.linalg.norm(velocities, axis=-1)
        reach: Floats = np.array(sizes) + (speeds + _FASTER) * self._period * self._dt + _MARGIN
        return reach


def _joined(robots: Sequence[Robot]) -> Vehicles:
    """Return the robots' values joined; a single robot keeps its own."""
    if len(robots) == 1 and robots[0].vehicles.is_single:
        return robots[0].vehicles
    vehicles = Vehicles.joined([(robot.vehicles, robot.index) for robot in robots])
    for index, robot in enumerate(robots):
        robot.vehicles, robot.index = vehicles, index
    return vehicles
