"""The duration of calls, by a clock that the tests move."""

import pytest

from lcmtools.node.stopwatch import Stopwatch


@pytest.fixture
def move(monkeypatch):
    """``move(5)``: five nanoseconds pass."""
    now = [1_000]
    monkeypatch.setattr("lcmtools.node.stopwatch.time.monotonic_ns", lambda: now[0])

    def pass_by(nanoseconds):
        now[0] += nanoseconds

    return pass_by


def _state(stopwatch):
    return stopwatch.calls, stopwatch.busy(), stopwatch.longest()


def test_calls_their_sum_and_the_longest_are_counted(move):
    stopwatch = Stopwatch()
    assert _state(stopwatch) == (0, 0, 0)
    for took in (5, 30, 10):
        with stopwatch:
            move(took)
        move(1000)  # between calls nothing counts
    assert _state(stopwatch) == (3, 45, 30)


def test_a_call_that_runs_counts_as_far_as_it_has_come(move):
    stopwatch = Stopwatch()
    with stopwatch:
        move(7)
    with stopwatch:
        move(50)
        assert _state(stopwatch) == (2, 57, 50)
    assert _state(stopwatch) == (2, 57, 50)


def test_a_call_that_fails_counts(move):
    stopwatch = Stopwatch()

    def fail():
        with stopwatch:
            move(9)
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert _state(stopwatch) == (1, 9, 9)


def test_time_in_a_call_within_a_call_counts_once(move):
    stopwatch = Stopwatch()
    with stopwatch:
        move(10)
        with stopwatch:
            move(4)
        assert stopwatch.busy() == 14
    assert _state(stopwatch) == (2, 14, 14)
