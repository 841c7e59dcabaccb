"""The Pioneer and the Dolly drive as commanded, within their limits. Metres, m/s, rad/s."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from fixtures.simulations import states

from lcmtools_sim.geometry import Pose, yaw_of
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.dolly import DOLLY
from lcmtools_sim.scene import RobotPlacement, Scene


@pytest.fixture
def place(unmeasured):
    """Makes a simulation of one robot of a model, without subscribers of its sensors."""

    def make(model, pose=Pose()):  # noqa: B008 - a value
        model = MODELS[model] if isinstance(model, str) else model
        return unmeasured(scene=Scene("free", robots=(RobotPlacement(model, "/r", pose),)))

    return make


@pytest.mark.parametrize(
    ("model", "forward", "turn_rate"),
    [("pioneer", 0.5, 0.3), ("dolly", 0.5, -0.3), ("pioneer", -0.4, 0.5), ("dolly", 0.2, 1.0)],
)
def test_a_commanded_circle_has_its_radius_and_closes(place, twist, model, forward, turn_rate):
    simulation = place(model)
    simulation.robots[0].command(twist(forward, turn_rate))
    start = states(simulation, 3.0)[-1]
    circle = states(simulation, 2 * math.pi / abs(turn_rate))
    for axis in (0, 1):
        values = [state.position[axis] for state in circle]
        assert (max(values) - min(values)) / 2 == pytest.approx(abs(forward / turn_rate), rel=0.001)
    assert math.dist(circle[-1].position, start.position) < 0.003  # a step's way
    assert circle[-1].velocity[0] == pytest.approx(forward, rel=0.001)
    assert circle[-1].angular_velocity[2] == pytest.approx(turn_rate, rel=0.001)


@pytest.mark.parametrize(
    ("model", "speed"),
    [("husky", 0.6), ("husky", -0.5), ("pioneer", 1.0), ("pioneer", 0.05), ("dolly", -0.5)],
)
def test_a_straight_line_is_straight_wherever_it_leads(place, twist, model, speed):
    simulation = place(model, Pose(2, -1, 0, yaw=0.7))
    simulation.robots[0].command(twist(speed, 0.0))
    start = states(simulation, 2.0)[-1]
    end = states(simulation, 10.0)[-1]
    way = [after - before for after, before in zip(end.position, start.position, strict=True)]
    assert math.hypot(*way) == pytest.approx(abs(speed) * 10, rel=0.001)
    assert abs(-way[0] * math.sin(0.7) + way[1] * math.cos(0.7)) < 0.001
    assert yaw_of(end.rotation) == pytest.approx(0.7, abs=1e-4)


@pytest.mark.parametrize(
    ("model", "turn_rate"), [("husky", 1.0), ("husky", -2.0), ("pioneer", 0.1), ("dolly", -2.0)]
)
def test_turning_on_the_spot_does_not_drift(place, twist, model, turn_rate):
    simulation = place(model, Pose(1, 2))
    simulation.robots[0].command(twist(0.0, turn_rate))
    run = states(simulation, 20.0)
    assert max(math.dist(state.position[:2], (1, 2)) for state in run) < 0.001
    assert run[-1].angular_velocity[2] == pytest.approx(turn_rate, rel=0.001)


@pytest.mark.parametrize(
    ("model", "limit", "lag"), [("pioneer", 1.0, 0.1), ("dolly", 1.0, 0.05), ("husky", 3.0, 0.15)]
)
def test_it_speeds_up_and_stops_at_its_acceleration_and_goes_the_way_that_takes(
    place, twist, model, limit, lag
):
    # A motor of first order whose acceleration is limited: constant until what is missing is
    # limit x lag, an exponential from there on.
    simulation, dt = place(model), 1 / 240
    simulation.robots[0].command(twist(1.0, 0.0))
    up = states(simulation, 4.0)
    simulation.robots[0].command(twist(0.0, 0.0))
    down = states(simulation, 4.0)
    speeds = [0.0, *(state.velocity[0] for state in (*up, *down))]
    steepest = max(abs(b - a) / dt for a, b in pairwise(speeds))
    assert steepest == pytest.approx(limit, rel=0.01)
    half = next(i for i, state in enumerate(up, 1) if state.velocity[0] >= 0.5)
    assert half * dt == pytest.approx(0.5 / limit, abs=2 * dt)
    assert up[-1].velocity[0] == pytest.approx(1.0, rel=0.001)
    assert up[-1].position[0] == pytest.approx(4.0 - _lost(limit, lag), abs=0.01)
    stopped = down[-1].position[0] - up[-1].position[0]
    assert stopped == pytest.approx(_lost(limit, lag), abs=0.01)
    assert down[-1].velocity[0] == pytest.approx(0.0, abs=1e-4)


def _lost(limit, lag):
    """The way that is missing after a ramp to 1 m/s, and that a stop from there takes."""
    tail = limit * lag
    return (1 - tail**2) / (2 * limit) + tail * lag


@pytest.mark.parametrize(
    ("model", "speed", "turn_rate"),
    [("pioneer", 1.2, 5.2), ("dolly", 2.0, 4.0), ("husky", 1.0, 2.0)],
)
def test_what_is_beyond_its_limits_is_obeyed_up_to_them(place, twist, model, speed, turn_rate):
    straight, turning = place(model), place(model)
    straight.robots[0].command(twist(9.0, 0.0))
    turning.robots[0].command(twist(0.0, -50.0))
    assert states(straight, 5.0)[-1].velocity[0] == pytest.approx(speed, rel=0.001)
    assert states(turning, 5.0)[-1].angular_velocity[2] == pytest.approx(-turn_rate, rel=0.001)


def test_dolly_turns_as_gazebo_turned_it_where_its_quirks_are_wanted(place, twist):
    assert DOLLY.gazebo_drive is not None
    simulation = place(replace(DOLLY, drive=DOLLY.gazebo_drive))
    simulation.robots[0].command(twist(0.5, 0.3))
    end = states(simulation, 4.0)[-1]
    assert end.angular_velocity[2] == pytest.approx(0.3 * 1.25 / 0.6, rel=0.001)
    assert end.velocity[0] / end.angular_velocity[2] == pytest.approx(0.8, rel=0.001)


@pytest.mark.parametrize(
    ("model", "command"),
    [
        ("pioneer", (0.5, 0.3)),
        ("pioneer", (0.0, 1.0)),
        ("dolly", (1.0, 0.0)),
        ("dolly", (-0.4, -0.9)),
    ],
)
def test_encoders_agree_with_the_truth_where_nothing_slips(place, twist, model, command):
    simulation = place(model)
    simulation.robots[0].command(twist(*command))
    end = states(simulation, 20.0)[-1]
    x, y, yaw = end.odometry_pose
    assert math.dist((x, y), end.position[:2]) < 0.001 * max(abs(command[0]) * 20, 0.1)
    assert abs(math.remainder(yaw - yaw_of(end.rotation), 2 * math.pi)) < 0.001


@pytest.mark.parametrize("model", ["husky", "pioneer", "dolly"])
def test_it_stands_on_its_wheels_at_rest_for_ever(place, model):
    simulation = place(model, Pose(1, 2, 0, yaw=0.5))
    run = states(simulation, 10.0)
    height = MODELS[model].body.base_height
    assert run[-1].position == pytest.approx((1, 2, height), abs=1e-4)
    assert run[-1].velocity == pytest.approx((0, 0, 0), abs=1e-6)
    assert yaw_of(run[-1].rotation) == pytest.approx(0.5, abs=1e-6)
