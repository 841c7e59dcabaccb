"""Wheels that are seen to turn in the window. Without a window there is nothing of this.

To the engine a robot is one body; its wheels are bodies of their own here that weigh and touch
nothing, and are put to where the robot has come. The engine comes in as an argument.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import ModuleType

from lcmtools_sim.robots.model import Mesh
from lcmtools_sim.rotation import Vector, add, chain, from_euler, turn

Angles = Callable[[], tuple[float, float]]
"""How far the left and the right wheels have turned [rad]."""


def unturned() -> tuple[float, float]:
    """The angles of wheels that stand still for ever."""
    return 0.0, 0.0


_EVERY = 8
"""Steps between two looks: 30 a second is enough for the eye."""


@dataclass(frozen=True, slots=True)
class _Wheel:
    """A body, and where its middle is from the robot's centre of mass [m]."""

    body: int
    place: Vector
    is_left: bool


class WheelsInView:
    """The wheels of all robots.

    Args:
        bullet: The engine.
        client: Its connection.
    """

    def __init__(self, bullet: ModuleType, client: int) -> None:
        self._bullet = bullet
        self._client = client
        self._robots: dict[int, tuple[list[_Wheel], Angles]] = {}
        self._steps = 0

    def add(
        self, robot: int, wheels: Sequence[tuple[int, Mesh]], centre_of_mass: float, angles: Angles
    ) -> None:
        """Turn a robot's wheels from now on.

        Args:
            robot: Its body.
            wheels: Their bodies, and what they are.
            centre_of_mass: Its height above the robot's base_footprint [m].
            angles: As above.
        """
        found = [
            _Wheel(body, add(mesh.position, (0.0, 0.0, -centre_of_mass)), mesh.position[1] > 0)
            for body, mesh in wheels
        ]
        self._robots[robot] = found, angles
        self.show(robot)

    def remove(self, robot: int) -> None:
        """Take a robot's wheels away."""
        for wheel in self._robots.pop(robot)[0]:
            self._bullet.removeBody(wheel.body, physicsClientId=self._client)

    def step(self) -> None:
        """Show them all as they are now, where that is due."""
        self._steps += 1
        if self._steps % _EVERY == 0:
            for robot in self._robots:
                self.show(robot)

    def show(self, robot: int) -> None:
        """Show a robot's wheels where it is now."""
        wheels, angles = self._robots[robot]
        position, rotation = self._bullet.getBasePositionAndOrientation(robot, self._client)
        left, right = angles()
        for wheel in wheels:
            turned = from_euler(0.0, left if wheel.is_left else right, 0.0)
            self._bullet.resetBasePositionAndOrientation(
                wheel.body,
                add(position, turn(wheel.place, rotation)),
                chain(rotation, turned),
                self._client,
            )
