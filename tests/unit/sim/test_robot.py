"""The pull of a robot's tyres, whose rotations are written out, against its plain twin."""

from dataclasses import replace

import numpy as np
import pytest

from lcmtools.types.geometry_msgs import Twist
from lcmtools_sim.geometry import (
    Vector,
    add,
    axes,
    dot,
    from_euler,
    multiply,
    scaled,
    subtract,
)
from lcmtools_sim.robot import Robot
from lcmtools_sim.robots import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.world import Motion


class FakeWorld:
    """An engine in which a body has the motion that the test gives it."""

    def __init__(self) -> None:
        self.given = Motion((0.0, 0.0, 0.2), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3)
        self.set: tuple[Vector, Vector] | None = None

    def add_robot(self, *_: object) -> int:
        """Add nothing."""
        return 0

    def motion(self, _: int) -> Motion:
        """The test's motion."""
        return self.given

    def set_velocity(self, _: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Keep it."""
        self.set = velocity, angular_velocity


def plain_pull(robot: Robot, motion: Motion, scene: Scene) -> tuple[Vector, Vector]:
    """The same by the functions of geometry, one rotation after the other."""
    wheels = robot.vehicles.get(0, "left", "right")
    half_turn = (wheels[1] - wheels[0]) / HUSKY.drive.track * scene.dt / 2
    forward, left, up = axes(multiply(motion.rotation, from_euler(0, 0, half_turn)))
    if up[2] < 0.5 or abs(dot(motion.velocity, up)) > 0.2:
        return motion.velocity, motion.angular_velocity
    falling = subtract(motion.velocity, (0.0, 0.0, scene.gravity * scene.dt))
    friction = HUSKY.drive.tyre_friction * scene.ground.friction
    load = HUSKY.body.mass * scene.gravity * up[2]
    along, across, turn = robot._tyres(
        dot(falling, forward),
        dot(falling, left),
        dot(motion.angular_velocity, up),
        *wheels,
        friction * load / 2 * scene.dt,
    )
    pull = add(scaled(forward, along), scaled(left, across))
    return add(motion.velocity, pull), add(motion.angular_velocity, scaled(up, turn))


@pytest.mark.parametrize("tilt", [0.02, 0.4, 1.5])
@pytest.mark.parametrize("skids", [False, True])
def test_the_pull_is_that_of_the_plain_twin(tilt: float, *, skids: bool) -> None:
    random, world, scene = np.random.default_rng(7), FakeWorld(), Scene("free")
    model = replace(HUSKY, drive=replace(HUSKY.drive, skids=skids))
    robot = Robot(world, scene, RobotPlacement(model, "/r"))
    command = Twist()
    command.linear.x, command.angular.z = 0.8, 0.7
    robot.command(command)
    pulled = 0
    for _ in range(200):
        roll, pitch = random.uniform(-tilt, tilt, 2).tolist()
        world.given = Motion(
            (0.0, 0.0, 0.2),
            from_euler(roll, pitch, float(random.uniform(-3, 3))),
            tuple(random.uniform((-1, -1, -0.1), (1, 1, 0.1)).tolist()),
            tuple(random.uniform(-1, 1, 3).tolist()),
        )
        robot.vehicles.step()
        robot.observe()
        robot.pull()

        velocity, angular_velocity = plain_pull(robot, world.given, scene)
        assert world.set is not None
        assert world.set[0] == pytest.approx(velocity, abs=1e-12)
        assert world.set[1] == pytest.approx(angular_velocity, abs=1e-12)
        pulled += world.set[0] != world.given.velocity
    assert pulled > 20
