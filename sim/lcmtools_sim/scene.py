"""The content of a world before it starts, as frozen values.

Only values: world_file reads them from YAML, world.py builds them in the engine.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Annotated

from lcmtools.errors import UsageError
from lcmtools.formats.typed import Within
from lcmtools.names import did_you_mean
from lcmtools.text_table import plural
from lcmtools_sim.geometry import ORIGIN, Pose, Vector
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.shapes import Color, Cuboid, Line, Part

_SPACING = 3.0  # [m] between the robots of a fleet
FRICTION = 0.6  # the default of objects
WOOD: Color = (0.7, 0.6, 0.45)


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane z = 0."""

    friction: Annotated[float, Within(0, 10)] = 1.0  # Coulomb; multiplied by a box's or a tyre's
    color: Annotated[Color, Within(0, 1)] = (0.55, 0.57, 0.55)  # red, green, blue, 0 to 1


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An immovable or movable object in the world: one rigid body."""

    name: str  # for messages
    parts: tuple[Part, ...]  # its shapes, in its own frame; the origin is its centre of mass
    pose: Pose = ORIGIN  # of that frame in the world
    mass: float = 0.0  # [kg]; 0 for an immovable object
    friction: float = FRICTION  # Coulomb coefficient
    where: str = field(default="", compare=False)  # file and line, for messages ("yard.yaml:12")


def box(
    name: str, size: Vector, pose: Pose, mass: float = 0.0, friction: float = FRICTION
) -> SceneObject:
    """Return a box; ``pose`` is its centre's."""
    return SceneObject(name, (Part(Cuboid(size), color=WOOD),), pose, mass, friction)


@dataclass(frozen=True, slots=True)
class RobotPlacement:
    """A robot of some model, and its start."""

    model: RobotModel  # with all changes by the world file
    namespace: str  # full namespace: "/husky0"
    pose: Pose = ORIGIN  # of the point on the ground between its wheels
    cmd_timeout: float | None = None  # simulated seconds after which a command ends; None for never
    where: str = field(default="", compare=False)  # file and line, for messages ("yard.yaml:12")


@dataclass(frozen=True, slots=True)
class MarkedPath:
    """A path marked on the ground, and its full topic (nav_msgs/Path)."""

    topic: str
    line: Line


@dataclass(frozen=True, slots=True)
class Scene:
    """The content of a world file."""

    name: str  # the file's name without its ending
    node: str = "sim"  # the simulator's name on the bus
    seed: int = 0  # seed of all random numbers
    dt: float = 1 / 240  # simulated seconds of one step
    gravity: float = 9.81  # [m/s^2] downwards
    ground: Ground = Ground()  # the plane z = 0
    objects: tuple[SceneObject, ...] = ()  # boxes, pieces of walls, tables and so on
    robots: tuple[RobotPlacement, ...] = ()  # in the order of the file
    paths: tuple[MarkedPath, ...] = ()  # in the order of the file
    notes: tuple[str, ...] = field(default=(), compare=False)  # on ignored content, one line each

    @property
    def lines(self) -> tuple[Line, ...]:
        """The lines on the ground."""
        return tuple(path.line for path in self.paths)


def fleet(scene: Scene, size: int) -> Scene:
    """Return the scene with this number of robots like its first one, in rows.

    Their namespaces are the first one's with other numbers at the end. UsageError without a robot.
    """
    if not scene.robots:
        raise UsageError(f"the world {scene.name} has no robot to copy")
    first, pose = scene.robots[0], scene.robots[0].pose
    stem = first.namespace.rstrip("0123456789").rstrip("/") or f"/{first.model.name}"
    side = max(1, math.isqrt(size - 1) + 1)
    robots = tuple(
        replace(first, namespace=f"{stem}{number}", pose=replace(pose, x=x, y=y))
        for number in range(size)
        for x, y in [(pose.x + number // side * _SPACING, pose.y + number % side * _SPACING)]
    )
    return replace(scene, robots=robots)


def with_robot(scene: Scene, model: RobotModel, pose: Pose) -> Scene:
    """The scene with one more robot, named by its model and the next free number (/husky0)."""
    taken = {robot.namespace for robot in scene.robots}
    number = next(n for n in count() if f"/{model.name}{n}" not in taken)
    robot = RobotPlacement(model, f"/{model.name}{number}", pose, where="--robot")
    return replace(scene, robots=(*scene.robots, robot))


def selected(scene: Scene, names: Sequence[str]) -> Scene:
    """Return the scene with only these robots, with a slash or not; UsageError for unknown ones."""
    robots = {robot.namespace: robot for robot in scene.robots}
    wanted = [f"/{name.strip('/')}" for name in names]
    for name in wanted:
        if name not in robots:
            hint = did_you_mean(name, robots) or f"robots: {', '.join(robots) or 'none'}"
            raise UsageError(f"the world {scene.name} has no robot '{name}'", hint)
    return replace(scene, robots=tuple(robots[name] for name in robots if name in wanted))


def contents(scene: Scene) -> str:
    """Return the robots and the number of objects of a scene, as one line."""
    named = (f"{robot.model.name} {robot.namespace}" for robot in scene.robots)
    robots = ", ".join(name.removesuffix(" /") for name in named)
    return f"{robots or 'no robot'}; {plural(len(scene.objects), 'object')}"
