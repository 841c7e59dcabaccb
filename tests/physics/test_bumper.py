"""A bumper's contacts: the body, the place and the force; none without a contact."""

import math
from dataclasses import replace

import pytest
from fixtures.simulations import messages_on

from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots import MODELS
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.sensors.sensor import SensorMount

_CENTER = Pose()
WALL = box("wall", (0.2, 10, 1), Pose(2.1, 0, 0.5))


@pytest.fixture
def place(simulate):
    """Makes a simulation of robots with bumpers, measured at every step."""

    def make(*things, model="husky", poses=(_CENTER,)):
        bumper = SensorMount("bumper", "bumper", 240.0)
        robot = replace(MODELS[model], sensors=(bumper,))
        robots = tuple(RobotPlacement(robot, f"/r{i}", pose) for i, pose in enumerate(poses))
        return simulate(scene=Scene("bumper", objects=things, robots=robots))

    return make


def touches(simulation, seconds, robot="/r0"):
    return messages_on(f"{robot}/bumper", simulation, seconds)


@pytest.mark.parametrize("model", ["husky", "pioneer", "dolly"])
def test_standing_and_driving_on_the_ground_touch_nothing(place, twist, model):
    simulation = place(model=model)
    still = touches(simulation, 1.0)
    simulation.robots[0].command(twist(0.5, 1.0))
    assert [len(message.states) for message in still + touches(simulation, 1.0)] == [0] * 480


@pytest.mark.parametrize(
    ("model", "backwards"), [("husky", True), ("pioneer", False), ("dolly", True)]
)
def test_a_wall_is_named_and_its_normal_points_to_the_robot(place, twist, model, *, backwards):
    simulation = place(WALL, model=model, poses=(Pose(yaw=math.pi if backwards else 0),))
    simulation.robots[0].command(twist(-0.5 if backwards else 0.5, 0.0))
    message = touches(simulation, 5.0)[-1]
    assert message.header.frame_id == "r0/base_link"
    (touch,) = message.states
    assert (touch.collision1_name, touch.collision2_name) == ("/r0", "wall")
    back = 1.0 if backwards else -1.0
    for normal, position in zip(touch.contact_normals, touch.contact_positions, strict=True):
        assert (normal.x, normal.y, normal.z) == pytest.approx((back, 0, 0), abs=0.01)
        assert position.x * back < 0  # in front of it, or behind
    assert touch.total_wrench.force.x * back > 0


def test_the_force_on_a_wall_is_what_the_tyres_can_give(place, twist):
    # 56.6 kg on tyres of friction 0.8 push with at most that.
    simulation = place(WALL)
    simulation.robots[0].command(twist(1.0, 0.0))
    forces = [
        sum(touch.total_wrench.force.x for touch in message.states)
        for message in touches(simulation, 8.0)[-240:]
    ]
    body = MODELS["husky"].body
    assert -sum(forces) / len(forces) == pytest.approx(body.mass * 9.81 * 0.8, rel=0.05)


def test_two_robots_that_meet_tell_each_others_names(place, twist):
    simulation = place(poses=(Pose(), Pose(2.0, 0, 0, yaw=math.pi)))
    for robot in simulation.robots:
        robot.command(twist(0.5, 0.0))
    first = touches(simulation, 4.0, "/r0")[-1]
    second = touches(simulation, 0.1, "/r1")[-1]
    assert [touch.collision2_name for touch in first.states] == ["/r1"]
    assert [touch.collision2_name for touch in second.states] == ["/r0"]


def test_backing_off_ends_the_touch(place, twist):
    simulation = place(WALL)
    simulation.robots[0].command(twist(1.0, 0.0))
    assert touches(simulation, 4.0)[-1].states
    simulation.robots[0].command(twist(-0.5, 0.0))
    assert not touches(simulation, 2.0)[-1].states
