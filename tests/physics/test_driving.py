"""A Husky on free ground does what the lab says. Speeds in m/s and rad/s, lengths in metres."""

import math
from dataclasses import replace

import pytest
from fixtures.simulations import run, states

from lcmtools_sim.geometry import Pose, axes, yaw_of
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import Ground, RobotPlacement, Scene


def path(simulation, seconds):
    """Positions (x, y) after every step."""
    return [state.position[:2] for state in states(simulation, seconds)]


def test_it_stands_still_without_a_command(unmeasured):
    state = run(unmeasured(), 5.0)
    assert state.position == pytest.approx((0, 0, 0.13228), abs=1e-4)
    assert state.velocity == pytest.approx((0, 0, 0), abs=1e-6)
    assert state.odometry_pose == (0, 0, 0)


def test_full_effort_reaches_one_metre_a_second_within_two_seconds_straight(unmeasured, effort):
    simulation = unmeasured()
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 2.0)
    assert state.velocity[0] == pytest.approx(1.0, rel=0.02)
    state = run(simulation, 8.0)
    assert state.velocity == pytest.approx((1.0, 0, 0), abs=0.001)
    assert abs(state.position[1]) < 0.001
    assert abs(yaw_of(state.rotation)) < 1e-4


@pytest.mark.parametrize("share", [0.1, -1.0])
def test_the_speed_is_proportional_to_the_effort(unmeasured, effort, share):
    simulation = unmeasured()
    simulation.robots[0].command(effort(share, share))
    assert run(simulation, 3.0).velocity[0] == pytest.approx(share, rel=0.02)


@pytest.mark.parametrize("share", [0.05, 1.0, -0.5])
def test_opposite_efforts_turn_it_on_the_spot(unmeasured, effort, share):
    simulation = unmeasured()
    simulation.robots[0].command(effort(-share, share))
    state = run(simulation, 4.0)
    assert state.angular_velocity[2] == pytest.approx(share * 1.87, rel=0.05)
    assert math.hypot(*state.position[:2]) < 0.001


def test_unequal_efforts_drive_a_curve(unmeasured, effort):
    simulation = unmeasured()
    simulation.robots[0].command(effort(0.2, 1.0))
    state = run(simulation, 3.0)
    assert state.velocity[0] == pytest.approx(0.6, rel=0.02)
    assert state.angular_velocity[2] == pytest.approx(0.8 / 1.07025, rel=0.02)


@pytest.mark.parametrize(("forward", "turn_rate"), [(0.5, -0.3), (0.2, 1.0), (-0.5, 0.3)])
def test_a_twist_describes_a_circle_of_its_radius(unmeasured, twist, forward, turn_rate):
    radius = forward / turn_rate
    simulation = unmeasured()
    simulation.robots[0].command(twist(forward, turn_rate))
    run(simulation, 1.0)
    points = path(simulation, 2 * math.pi / abs(turn_rate))
    width = max(x for x, _ in points) - min(x for x, _ in points)
    depth = max(y for _, y in points) - min(y for _, y in points)
    assert width / 2 == pytest.approx(abs(radius), rel=0.01)
    assert depth / 2 == pytest.approx(abs(radius), rel=0.01)


def test_a_circle_closes_within_a_millimetre(unmeasured, twist):
    # A period that is a whole number of steps: 20 s, turn rate 2 pi / 20.
    simulation = unmeasured()
    simulation.robots[0].command(twist(0.5, 2 * math.pi / 20))
    start = run(simulation, 2.0)
    end = run(simulation, 20.0)
    assert math.dist(start.position, end.position) < 0.001
    assert yaw_of(end.rotation) == pytest.approx(yaw_of(start.rotation), abs=1e-3)


def test_zero_effort_stops_it(unmeasured, effort):
    simulation = unmeasured()
    simulation.robots[0].command(effort(1, 1))
    run(simulation, 2.0)
    simulation.robots[0].command(effort(0, 0))
    first = run(simulation, 2.0)
    second = run(simulation, 5.0)
    assert first.velocity == pytest.approx((0, 0, 0), abs=1e-4)
    assert second.position == pytest.approx(first.position, abs=1e-4)


def test_a_command_holds_until_the_next(unmeasured, twist):
    simulation = unmeasured()
    simulation.robots[0].command(twist(0.5, 0))
    assert run(simulation, 30.0).velocity[0] == pytest.approx(0.5, rel=0.001)


def test_a_timeout_ends_a_command_and_the_next_one_counts_again(unmeasured, twist):
    robot = RobotPlacement(HUSKY, "/husky0", Pose(), cmd_timeout=1.5)
    simulation = unmeasured(scene=Scene("timed", robots=(robot,)))
    simulation.robots[0].command(twist(0.5, 0))
    assert run(simulation, 1.4).velocity[0] == pytest.approx(0.5, rel=0.02)
    assert run(simulation, 1.6).velocity[0] == pytest.approx(0.0, abs=0.001)
    simulation.robots[0].command(twist(0.5, 0))
    assert run(simulation, 1.4).velocity[0] == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize("command", [(1.0, 0.0), (0.5, 0.3), (0.0, 1.0), (-0.7, 1.4)])
def test_encoder_odometry_agrees_with_the_truth_to_a_thousandth_of_the_way(
    unmeasured, twist, command
):
    simulation = unmeasured()
    simulation.robots[0].command(twist(*command))
    state = run(simulation, 20.0)
    x, y, yaw = state.odometry_pose
    way = abs(command[0]) * 20
    turned = abs(command[1]) * 20
    assert math.dist((x, y), state.position[:2]) <= 0.001 * max(way, 0.1)
    error = math.remainder(yaw - yaw_of(state.rotation), 2 * math.pi)
    assert abs(error) <= 0.001 * max(turned, 0.1)
    assert state.odometry_speed[0] == pytest.approx(state.velocity[0], abs=0.001)
    assert state.odometry_speed[1] == pytest.approx(state.angular_velocity[2], abs=0.001)


def test_wheels_turn_at_six_radians_a_second_at_full_effort(unmeasured, effort):
    simulation = unmeasured()
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 3.0)
    assert state.wheel_speeds == pytest.approx((6.057, 6.057), rel=0.001)
    assert state.efforts == (1, 1)
    left, right = state.wheel_angles
    assert left == right == pytest.approx(2.8007 / 0.1651, rel=0.001)


@pytest.mark.parametrize("dt", [1 / 120, 1 / 240, 1 / 1000])
def test_the_step_changes_nothing(unmeasured, twist, dt):
    scene = Scene("fine", dt=dt, robots=(RobotPlacement(HUSKY, "/husky0"),))
    simulation = unmeasured(scene=scene)
    simulation.robots[0].command(twist(0.5, 0.3))
    state = run(simulation, 10.0)
    assert math.dist(state.position[:2], (0.314, 3.303)) < 0.02
    assert state.velocity[0] == pytest.approx(0.5, rel=0.001)


def test_it_starts_where_and_how_the_scene_says(unmeasured, effort):
    simulation = unmeasured(pose=Pose(3, -2, 0, yaw=math.pi / 2))
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 3.0)
    assert state.position[:2] == pytest.approx((3, -2 + 2.8), abs=0.01)
    assert state.velocity[0] == pytest.approx(1.0, rel=0.02)
    assert state.odometry_pose[:2] == pytest.approx((2.8, 0), abs=0.01)


def test_dropped_from_above_it_lands_on_its_wheels_and_drives(unmeasured, effort):
    simulation = unmeasured(pose=Pose(0, 0, 0.5))
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 4.0)
    assert state.position[2] == pytest.approx(0.13228, abs=0.001)
    assert state.velocity[0] == pytest.approx(1.0, rel=0.02)
    assert axes(state.rotation)[2][2] == pytest.approx(1.0, abs=1e-6)


def test_on_its_back_its_wheels_pull_nothing(unmeasured, effort):
    simulation = unmeasured(pose=Pose(0, 0, 0.5, roll=math.pi))
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 3.0)
    assert math.hypot(*state.position[:2]) < 0.05
    assert state.wheel_speeds.left == pytest.approx(6.057, rel=0.001)


def test_on_ice_it_slips_and_its_encoders_do_not_notice(unmeasured, effort):
    scene = Scene("ice", ground=Ground(0.01), robots=(RobotPlacement(HUSKY, "/husky0"),))
    simulation = unmeasured(scene=scene)
    simulation.robots[0].command(effort(1, 1))
    state = run(simulation, 2.0)
    # Coulomb: at most 0.8 x 0.01 x 9.81 m/s^2 for two seconds.
    assert state.velocity[0] == pytest.approx(0.8 * 0.01 * 9.81 * 2.0, rel=0.02)
    assert state.odometry_speed[0] == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize("turn_rate", [0.5, 1.0, -1.0])
def test_a_skidding_husky_turns_on_the_spot_as_the_balance_of_moments_says(
    unmeasured, twist, turn_rate
):
    husky = replace(HUSKY, drive=replace(HUSKY.drive, skids=True))
    simulation = unmeasured(scene=Scene("skid", robots=(RobotPlacement(husky, "/husky0"),)))
    simulation.robots[0].command(twist(0.0, turn_rate))
    a, b = husky.drive.wheels[0]
    wheel_speed = turn_rate * husky.drive.track / 2
    state = run(simulation, 3.0)
    assert state.angular_velocity[2] == pytest.approx(wheel_speed * b / (a * a + b * b), rel=1e-3)
    assert state.odometry_speed[1] == pytest.approx(turn_rate)  # which encoders cannot know


@pytest.mark.parametrize(
    ("forward", "turn_rate"), [(0.2, 0.5), (0.5, 0.3), (1.0, 0.5), (-0.5, 1.0)]
)
def test_a_skidding_husky_under_a_twist_is_in_balance(unmeasured, twist, forward, turn_rate):
    husky = replace(HUSKY, drive=replace(HUSKY.drive, skids=True))
    simulation = unmeasured(scene=Scene("skid", robots=(RobotPlacement(husky, "/husky0"),)))
    simulation.robots[0].command(twist(forward, turn_rate))
    state = run(simulation, 5.0)
    # Each wheel pulls against its own slip; together they turn the momentum, and nothing else.
    vx, vy, _ = state.velocity
    rate, radius, mass = state.angular_velocity[2], husky.drive.wheel_radius, husky.body.mass
    load = mass * 9.81 / 4 * husky.drive.tyre_friction
    along = across = moment = 0.0
    for x, y in husky.drive.wheels:
        speed = (state.wheel_speeds.left if y > 0 else state.wheel_speeds.right) * radius
        slip = vx - rate * y - speed, vy + rate * x
        fx, fy = (-load * part / math.hypot(*slip) for part in slip)
        along, across, moment = along + fx, across + fy, moment + x * fy - y * fx
    assert along == pytest.approx(-mass * rate * vy, abs=0.002 * load)
    assert across == pytest.approx(mass * rate * vx, abs=0.002 * load)
    assert moment == pytest.approx(0.0, abs=0.002 * load)
    assert rate / turn_rate == pytest.approx(1.04, abs=0.012)  # Clearpath's track is 4 % more
