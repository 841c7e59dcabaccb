"""What stands in a world before it starts, as frozen values.

Only values live here: world_file.py reads them from YAML, world.py builds them in the engine.
"""

from dataclasses import dataclass, field

from lcmtools_sim.pose import ORIGIN, Pose
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.rotation import Vector
from lcmtools_sim.shapes import Color, Cuboid, Part

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
        parts: Its shapes, in its own frame.
        pose: Of that frame in the world.
        mass: [kg]; 0 stands for ever.
        friction: Coulomb coefficient.
    """

    name: str
    parts: tuple[Part, ...]
    pose: Pose = ORIGIN
    mass: float = 0.0
    friction: float = FRICTION


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
    """

    name: str
    node: str = "sim"
    seed: int = 0
    dt: float = 1 / 240
    gravity: float = 9.81
    ground: Ground = Ground()
    things: tuple[Thing, ...] = ()
    robots: tuple[RobotPlacement, ...] = ()


def contents(scene: Scene) -> str:
    """What stands in a scene, in one line."""
    robots = ", ".join(f"{robot.model.name} {robot.namespace}" for robot in scene.robots)
    return f"{robots or 'no robot'}; {len(scene.things)} things"
