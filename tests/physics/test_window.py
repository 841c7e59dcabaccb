"""With a window everything moves to the bit as without one.

The window's engine is asked for without its display: what is built in it is the same.
"""

import pytest

from lcmtools.types.geometry_msgs import Twist
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots import DOLLY, HUSKY, PIONEER
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.sensors.sensor import RobotState
from lcmtools_sim.simulation import Simulation

pybullet = pytest.importorskip("pybullet")

THINGS = (
    box("low", (0.5, 0.5, 0.5), Pose(1.2, 0.1, 0.25), mass=8),
    box("high", (0.5, 0.5, 0.5), Pose(1.2, 0.1, 0.75), mass=3),
    box("wall", (0.2, 10, 1), Pose(3, 0, 0.5)),
)
ROBOTS = tuple(
    RobotPlacement(model, f"/r{number}", Pose(0, 2.0 * number))
    for number, model in enumerate((HUSKY, PIONEER, DOLLY, HUSKY))
)


def run(*, window: bool) -> list[list[RobotState]]:
    """Four robots that push and turn; one goes and another one comes meanwhile."""
    scene = Scene("all", objects=THINGS, robots=ROBOTS)
    with Simulation(scene, engine="bullet", window=window) as simulation:
        simulation.select(lambda _: Subscribers.NONE)
        for number, robot in enumerate(simulation.robots):
            command = Twist()
            command.linear.x, command.angular.z = 0.8, 0.2 * number - 0.1
            robot.command(command)
        found = []
        for step in range(720):
            if step == 360:
                simulation.remove(simulation.robots[1])
                simulation.add(RobotPlacement(HUSKY, "/late", Pose(-3, -3)))
                simulation.select(lambda _: Subscribers.NONE)
            simulation.step()
            found.append([robot.state(0) for robot in simulation.robots])
        return found


def test_a_window_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    without = run(window=False)
    monkeypatch.setattr(pybullet, "GUI", pybullet.DIRECT)

    assert run(window=True) == without


def test_a_robot_that_goes_takes_its_meshes_along_and_a_reset_leaves_none_twice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pybullet, "GUI", pybullet.DIRECT)
    scene = Scene("pair", robots=(ROBOTS[0], ROBOTS[3]))
    with Simulation(scene, engine="bullet", window=True) as simulation:
        count = simulation._world._engine._bullet.getNumBodies
        both = count()
        simulation.remove(simulation.robots[0])
        one = count()
        simulation.reset()

        assert both - one == one - 1 == 1 + len(HUSKY.body.meshes)  # the ground is the other one
        assert count() == both
