"""The meshes of robots in the window; without a window none of this exists.

To the engine a robot is one body. Its meshes are bodies of their own without mass and collision,
which follow the robot: it moves to the bit as without a window. The engine comes in as an argument.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import ModuleType

from lcmtools_sim.engines.engine import Appearance, WheelAngles
from lcmtools_sim.geometry import Frame, Vector, add, from_euler, multiply
from lcmtools_sim.robots.model import Mesh

_PERIOD = 8  # steps; 30 updates a second are enough for the eye


@dataclass(slots=True)
class _Robot:
    meshes: Sequence[Mesh]
    to_footprint: Vector
    """From the centre of mass, which is the engine's origin [m]."""
    angles: WheelAngles
    bodies: list[int] = field(default_factory=list)


class MeshDisplay:
    """The meshes of all robots; ``make`` returns the number of a new body that looks like one."""

    def __init__(self, bullet: ModuleType, make: Callable[[Mesh], int]) -> None:
        self._bullet = bullet
        self._make = make
        self._robots: dict[int, _Robot] = {}
        self._steps = 0

    def add(self, robot: int, appearance: Appearance) -> None:
        """Show a robot's meshes from now on."""
        to_footprint = (0.0, 0.0, -appearance.height)
        self._robots[robot] = _Robot(appearance.meshes, to_footprint, appearance.angles)
        self.show(robot)

    def hide_all(self) -> None:
        """Remove all meshes until they are shown again.

        Needed before a body is removed: the engine gives its number to the last body, which must
        be the same one as without a window.
        """
        for robot in self._robots.values():
            for body in robot.bodies:
                self._bullet.removeBody(body)
            robot.bodies.clear()

    def forget(self, robot: int) -> None:
        """Drop a robot that is removed."""
        del self._robots[robot]

    def step(self) -> None:
        """Update all robots, if it is due."""
        self._steps += 1
        if self._steps % _PERIOD == 0:
            self.show_all()

    def show_all(self) -> None:
        """Update all robots."""
        for robot in self._robots:
            self.show(robot)

    def show(self, number: int) -> None:
        """Show a robot at its present pose."""
        robot = self._robots[number]
        if not robot.bodies:
            robot.bodies = [self._make(mesh) for mesh in robot.meshes]
        centre = Frame(*self._bullet.getBasePositionAndOrientation(number))
        left, right = robot.angles()
        for body, mesh in zip(robot.bodies, robot.meshes, strict=True):
            rotation = mesh.rotation
            if mesh.is_wheel:
                angle = left if mesh.position[1] > 0 else right
                rotation = multiply(from_euler(0.0, angle, 0.0), rotation)
            place = centre.place(Frame(add(robot.to_footprint, mesh.position), rotation))
            self._bullet.resetBasePositionAndOrientation(body, *place)
