"""Which step publishes what, and at which moment a step may run."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lcmtools_sim.schedule import MAX_DEBT, Pacer, Timetable


def due_steps(rate, dt, steps):
    timetable = Timetable(dt)
    timetable.add(rate, "sensor")
    return [step for step in range(1, steps + 1) if timetable.due(step)]


def items_due(timetable, *steps):
    return [timetable.items(timetable.due(step)) for step in steps]


def test_a_rate_that_divides_the_steps_comes_evenly():
    assert due_steps(80, 1 / 240, 12) == [3, 6, 9, 12]


def test_50_hz_on_240_hz_takes_the_first_step_at_or_after_each_moment():
    assert due_steps(50, 1 / 240, 48) == [5, 10, 15, 20, 24, 29, 34, 39, 44, 48]


def test_a_rate_above_that_of_the_steps_comes_with_every_step():
    assert due_steps(1000, 1 / 240, 5) == [1, 2, 3, 4, 5]


@given(st.integers(1, 240), st.sampled_from([1 / 240, 1 / 1000, 0.01, 0.0041666667]))
def test_the_number_of_times_is_exact_over_any_whole_second(rate, dt):
    assume(rate * dt <= 1)
    steps = due_steps(rate, dt, round(3 / dt))
    assert abs(len(steps) - 3 * rate) <= (0 if dt != 0.0041666667 else 1)
    assert all(
        step * dt >= count / rate * (1 - 1e-9) and (step - 1) * dt < count / rate
        for count, step in enumerate(steps, 1)
    )


def test_a_rate_does_not_drift_in_a_day():
    timetable = Timetable(1 / 240)
    assert timetable._count(240 * 86_400, 50) == 50 * 86_400
    assert timetable._count(240 * 86_400 - 1, 50) == 50 * 86_400 - 1


def test_items_due_together_come_in_the_order_of_adding():
    timetable = Timetable(0.01)
    for name in ("c", "a", "b"):
        timetable.add(50, name)
    assert items_due(timetable, 1, 2, 4) == [[], ["c", "a", "b"], ["c", "a", "b"]]


class Wall:
    """A wall clock that moves by sleeping and by hand."""

    def __init__(self):
        self.now = 100.0
        self.slept = []

    def sleep(self, seconds):
        """Let the time pass."""
        self.slept.append(seconds)
        self.now += seconds


def nothing():
    """There is nothing to do meanwhile."""


def pacer(wall, period):
    return Pacer(period, now=lambda: wall.now, sleep=wall.sleep)


def test_steps_in_time_sleep_until_their_moment():
    wall = Wall()
    pace = pacer(wall, 0.01)
    for _ in range(100):
        wall.now += 0.002  # what the step cost
        assert pace.wait(lambda: True, nothing) == 0
    assert wall.now == pytest.approx(101.0)


def test_a_late_step_is_made_good_by_the_next_without_sleeping():
    wall = Wall()
    pace = pacer(wall, 0.01)
    wall.now += 0.035
    assert [pace.wait(lambda: True, nothing) for _ in range(3)] == [0, 0, 0]
    assert wall.slept == []
    pace.wait(lambda: True, nothing)
    assert wall.now == pytest.approx(100.04)


def test_a_debt_above_the_limit_is_dropped_and_returned():
    wall = Wall()
    pace = pacer(wall, 0.01)
    wall.now += 1.0
    assert pace.wait(lambda: True, nothing) == pytest.approx(0.99)
    pace.wait(lambda: True, nothing)
    assert wall.now == pytest.approx(101.01)
    assert MAX_DEBT < 0.99


def test_a_period_of_zero_never_waits():
    wall = Wall()
    pace = pacer(wall, 0.0)
    assert [pace.wait(lambda: True, nothing) for _ in range(5)] == [0] * 5
    assert wall.slept == []


def test_waiting_ends_soon_after_the_request():
    wall = Wall()
    pacer(wall, 60.0).wait(lambda: wall.now < 100.25, nothing)
    assert wall.now < 100.4


def test_what_must_not_wait_is_seen_to_while_the_next_step_is_far_away():
    wall, seen = Wall(), []
    pace = pacer(wall, 1.0)
    pace.wait(lambda: True, lambda: seen.append(wall.now))
    assert len(seen) >= 9
    assert wall.now == pytest.approx(101.0)


def test_nothing_is_done_meanwhile_where_steps_follow_each_other():
    wall, seen = Wall(), []
    pacer(wall, 0.01).wait(lambda: True, lambda: seen.append(wall.now))
    assert seen == []


def test_items_that_come_and_go_leave_the_others_in_their_rhythm_and_order():
    timetable = Timetable(0.01)
    for name, rate in (("a", 50), ("b", 25), ("c", 50)):
        timetable.add(rate, name)
    assert items_due(timetable, 1, 2, 3, 4) == [[], ["a", "c"], [], ["a", "b", "c"]]
    timetable.remove(["a", "b"])
    timetable.add(25, "d", after=4)
    timetable.add(50, "e", after=4)
    assert items_due(timetable, 5, 6, 7, 8) == [[], ["c", "e"], [], ["c", "d", "e"]]


def test_a_rate_that_comes_late_keeps_to_the_same_moments():
    early = Timetable(1 / 240)
    late = Timetable(1 / 240)
    early.add(50, "early")
    late.add(50, "late", after=100)
    both = [(bool(early.due(step)), bool(late.due(step))) for step in range(1, 400)]
    assert all(first == second for first, second in both[100:])
    assert not any(second for _, second in both[:100])
