"""Motors and dead reckoning as mathematics."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools_sim.drive import (
    STOPPED,
    Drivetrain,
    SideSpeeds,
    body_velocity,
    dead_reckoning,
    follow,
    side_speeds,
)
from lcmtools_sim.robots.husky import HUSKY

DT = 1 / 240
DRIVE = HUSKY.drive

speeds = st.floats(-3, 3)


def motor_speed_after(seconds: float, target: float, dt: float = DT) -> float:
    now = STOPPED
    for _ in range(round(seconds / dt)):
        now = follow(now, SideSpeeds(target, target), DRIVE, dt)
    return now.left


def test_a_motor_at_full_effort_comes_within_half_a_percent_in_two_seconds() -> None:
    assert motor_speed_after(2.0, 1.0) == pytest.approx(1.0, rel=0.005)


def test_a_motor_follows_a_small_step_with_its_time_constant() -> None:
    # Below the acceleration limit it is a first-order lag: 63.2 % after one time constant.
    speed = motor_speed_after(0.15, 0.1, dt=1e-4)

    assert speed / 0.1 == pytest.approx(1 - math.exp(-1), abs=0.001)


def test_a_motor_never_accelerates_above_the_limit() -> None:
    after = follow(STOPPED, SideSpeeds(1.0, 1.0), DRIVE, DT)

    assert after.left / DT == pytest.approx(3.0)


def test_a_motor_reaches_standstill_exactly() -> None:
    now = SideSpeeds(1.0, -0.5)
    for _ in range(240 * 4):
        now = follow(now, STOPPED, DRIVE, DT)

    assert now == (0.0, 0.0)


@given(speeds, speeds)
def test_the_limit_keeps_the_proportion_of_the_sides(left: float, right: float) -> None:
    after = follow(STOPPED, SideSpeeds(left, right), DRIVE, DT)

    assert after.left * right == pytest.approx(after.right * left, abs=1e-12)


@given(st.floats(-1, 1), st.floats(-2, 2))
def test_side_speeds_and_body_velocity_are_inverse(forward: float, turn_rate: float) -> None:
    there_and_back = body_velocity(side_speeds(forward, turn_rate, DRIVE), DRIVE.track)

    assert there_and_back == pytest.approx((forward, turn_rate), abs=1e-12)


def test_the_effective_track_of_a_husky_is_the_one_of_the_text() -> None:
    assert DRIVE.track == pytest.approx(1.07025)
    assert body_velocity(SideSpeeds(-1, 1), DRIVE.track)[1] == pytest.approx(1.87, abs=0.005)


def test_wheels_turn_by_the_way_over_the_radius() -> None:
    train = Drivetrain(DRIVE, DT)
    for _ in range(2400):
        train.step(SideSpeeds(1.0, 0.5))
    before = train.angles()
    for _ in range(240):
        train.step(SideSpeeds(1.0, 0.5))

    turned = [after - angle for after, angle in zip(train.angles(), before, strict=True)]
    assert turned == pytest.approx([1 / 0.1651, 0.5 / 0.1651])


def test_dead_reckoning_closes_a_circle() -> None:
    # Twist (0.5, 0.3): radius 1.6667 m, period 20.944 s.
    dt = 2 * math.pi / 0.3 / 5000

    x, y, yaw = dead_reckoning((0.0, 0.0, 0.0), 0.5 * dt, 0.3 * dt / 2, 5000)

    assert (x, y) == pytest.approx((0, 0), abs=1e-9)
    assert yaw == pytest.approx(2 * math.pi)


def test_dead_reckoning_is_half_a_circle_away_after_half_the_time() -> None:
    dt = math.pi / 0.3 / 5000

    x, y, _ = dead_reckoning((0.0, 0.0, 0.0), 0.5 * dt, 0.3 * dt / 2, 5000)

    assert (x, y) == pytest.approx((0, 2 * 0.5 / 0.3), abs=1e-6)


@given(
    st.floats(-0.02, 0.02), st.one_of(st.just(0.0), st.floats(-0.02, 0.02)), st.integers(0, 2000)
)
def test_many_steps_at_once_lead_where_they_lead_one_by_one(
    way: float, half_turn: float, steps: int
) -> None:
    pose = start = 1.0, -2.0, 0.5
    for _ in range(steps):
        pose = dead_reckoning(pose, way, half_turn)

    assert dead_reckoning(start, way, half_turn, steps) == pytest.approx(pose, abs=1e-9)


def test_looking_at_the_wheels_changes_nothing() -> None:
    seen, unseen = Drivetrain(DRIVE, DT), Drivetrain(DRIVE, DT)
    for step in range(3000):
        targets = SideSpeeds(1.0, 0.4) if step < 2000 else STOPPED
        seen.step(targets)
        unseen.step(targets)
        seen.angles(), seen.odometry_pose()

    assert (seen.angles(), seen.odometry_pose()) == (unseen.angles(), unseen.odometry_pose())


def test_stopped_wheels_stay_where_they_have_come() -> None:
    train = Drivetrain(DRIVE, DT)
    for _ in range(1000):
        train.step(SideSpeeds(1.0, 0.4))
    before = train.angles(), train.odometry_pose()

    train.stop()
    for _ in range(10):
        train.step(STOPPED)

    assert train.speeds == STOPPED
    assert (train.angles(), train.odometry_pose()) == before


def test_noisy_encoders_read_another_speed_in_each_step_but_not_at_rest() -> None:
    drawn: list[int] = []

    def random(count: int) -> list[float]:
        drawn.append(count)
        return [1.0, 1.0]

    train = Drivetrain(DRIVE, DT, 0.01, random)
    for _ in range(2000):
        train.step(SideSpeeds(0.5, 0.5))
    moving = len(drawn)
    train.stop()
    for _ in range(100):
        train.step(STOPPED)

    way = train.angles()[0] * DRIVE.wheel_radius
    assert moving == 2001  # the start's too
    assert len(drawn) == moving + 1
    assert train.odometry_pose()[0] - way == pytest.approx(
        0.01 / math.sqrt(DT) * math.sqrt(0.5) * 2000 * DT, rel=0.05
    )
