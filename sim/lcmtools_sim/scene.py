"""What stands in a world before it starts, as frozen values.

Only values live here: world_file.py reads them from YAML, world.py builds them in the engine.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import count

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools_sim.pose import ORIGIN, Pose
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.rotation import Vector
from lcmtools_sim.shapes import Color, Cuboid, Part

_SPACING = 3.0  # [m] between the robots of a fleet
FRICTION = 0.6
"""Of things, where nothing else is said."""
WOOD: Color = (0.7, 0.6, 0.45)


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane z = 0.

    Attributes:
        friction: Coulomb coefficient; the products with a box's and with a tyre's are what counts.
        color: Red, green, blue, 0 to 1.
    """

    friction: float = 1.0
    color: Color = (0.55, 0.57, 0.55)


@dataclass(frozen=True, slots=True)
class Thing:
    """Something that stands in the world or can be pushed: one rigid body.

    Attributes:
        name: For messages.
        parts: Its shapes, in its own frame; the origin is its centre of mass.
        pose: Of that frame in the world.
        mass: [kg]; 0 stands for ever.
        friction: Coulomb coefficient.
        where: File and line that it comes from ("yard.yaml:12"), for messages.
    """

    name: str
    parts: tuple[Part, ...]
    pose: Pose = ORIGIN
    mass: float = 0.0
    friction: float = FRICTION
    where: str = field(default="", compare=False)


def box(
    name: str, size: Vector, pose: Pose, mass: float = 0.0, friction: float = FRICTION
) -> Thing:
    """A box; ``pose`` is that of its centre."""
    return Thing(name, (Part(Cuboid(size), color=WOOD),), pose, mass, friction)


@dataclass(frozen=True, slots=True)
class RobotPlacement:
    """A robot of a model, and where it starts.

    Attributes:
        model: What it is, with all that the world file changes of it.
        namespace: Global, "/husky0".
        pose: Of the point on the ground between its wheels.
        cmd_timeout: Simulated seconds after which a command ends; None holds it for ever.
        where: File and line that it comes from ("yard.yaml:12"), for messages.
    """

    model: RobotModel
    namespace: str
    pose: Pose = ORIGIN
    cmd_timeout: float | None = None
    where: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Scene:
    """All that a world file says.

    Attributes:
        name: The file's name without its ending.
        node: The simulator's name on the bus.
        seed: Of everything random.
        dt: Simulated seconds of one step.
        gravity: [m/s^2] downwards.
        ground: What everything stands on.
        things: Boxes, pieces of walls, tables and so on.
        robots: Who drives.
        notes: What its files hold and the simulator does not, one line each.
    """

    name: str
    node: str = "sim"
    seed: int = 0
    dt: float = 1 / 240
    gravity: float = 9.81
    ground: Ground = Ground()
    things: tuple[Thing, ...] = ()
    robots: tuple[RobotPlacement, ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False)


def fleet(scene: Scene, size: int) -> Scene:
    """The scene with so many robots like its first one, in rows.

    Their namespaces are the first one's with other numbers at the end.

    Raises:
        UsageError: The scene has no robot.
    """
    if not scene.robots:
        raise UsageError(f"the world {scene.name} has no robot to make {size} of")
    first = scene.robots[0]
    stem = first.namespace.rstrip("0123456789").rstrip("/") or f"/{first.model.name}"
    side = max(1, math.isqrt(size - 1) + 1)
    robots = tuple(
        replace(first, namespace=f"{stem}{number}", pose=_beside(first.pose, number, side))
        for number in range(size)
    )
    return replace(scene, robots=robots)


def joined(scene: Scene, model: RobotModel, pose: Pose) -> Scene:
    """The scene with one more robot, called by its model and the next free number (/husky0)."""
    taken = {robot.namespace for robot in scene.robots}
    number = next(n for n in count() if f"/{model.name}{n}" not in taken)
    robot = RobotPlacement(model, f"/{model.name}{number}", pose, where="--robot")
    return replace(scene, robots=(*scene.robots, robot))


def selected(scene: Scene, names: Sequence[str]) -> Scene:
    """The scene with only these of its robots, named with or without a slash before.

    Raises:
        UsageError: One is not there.
    """
    robots = {robot.namespace: robot for robot in scene.robots}
    wanted = [f"/{name.strip('/')}" for name in names]
    for name in wanted:
        if name not in robots:
            hint = did_you_mean(name, robots) or f"robots: {', '.join(robots) or 'none'}"
            raise UsageError(f"the world {scene.name} has no robot '{name}'", hint)
    return replace(scene, robots=tuple(robots[name] for name in robots if name in wanted))


def _beside(pose: Pose, number: int, side: int) -> Pose:
    row, column = divmod(number, side)
    return replace(pose, x=pose.x + row * _SPACING, y=pose.y + column * _SPACING)


def contents(scene: Scene) -> str:
    """What stands in a scene, in one line."""
    robots = ", ".join(f"{robot.model.name} {robot.namespace}" for robot in scene.robots)
    return f"{robots or 'no robot'}; {len(scene.things)} things"
