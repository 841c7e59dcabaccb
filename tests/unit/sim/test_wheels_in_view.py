"""The window's wheels go with their robot and turn as its motors do. Metres, radians."""

import math
from types import ModuleType, SimpleNamespace
from typing import cast

import pytest

from lcmtools_sim.robots.model import Mesh
from lcmtools_sim.rotation import Quaternion, Vector, from_euler, turn
from lcmtools_sim.wheels_in_view import WheelsInView

ROBOT, LEFT, RIGHT = 1, 2, 3
CENTRE = 0.2
WHEELS = [
    (LEFT, Mesh("wheel.stl", (0.3, 0.25, 0.15), is_wheel=True)),
    (RIGHT, Mesh("wheel.stl", (0.3, -0.25, 0.15), is_wheel=True)),
]


class Engine:
    """Bodies and where they are."""

    def __init__(self) -> None:
        self.poses: dict[int, tuple[Vector, Quaternion]] = {}

    def getBasePositionAndOrientation(self, body: int, _: int) -> tuple[Vector, Quaternion]:  # noqa: N802
        """As pybullet's."""
        return self.poses[body]

    def resetBasePositionAndOrientation(  # noqa: N802
        self, body: int, position: Vector, rotation: Quaternion, _: int
    ) -> None:
        """As pybullet's."""
        self.poses[body] = position, rotation

    def removeBody(self, body: int, *, physicsClientId: int) -> None:  # noqa: N802, N803
        """As pybullet's."""
        del physicsClientId, self.poses[body]


@pytest.fixture
def engine() -> Engine:
    found = Engine()
    found.poses[ROBOT] = (5.0, 1.0, CENTRE), from_euler(0, 0, math.pi / 2)
    return found


def test_they_stand_where_the_robot_has_them_and_each_side_turns_by_its_own_angle(
    engine: Engine,
) -> None:
    angles = SimpleNamespace(now=(0.0, 0.0))
    wheels = WheelsInView(cast("ModuleType", engine), 0)
    wheels.add(ROBOT, WHEELS, CENTRE, lambda: angles.now)
    assert engine.poses[LEFT][0] == pytest.approx((4.75, 1.3, 0.15))
    assert engine.poses[RIGHT][0] == pytest.approx((5.25, 1.3, 0.15))

    angles.now = math.pi / 2, 0.0
    engine.poses[ROBOT] = (5.0, 2.0, CENTRE), from_euler(0, 0, math.pi / 2)
    for _ in range(24):
        wheels.step()

    place, turned = engine.poses[LEFT]
    assert place == pytest.approx((4.75, 2.3, 0.15))
    assert turn((0.0, 0.0, 1.0), turned) == pytest.approx((0, 1, 0))  # its top went forward
    assert turn((0.0, 0.0, 1.0), engine.poses[RIGHT][1]) == pytest.approx((0, 0, 1))


def test_they_go_with_their_robot(engine: Engine) -> None:
    wheels = WheelsInView(cast("ModuleType", engine), 0)
    wheels.add(ROBOT, WHEELS, CENTRE, lambda: (0.0, 0.0))

    wheels.remove(ROBOT)
    for _ in range(24):
        wheels.step()

    assert engine.poses.keys() == {ROBOT}
