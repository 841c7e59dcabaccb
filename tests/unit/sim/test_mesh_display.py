"""The meshes of a robot follow it, and its wheels turn with its motors. Metres, radians."""

import math
from itertools import count
from types import ModuleType, SimpleNamespace
from typing import cast

import pytest

from lcmtools_sim.engines.engine import Appearance
from lcmtools_sim.engines.mesh_display import MeshDisplay
from lcmtools_sim.geometry import Quaternion, Vector, from_euler, rotate
from lcmtools_sim.robots.model import Mesh

ROBOT, OTHER = 1, 2
CENTRE = 0.2
LEFT = Mesh("left.stl", (0.3, 0.25, 0.15), is_wheel=True)
RIGHT = Mesh("right.stl", (0.3, -0.25, 0.15), is_wheel=True)
REAR_BUMPER = Mesh("bumper.stl", (-0.4, 0.0, 0.2), (0.0, 0.0, 1.0, 0.0))
MESHES = (LEFT, RIGHT, REAR_BUMPER)


class Engine:
    """Bodies and where they are."""

    def __init__(self) -> None:
        self.poses: dict[int, tuple[Vector, Quaternion]] = {}
        self.looks: dict[str, int] = {}
        self._numbers = count(10)

    def make(self, mesh: Mesh) -> int:
        """Another body, the last one of its look."""
        self.looks[mesh.file] = number = next(self._numbers)
        return number

    def of(self, mesh: Mesh) -> tuple[Vector, Quaternion]:
        """The pose of the last body with a look."""
        return self.poses[self.looks[mesh.file]]

    def getBasePositionAndOrientation(self, body: int) -> tuple[Vector, Quaternion]:  # noqa: N802
        """As pybullet's."""
        return self.poses[body]

    def resetBasePositionAndOrientation(  # noqa: N802
        self, body: int, position: Vector, rotation: Quaternion
    ) -> None:
        """As pybullet's."""
        self.poses[body] = position, rotation

    def removeBody(self, body: int) -> None:  # noqa: N802
        """As pybullet's."""
        del self.poses[body]


@pytest.fixture
def engine() -> Engine:
    found = Engine()
    found.poses[ROBOT] = (5.0, 1.0, CENTRE), from_euler(0, 0, math.pi / 2)
    return found


@pytest.fixture
def view(engine: Engine) -> MeshDisplay:
    return MeshDisplay(cast("ModuleType", engine), engine.make)


def test_they_stand_where_the_robot_has_them_and_each_side_turns_by_its_own_angle(
    engine: Engine, view: MeshDisplay
) -> None:
    angles = SimpleNamespace(now=(0.0, 0.0))
    view.add(ROBOT, Appearance(MESHES, CENTRE, lambda: angles.now))
    assert engine.of(LEFT)[0] == pytest.approx((4.75, 1.3, 0.15))
    assert engine.of(RIGHT)[0] == pytest.approx((5.25, 1.3, 0.15))

    angles.now = math.pi / 2, 0.0
    engine.poses[ROBOT] = (5.0, 2.0, CENTRE), from_euler(0, 0, math.pi / 2)
    for _ in range(24):
        view.step()

    place, turned = engine.of(LEFT)
    assert place == pytest.approx((4.75, 2.3, 0.15))
    assert rotate((0.0, 0.0, 1.0), turned) == pytest.approx((0, 1, 0))  # its top went forward
    assert rotate((0.0, 0.0, 1.0), engine.of(RIGHT)[1]) == pytest.approx((0, 0, 1))


def test_what_does_not_turn_keeps_its_own_rotation_on_the_robot(
    engine: Engine, view: MeshDisplay
) -> None:
    view.add(ROBOT, Appearance(MESHES, CENTRE, lambda: (1.0, 1.0)))

    place, turned = engine.of(REAR_BUMPER)

    assert place == pytest.approx((5.0, 0.6, 0.2))
    assert rotate((1.0, 0.0, 0.0), turned) == pytest.approx((0, -1, 0))  # it faces backwards


def test_they_go_with_their_robot_and_the_others_stay(engine: Engine, view: MeshDisplay) -> None:
    engine.poses[OTHER] = (0.0, 0.0, CENTRE), from_euler(0, 0, 0)
    for robot in (ROBOT, OTHER):
        view.add(robot, Appearance((LEFT, RIGHT), CENTRE, lambda: (0.0, 0.0)))

    view.hide_all()
    assert engine.poses.keys() == {ROBOT, OTHER}
    view.forget(ROBOT)
    view.show_all()
    view.step()

    assert len(engine.poses) == 4
    assert engine.of(LEFT)[0] == pytest.approx((0.3, 0.25, 0.15))
