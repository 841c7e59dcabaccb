"""What is seen of robots in the window. Without a window there is nothing of this.

To the engine a robot is one body; its meshes are bodies of their own here that weigh and touch
nothing, and are put to where the robot has come: it moves to the bit as without a window. The
engine comes in as an argument.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import ModuleType

from lcmtools_sim.robots.model import Mesh
from lcmtools_sim.rotation import Vector, add, from_euler, multiply, turn

Angles = Callable[[], tuple[float, float]]
"""How far the left and the right wheels have turned [rad]."""


def unturned() -> tuple[float, float]:
    """The angles of wheels that stand still for ever."""
    return 0.0, 0.0


_EVERY = 8
"""Steps between two looks: 30 a second is enough for the eye."""


@dataclass(slots=True)
class _Robot:
    """A robot's meshes, and the bodies that show them."""

    meshes: Sequence[Mesh]
    to_footprint: Vector
    """From the centre of mass, which is where the engine has it [m]."""
    angles: Angles
    bodies: list[int] = field(default_factory=list)


class MeshesInView:
    """The meshes of all robots.

    Args:
        bullet: The engine.
        client: Its connection.
        make: Puts up a body that looks like a mesh, and returns its number.
    """

    def __init__(self, bullet: ModuleType, client: int, make: Callable[[Mesh], int]) -> None:
        self._bullet = bullet
        self._client = client
        self._make = make
        self._robots: dict[int, _Robot] = {}
        self._steps = 0

    def add(
        self, robot: int, meshes: Sequence[Mesh], centre_of_mass: float, angles: Angles
    ) -> None:
        """Carry a robot's meshes along from now on.

        Args:
            robot: Its body.
            meshes: What is seen of it.
            centre_of_mass: Its height above the robot's base_footprint [m].
            angles: As above.
        """
        self._robots[robot] = _Robot(meshes, (0.0, 0.0, -centre_of_mass), angles)
        self.show(robot)

    def take_away(self) -> None:
        """Take all away until they are shown again.

        Who removes a body does so first: the engine puts its last body into the gap, and it must
        be the same one as without a window.
        """
        for robot in self._robots.values():
            for body in robot.bodies:
                self._bullet.removeBody(body, physicsClientId=self._client)
            robot.bodies.clear()

    def forget(self, robot: int) -> None:
        """Show a robot no more that is taken away."""
        del self._robots[robot]

    def step(self) -> None:
        """Show them all as they are now, where that is due."""
        self._steps += 1
        if self._steps % _EVERY == 0:
            self.show_all()

    def show_all(self) -> None:
        """Show them all as they are now."""
        for robot in self._robots:
            self.show(robot)

    def show(self, number: int) -> None:
        """Show a robot where it is now."""
        robot = self._robots[number]
        if not robot.bodies:
            robot.bodies = [self._make(mesh) for mesh in robot.meshes]
        position, rotation = self._bullet.getBasePositionAndOrientation(number, self._client)
        left, right = robot.angles()
        for body, mesh in zip(robot.bodies, robot.meshes, strict=True):
            place, turned = add(robot.to_footprint, mesh.position), mesh.rotation
            if mesh.is_wheel:
                angle = left if mesh.position[1] > 0 else right
                turned = multiply(from_euler(0.0, angle, 0.0), turned)
            self._bullet.resetBasePositionAndOrientation(
                body, add(position, turn(place, rotation)), multiply(rotation, turned), self._client
            )
