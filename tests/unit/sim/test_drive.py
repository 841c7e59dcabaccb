"""Motors and dead reckoning as mathematics."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools_sim.arithmetic import FLOATS
from lcmtools_sim.drive import body_velocity, dead_reckoning, followed, side_speeds
from lcmtools_sim.robots.husky import HUSKY

DT = 1 / 240
DRIVE = HUSKY.drive

STOPPED = (0.0, 0.0)

speeds = st.floats(-3, 3)


def follow(now, targets, dt=DT):
    """The speeds of a Husky's motors one step later."""
    gain = dt / (DRIVE.time_constant + dt)
    return followed(now, targets, gain, DRIVE.max_acceleration * dt, FLOATS)


def motor_speed_after(seconds, target, dt=DT):
    now = STOPPED
    for _ in range(round(seconds / dt)):
        now = follow(now, (target, target), dt)
    return now[0]


def test_a_motor_at_full_effort_comes_within_half_a_percent_in_two_seconds():
    assert motor_speed_after(2.0, 1.0) == pytest.approx(1.0, rel=0.005)


def test_a_motor_follows_a_small_step_with_its_time_constant():
    # Below the acceleration limit it is a first-order lag: 63.2 % after one time constant.
    speed = motor_speed_after(0.15, 0.1, dt=1e-4)
    assert speed / 0.1 == pytest.approx(1 - math.exp(-1), abs=0.001)


def test_a_motor_never_accelerates_above_the_limit():
    after = follow(STOPPED, (1.0, 1.0))
    assert after[0] / DT == pytest.approx(3.0)


def test_a_motor_reaches_standstill_exactly():
    now = (1.0, -0.5)
    for _ in range(240 * 4):
        now = follow(now, STOPPED)
    assert now == (0.0, 0.0)


@given(speeds, speeds)
def test_the_limit_keeps_the_proportion_of_the_sides(left, right):
    after = follow(STOPPED, (left, right))
    assert after[0] * right == pytest.approx(after[1] * left, abs=1e-12)


@given(st.floats(-1, 1), st.floats(-2, 2))
def test_side_speeds_and_body_velocity_are_inverse(forward, turn_rate):
    there_and_back = body_velocity(*side_speeds(forward, turn_rate, DRIVE), DRIVE.track)
    assert there_and_back == pytest.approx((forward, turn_rate), abs=1e-12)


def test_the_effective_track_of_a_husky_is_the_one_of_the_text():
    assert DRIVE.track == pytest.approx(1.07025)
    assert body_velocity(-1, 1, DRIVE.track)[1] == pytest.approx(1.87, abs=0.005)


def reckoned(steps, distance, half_turn):
    pose = 0.0, 0.0, 0.0
    for _ in range(steps):
        pose = dead_reckoning(pose, distance, half_turn, FLOATS)
    return pose


def test_dead_reckoning_closes_a_circle():
    # Twist (0.5, 0.3): radius 1.6667 m, period 20.944 s.
    dt = 2 * math.pi / 0.3 / 5000
    x, y, yaw = reckoned(5000, 0.5 * dt, 0.3 * dt / 2)
    assert (x, y) == pytest.approx((0, 0), abs=1e-9)
    assert yaw == pytest.approx(2 * math.pi)


def test_dead_reckoning_is_half_a_circle_away_after_half_the_time():
    dt = math.pi / 0.3 / 5000
    x, y, _ = reckoned(5000, 0.5 * dt, 0.3 * dt / 2)
    assert (x, y) == pytest.approx((0, 2 * 0.5 / 0.3), abs=1e-6)
