"""Walls stop a Husky, boxes are pushed, and another robot is another robot. Metres, m/s, kg."""

import math

import pytest
from fixtures.simulations import states

from lcmtools.errors import InvalidFile
from lcmtools_sim.engines import chosen_engine
from lcmtools_sim.geometry import Pose, axes
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

FRONT = 0.9874 / 2
WALL = box("wall", (0.2, 10, 1), Pose(3.1, 0, 0.5))


def tilt(state):
    """Angle of the robot's up axis to the vertical [rad]."""
    up = axes(state.rotation)[2]
    return math.atan2(math.hypot(up[0], up[1]), up[2])


@pytest.mark.parametrize("yaw", [0.0, 0.3, math.pi])
def test_a_wall_stops_it_at_contact_without_pitching(unmeasured, effort, yaw):
    simulation = unmeasured(WALL, pose=Pose(0, 0, 0, yaw=yaw))
    share = -1.0 if yaw == math.pi else 1.0  # backwards
    simulation.robots[0].command(effort(share, share))
    run = states(simulation, 8.0)
    assert max(state.position[0] for state in run) < 3.0 - FRONT + 0.01
    assert max(map(tilt, run)) < math.radians(0.5)
    assert run[-1].position[2] == pytest.approx(0.13228, abs=0.001)
    if yaw != 0.3:
        assert run[-1].position[0] == pytest.approx(3.0 - FRONT, abs=0.01)
        assert run[-1].velocity == pytest.approx((0, 0, 0), abs=0.001)


def test_its_wheels_slip_at_a_wall_so_that_odometry_runs_ahead_of_the_truth(unmeasured, effort):
    simulation = unmeasured(WALL)
    simulation.robots[0].command(effort(1, 1))
    end = states(simulation, 8.0)[-1]
    assert end.odometry_pose[0] == pytest.approx(7.8, abs=0.02)
    assert end.position[0] == pytest.approx(2.506, abs=0.01)


def test_it_comes_away_from_a_wall(unmeasured, effort):
    simulation = unmeasured(WALL)
    simulation.robots[0].command(effort(1, 1))
    states(simulation, 5.0)
    simulation.robots[0].command(effort(-0.5, -0.5))
    end = states(simulation, 4.0)[-1]
    assert end.position[0] < 1.0
    assert end.velocity[0] == pytest.approx(-0.5, rel=0.01)


@pytest.mark.parametrize(
    ("model", "dt", "forward"),
    [
        *(("husky", 1 / 120, 9.0), ("husky", 1 / 240, -9.0), ("pioneer", 1 / 120, -9.0)),
        *(("dolly", 1 / 120, 9.0), ("dolly", 1 / 120, -9.0), ("dolly", 1 / 240, 9.0)),
    ],
)
def test_a_thin_wall_does_not_let_it_through_at_full_speed(unmeasured, twist, model, dt, forward):
    # Sheets of 10 mm; a Dolly at 2 m/s goes 17 mm in the longer step.
    sheets = tuple(box(f"sheet{x}", (0.01, 10, 1), Pose(x, 0, 0.5)) for x in (-4.0, 4.0))
    robot = RobotPlacement(MODELS[model], "/a")
    simulation = unmeasured(scene=Scene("thin", dt=dt, objects=sheets, robots=(robot,)))
    simulation.robots[0].command(twist(forward, 0.0))
    run = states(simulation, 8.0)
    assert max(abs(state.position[0]) for state in run) < 4.0
    assert abs(run[-1].position[0]) > 2.5  # it got there
    assert max(map(tilt, run)) < 0.35


def test_it_pushes_a_box_of_20_kg_at_nearly_full_speed(unmeasured, effort):
    crate = box("crate", (0.6, 0.6, 0.6), Pose(2, 0, 0.3), mass=20, friction=0.6)
    simulation = unmeasured(crate)
    simulation.robots[0].command(effort(1, 1))
    run = states(simulation, 6.0)
    assert run[-1].velocity[0] == pytest.approx(1.0, rel=0.05)
    assert max(map(tilt, run)) < math.radians(2)


def test_it_stalls_at_a_box_of_100_kg_whose_friction_is_above_its_own(unmeasured, effort):
    # 100 kg x 0.9 x 9.81 = 883 N against 56.6 kg x 0.8 x 9.81 = 444 N.
    block = box("block", (0.6, 0.6, 0.6), Pose(2, 0, 0.3), mass=100, friction=0.9)
    simulation = unmeasured(block)
    simulation.robots[0].command(effort(1, 1))
    end = states(simulation, 6.0)[-1]
    assert end.position[0] == pytest.approx(2 - 0.3 - FRONT, abs=0.1)
    assert end.velocity[0] == pytest.approx(0.0, abs=0.02)


def test_the_labs_world_leaves_its_straight_run_and_its_circles_free(unmeasured, effort, twist):
    scene = read_scene(*find_world("husky"))
    straight = unmeasured(scene=scene)
    straight.robots[0].command(effort(1, 1))
    assert states(straight, 10.5)[-1].position[0] == pytest.approx(10.3, abs=0.05)
    for turn_rate in (0.3, -0.3):
        circle = unmeasured(scene=scene)
        circle.robots[0].command(twist(0.5, turn_rate))
        end = states(circle, 21.0)[-1]
        assert math.dist(end.position[:2], end.odometry_pose[:2]) < 0.01


def test_the_labs_yard_is_closed(unmeasured, effort):
    scene = read_scene(*find_world("husky"))
    simulation = unmeasured(scene=scene)
    simulation.robots[0].command(effort(1, 1))
    end = states(simulation, 20.0)[-1]
    assert end.position[0] == pytest.approx(14 - 0.1 - FRONT, abs=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_robots_apart_do_not_influence_each_other(unmeasured, effort, twist, model):
    robots = tuple(
        RobotPlacement(MODELS[kind], f"/r{i}", Pose(0, 5 * i, 0, yaw=0.3 * i))
        for i, kind in enumerate((model, "husky", "dolly", "pioneer"))
    )
    all_of_them = unmeasured(scene=Scene("all", robots=robots))
    alone = unmeasured(scene=Scene("alone", robots=robots[:1]))
    for simulation in (all_of_them, alone):
        simulation.robots[0].command(twist(0.5, 0.3))
    for robot in all_of_them.robots[1:]:
        robot.command(effort(-1, -0.7))
    together, single = states(all_of_them, 5.0), states(alone, 5.0)
    if chosen_engine() == "bullet":
        assert together == single
    for one, other in zip(together, single, strict=True):  # MuJoCo solves for all of them at once
        assert math.dist(one.position, other.position) < 1e-6
    assert all_of_them.robots[1].state(all_of_them.time).velocity[0] == pytest.approx(-0.85, 0.02)


def test_two_robots_that_meet_do_not_drive_through_each_other(unmeasured, effort):
    pair = (
        RobotPlacement(HUSKY, "/a", Pose()),
        RobotPlacement(HUSKY, "/b", Pose(4, 0, 0, yaw=math.pi)),
    )
    simulation = unmeasured(scene=Scene("meeting", robots=pair))
    for robot in simulation.robots:
        robot.command(effort(1, 1))
    states(simulation, 6.0)
    first, second = (robot.state(0).position for robot in simulation.robots)
    assert math.dist(first, second) > 2 * FRONT - 0.02


def test_a_robot_that_starts_slightly_inside_a_wall_is_pushed_out(unmeasured):
    simulation = unmeasured(box("block", (1, 1, 1), Pose(FRONT + 0.5 - 0.015, 0, 0.5)))
    end = states(simulation, 2.0)[-1]
    assert end.position[0] == pytest.approx(-0.015, abs=0.01)


@pytest.mark.parametrize(
    ("thing", "pose", "other"),
    [
        (box("block", (1, 1, 1), Pose(1, 0, 0.5)), Pose(0.3, 0), "0.29 m inside block"),
        (box("block", (1, 1, 1), Pose(5, 0, 0.5)), Pose(0, 0, -0.1), "0.10 m inside the ground"),
    ],
)
def test_a_robot_that_starts_inside_something_is_refused_with_its_line(
    unmeasured, thing, pose, other
):
    robot = RobotPlacement(HUSKY, "/husky0", pose, where="yard.yaml:7")
    with pytest.raises(InvalidFile) as caught:
        unmeasured(scene=Scene("yard", objects=(thing,), robots=(robot,)))
    assert str(caught.value) == (f"yard.yaml:7: the husky /husky0 starts {other}; change its pose")


@pytest.mark.parametrize(
    ("model", "front"), [("husky", FRONT), ("pioneer", 0.1875), ("dolly", 0.2)]
)
def test_what_touches_a_wall_is_what_can_be_seen_of_it(unmeasured, twist, model, front):
    # The feet stay within the outline: on one foot in front it would turn aside, too.
    scene = Scene("wall", objects=(WALL,), robots=(RobotPlacement(MODELS[model], "/r0"),))
    simulation = unmeasured(scene=scene)
    simulation.robots[0].command(twist(2.0, 0.0))
    end = states(simulation, 9.0)[-1]
    assert end.position[0] == pytest.approx(3.0 - front, abs=0.002)
    assert end.position[1] == pytest.approx(0, abs=0.002)
    assert end.velocity == pytest.approx((0, 0, 0), abs=0.001)
