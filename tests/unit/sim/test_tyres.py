"""Tyres as mathematics: two ideal wheels, and four that skid."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools_sim.arithmetic import ARRAYS, FLOATS
from lcmtools_sim.drive import body_velocity
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.tyres import gripping, skidding

NO_LIMIT = 1e9  # [N s]
LIMIT = 0.9  # [N s] of a side
TRACK = HUSKY.drive.track
MASS, INERTIA = HUSKY.body.mass, HUSKY.body.inertia[2]
LEVER = max(math.hypot(*wheel) for wheel in HUSKY.drive.wheels)  # [m] of the farthest wheel

WHEELS = HUSKY.drive.wheels
GRIPPING = gripping(MASS, INERTIA, TRACK, FLOATS)
KINDS = {
    "gripping": (GRIPPING, TRACK / 2),
    "skidding": (skidding(MASS, INERTIA, WHEELS, FLOATS), LEVER),
}
"""Tyres, and how far from the middle their pull can be at most [m]."""

both_kinds = pytest.mark.parametrize(("tyres", "lever"), KINDS.values(), ids=KINDS)
speeds = st.floats(-3, 3)
rates = st.floats(-5, 5)
velocities = st.tuples(speeds, speeds, rates)


@given(speeds, speeds, rates, speeds, speeds)
def test_tyres_that_do_not_slip_make_the_body_move_as_the_wheels_do(
    forward, sideways, turn_rate, left, right
):
    change = GRIPPING(forward, sideways, turn_rate, left, right, NO_LIMIT)
    wanted = body_velocity(left, right, TRACK)
    after = forward + change[0], sideways + change[1], turn_rate + change[2]
    assert after == pytest.approx((wanted[0], 0.0, wanted[1]), abs=1e-9)


@given(speeds, speeds, rates, speeds, speeds)
def test_a_little_less_friction_than_is_needed_changes_little(
    forward, sideways, turn_rate, left, right
):
    """Both ways of working it out, with slip and without, meet where slip begins."""
    before = forward, sideways, turn_rate
    wanted = body_velocity(left, right, TRACK)
    along = abs(MASS / 2 * (wanted[0] - forward)) + abs(INERTIA / TRACK * (wanted[1] - turn_rate))
    needed = math.hypot(along, MASS / 2 * sideways)
    enough = GRIPPING(*before, left, right, needed * (1 + 1e-9))
    short = GRIPPING(*before, left, right, needed * (1 - 1e-9))
    assert enough == pytest.approx(short, abs=1e-6)


@both_kinds
@given(velocities, st.tuples(speeds, speeds))
def test_tyres_give_no_more_than_friction_allows(tyres, lever, before, wheels):
    change = tyres(*before, *wheels, LIMIT)
    assert math.hypot(change[0], change[1]) * MASS <= 2 * LIMIT * (1 + 1e-9)
    assert abs(change[2]) * INERTIA <= 2 * LIMIT * lever * (1 + 1e-9)


@pytest.mark.parametrize("tyres", [tyres for tyres, _ in KINDS.values()], ids=KINDS)
@given(velocities)
def test_tyres_of_standing_wheels_only_take_energy_away(tyres, before):
    def energy(forward, sideways, turn_rate):
        return MASS * (forward**2 + sideways**2) / 2 + INERTIA * turn_rate**2 / 2

    change = tyres(*before, 0.0, 0.0, LIMIT)
    after = tuple(a + b for a, b in zip(before, change, strict=True))
    assert energy(*after) <= energy(*before) + 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_tyres_of_many_robots_pull_as_those_of_each(kind):
    random = np.random.default_rng(3)
    masses, inertias = random.uniform(20, 80, 50), random.uniform(1, 5, 50)
    values = random.uniform(-2, 2, (5, 50))
    limits = random.uniform(0, 2, 50)

    def made(mass, inertia, ops):
        if kind == "gripping":
            return gripping(mass, inertia, TRACK, ops)
        return skidding(mass, inertia, WHEELS, ops)

    together = made(masses, inertias, ARRAYS)(*values, limits)
    for i in range(50):
        alone = made(float(masses[i]), float(inertias[i]), FLOATS)(
            *values[:, i].tolist(), limits[i]
        )
        assert [float(column[i]) for column in together] == pytest.approx(alone, rel=1e-12)
