"""Wheels, encoders and the motion in the plane as mathematics; and many robots at once."""

import math
from dataclasses import astuple, replace

import numpy as np
import pytest

from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.vehicles import Variables, Vehicles, constants_of

DT = 1 / 240
DRIVE = HUSKY.drive
SKIDDING = replace(HUSKY, drive=replace(DRIVE, skids=True))


def known(model=HUSKY, timeout=math.inf):
    return constants_of(model, DT, timeout, friction=9.81)


def driven(vehicles, steps):
    for _ in range(steps):
        vehicles.step()
    return vehicles.now


def test_wheels_turn_by_the_way_over_the_radius():
    vehicles = Vehicles(HUSKY, known(), Variables(left_target=1.0, right_target=0.5), DT)
    before = replace(driven(vehicles, 2400))
    after = driven(vehicles, 240)
    assert after.left_angle - before.left_angle == pytest.approx(1 / 0.1651)
    assert after.right_angle - before.right_angle == pytest.approx(0.5 / 0.1651)


def test_a_body_on_wheels_that_grip_goes_where_its_encoders_say():
    vehicles = Vehicles(HUSKY, known(), Variables(left_target=0.3, right_target=0.6), DT)
    now = driven(vehicles, 240 * 60)
    assert (now.x, now.y, now.yaw) == pytest.approx(
        (now.odometry_x, now.odometry_y, now.odometry_yaw), abs=1e-9
    )


def test_it_slides_where_the_ground_gives_too_little():
    ice = replace(known(), largest_impulse=known().largest_impulse / 100)
    vehicles = Vehicles(HUSKY, ice, Variables(left_target=1.0, right_target=1.0), DT)
    now = driven(vehicles, 240)
    # 0.8 / 100 of gravity, for a second.
    assert now.vx == pytest.approx(0.008 * 9.81, rel=1e-6)


def test_a_command_ends_with_its_timeout():
    vehicles = Vehicles(HUSKY, known(timeout=0.5), Variables(left_target=1, right_target=1), DT)
    assert driven(vehicles, 120).left_target == 1.0
    assert driven(vehicles, 1).left_target == 0.0
    assert driven(vehicles, 240 * 3).left == 0.0


def test_noisy_encoders_read_another_speed_in_each_step_but_not_at_rest():
    drawn = []

    def random(count):
        drawn.append(count)
        return [1.0, 1.0]

    vehicles = Vehicles(HUSKY, known(), Variables(0.5, 0.5, left=0.5, right=0.5), DT, 0.01, random)
    now = driven(vehicles, 2000)
    way = now.left_angle * DRIVE.wheel_radius
    assert len(drawn) == 2000
    assert now.odometry_x - way == pytest.approx(
        0.01 / math.sqrt(DT) * math.sqrt(0.5) * 2000 * DT, rel=0.01
    )
    vehicles.set(0, left_target=0.0, right_target=0.0, left=0.0, right=0.0)
    driven(vehicles, 100)
    assert len(drawn) == 2000


@pytest.mark.parametrize("model", [HUSKY, SKIDDING], ids=["gripping", "skidding"])
def test_many_robots_move_as_each_alone(model):
    random = np.random.default_rng(5)
    starts = [Variables(*random.uniform(-1, 1, 19).tolist()) for _ in range(20)]
    timeouts = [100.0 if i % 2 else 0.3 for i in range(20)]
    alone = [
        Vehicles(model, known(model, timeout), replace(start), DT)
        for start, timeout in zip(starts, timeouts, strict=True)
    ]
    together = Vehicles.joined(
        [
            (Vehicles(model, known(model, timeout), replace(start), DT), 0)
            for start, timeout in zip(starts, timeouts, strict=True)
        ]
    )
    driven(together, 500)
    for index, single in enumerate(alone):
        driven(single, 500)
        values = astuple(together.row(index)[1])
        assert values == pytest.approx(astuple(single.now), abs=1e-9)
        assert together.get(index, "x") == [values[10]]


def test_a_robot_of_many_can_be_set_alone():
    single = Vehicles(HUSKY, known(), Variables(), DT)
    together = Vehicles.joined([(single, 0)] * 3)
    together.set(1, left_target=1.0, right_target=1.0)
    driven(together, 240)
    assert [together.get(i, "x")[0] > 0.5 for i in range(3)] == [False, True, False]
