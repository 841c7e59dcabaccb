"""What stands in a world before it starts, as frozen values.

Only values live here: world_file.py reads them from YAML, world.py builds them in the engine.
"""

from dataclasses import dataclass, field

Color = tuple[float, float, float]

BOX_FRICTION = 0.6
BOX_COLOR: Color = (0.7, 0.6, 0.45)
WALL_COLOR: Color = (0.6, 0.6, 0.62)


@dataclass(frozen=True, slots=True)
class Pose:
    """A place in the world: metres, and fixed-axis roll, pitch, yaw in radians (REP-103)."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


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
class Box:
    """A cuboid, or one straight piece of a wall.

    Attributes:
        name: For messages.
        size: Length, width, height [m].
        pose: Of its centre.
        mass: [kg]; 0 stands for ever.
        friction: Coulomb coefficient.
        color: Red, green, blue, 0 to 1.
    """

    name: str
    size: tuple[float, float, float]
    pose: Pose
    mass: float = 0.0
    friction: float = BOX_FRICTION
    color: Color = BOX_COLOR


@dataclass(frozen=True, slots=True)
class RobotPlacement:
    """A robot of a model, and where it starts.

    Attributes:
        model: A key of robots.MODELS.
        namespace: Global, "/husky0".
        pose: Of the point on the ground between its wheels.
        cmd_timeout: Simulated seconds after which a command ends; None holds it for ever.
        where: File and line that it comes from ("yard.yaml:12"), for messages.
    """

    model: str
    namespace: str
    pose: Pose = Pose()
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
        boxes: Boxes and the pieces of walls.
        robots: Who drives.
    """

    name: str
    node: str = "sim"
    seed: int = 0
    dt: float = 1 / 240
    gravity: float = 9.81
    ground: Ground = Ground()
    boxes: tuple[Box, ...] = ()
    robots: tuple[RobotPlacement, ...] = ()


def contents(scene: Scene) -> str:
    """What stands in a scene, in one line."""
    robots = ", ".join(f"{robot.model} {robot.namespace}" for robot in scene.robots)
    return f"{robots or 'no robot'}; {len(scene.boxes)} boxes and walls"
