"""A robot on a slope stands still, drives at the commanded speed, and slides if it must. Metres."""

import math
from dataclasses import replace

import pytest
from fixtures.simulations import run

from lcmtools_sim.geometry import Pose, from_euler, multiply, to_euler
from lcmtools_sim.robots import MODELS
from lcmtools_sim.scene import Ground, RobotPlacement, Scene, box

TOP = 3.0  # of the board, in its middle
THICKNESS = 0.2


@pytest.fixture
def on_slope(unmeasured):
    """A simulation of a robot that stands on a large board, which rises towards x."""

    def make(model, slope, yaw=0.0, *, friction=1.0, skids=False):
        middle = TOP - THICKNESS / 2 / math.cos(slope)
        board = box("board", (20, 20, THICKNESS), Pose(0, 0, middle, 0, -slope, 0))
        upon = to_euler(multiply(from_euler(0, -slope, 0), from_euler(0, 0, yaw)))
        chosen = replace(MODELS[model], drive=replace(MODELS[model].drive, skids=skids))
        robots = (RobotPlacement(chosen, "/r0", Pose(0, 0, TOP, *upon)),)
        scene = Scene("slope", objects=(board,), robots=robots, ground=Ground(friction=friction))
        simulation = unmeasured(scene=scene)
        run(simulation, 0.5)
        return simulation

    return make


def way(before, after):
    return math.dist(before.position, after.position)


@pytest.mark.parametrize(
    ("model", "skids", "yaw"),
    [
        *(("husky", False, 0.0), ("husky", True, 2.5), ("husky", True, math.pi / 2)),
        *(("pioneer", False, 0.0), ("pioneer", False, math.pi / 2), ("dolly", False, 2.5)),
    ],
)
def test_it_stands_still_on_a_slope(on_slope, model, yaw, *, skids):
    simulation = on_slope(model, math.radians(10), yaw, skids=skids)
    before = run(simulation, 0.5)
    assert way(before, run(simulation, 3.0)) < 0.001


@pytest.mark.parametrize(
    ("model", "speed"), [("husky", 0.5), ("husky", -0.5), ("pioneer", -0.5), ("dolly", 0.5)]
)
def test_it_drives_up_and_down_at_the_commanded_speed(on_slope, twist, model, speed):
    simulation = on_slope(model, math.radians(10))
    simulation.robots[0].command(twist(speed, 0.0))
    before = run(simulation, 2.0)
    after = run(simulation, 4.0)
    assert way(before, after) == pytest.approx(2.0, rel=0.002)
    assert after.velocity[0] == pytest.approx(speed, rel=0.002)


@pytest.mark.parametrize(("friction", "slides"), [(0.5, True), (0.6, False)])
def test_it_slides_where_the_slope_is_steeper_than_its_tyres_can_hold(
    on_slope, friction, *, slides
):
    slope = math.atan(0.55 * MODELS["husky"].drive.tyre_friction)
    simulation = on_slope("husky", slope, friction=friction)
    before = run(simulation, 0.5)
    after = run(simulation, 1.0)
    assert (way(before, after) > 0.1) is slides
