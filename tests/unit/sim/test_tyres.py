"""Tyres as mathematics: two ideal wheels, and four that skid."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools_sim.drive import STOPPED, SideSpeeds, body_velocity
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.tyres import Tyres, gripping, skidding

NO_LIMIT = 1e9  # [N s]
LIMIT = 0.9  # [N s] of a side
TRACK = HUSKY.drive.track
MASS, INERTIA = HUSKY.body.mass, HUSKY.body.inertia[2]
LEVER = max(math.hypot(*wheel) for wheel in HUSKY.drive.wheels)  # [m] of the farthest wheel

KINDS = {"gripping": (gripping(HUSKY), TRACK / 2), "skidding": (skidding(HUSKY), LEVER)}
"""Tyres, and how far from the middle their pull can be at most [m]."""

both_kinds = pytest.mark.parametrize(("tyres", "lever"), KINDS.values(), ids=KINDS)
speeds = st.floats(-3, 3)
rates = st.floats(-5, 5)
velocities = st.tuples(speeds, speeds, rates)


@given(speeds, speeds, rates, speeds, speeds)
def test_tyres_that_do_not_slip_make_the_body_move_as_the_wheels_do(
    forward: float, sideways: float, turn_rate: float, left: float, right: float
) -> None:
    wheels = SideSpeeds(left, right)

    change = gripping(HUSKY)(forward, sideways, turn_rate, wheels, NO_LIMIT)

    wanted = body_velocity(wheels, TRACK)
    after = forward + change[0], sideways + change[1], turn_rate + change[2]
    assert after == pytest.approx((wanted[0], 0.0, wanted[1]), abs=1e-9)


@given(speeds, speeds, rates, speeds, speeds)
def test_a_little_less_friction_than_is_needed_changes_little(
    forward: float, sideways: float, turn_rate: float, left: float, right: float
) -> None:
    """Both ways of working it out, with slip and without, meet where slip begins."""
    wheels, before = SideSpeeds(left, right), (forward, sideways, turn_rate)
    wanted = body_velocity(wheels, TRACK)
    along = abs(MASS / 2 * (wanted[0] - forward)) + abs(INERTIA / TRACK * (wanted[1] - turn_rate))
    needed = math.hypot(along, MASS / 2 * sideways)
    tyres = gripping(HUSKY)

    enough = tyres(*before, wheels, needed * (1 + 1e-9))
    short = tyres(*before, wheels, needed * (1 - 1e-9))

    assert enough == pytest.approx(short, abs=1e-6)


@both_kinds
@given(velocities, st.builds(SideSpeeds, speeds, speeds))
def test_tyres_give_no_more_than_friction_allows(
    tyres: Tyres, lever: float, before: tuple[float, float, float], wheels: SideSpeeds
) -> None:
    change = tyres(*before, wheels, LIMIT)

    assert math.hypot(change[0], change[1]) * MASS <= 2 * LIMIT * (1 + 1e-9)
    assert abs(change[2]) * INERTIA <= 2 * LIMIT * lever * (1 + 1e-9)


@pytest.mark.parametrize("tyres", [tyres for tyres, _ in KINDS.values()], ids=KINDS)
@given(velocities)
def test_tyres_of_standing_wheels_only_take_energy_away(
    tyres: Tyres, before: tuple[float, float, float]
) -> None:
    def energy(forward: float, sideways: float, turn_rate: float) -> float:
        return MASS * (forward**2 + sideways**2) / 2 + INERTIA * turn_rate**2 / 2

    change = tyres(*before, STOPPED, LIMIT)
    after = tuple(a + b for a, b in zip(before, change, strict=True))

    assert energy(*after) <= energy(*before) + 1e-12
