"""Timers stay on their grid, and skip what they have missed."""

import pytest
from fixtures.says import assert_says, raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.errors import UsageError
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.timer import Timer

_S = 1_000_000_000


def _at(now):
    """A clock that stands."""
    return lambda: now


def _calls(timer, times):
    """The times at which a timer that is looked at then calls."""
    called = []
    for time in times:
        now = round(time * _S)
        if timer.is_due(now):
            timer.advance(now)
            called.append(time)
    return called


def test_a_timer_calls_one_period_after_its_creation():
    timer = Timer(0.5, print, _at(10 * _S))
    assert timer.remaining(10 * _S) == 0.5
    assert _calls(timer, [10.0, 10.49, 10.5, 10.51, 11.0]) == [10.5, 11.0]


def test_a_late_call_does_not_delay_the_next():
    assert _calls(Timer(1.0, print, _at(0)), [1.3, 1.9, 2.0, 2.9, 3.4, 3.99, 4.0]) == [
        1.3,
        2.0,
        3.4,
        4.0,
    ]


def test_periods_that_were_missed_are_skipped():
    timer = Timer(1.0, print, _at(0))
    assert _calls(timer, [5.5, 5.6, 5.99, 6.0]) == [5.5, 6.0]


def test_a_timer_does_not_drift():
    """10 000 calls, each up to 3 ms late: the last is due on the first one's grid."""
    timer, now = Timer(0.01, print, _at(7)), 7
    for call in range(10_000):
        now = 7 + (call + 1) * 10_000_000 + (call * 7919) % 3_000_000
        assert timer.is_due(now)
        timer.advance(now)
    assert timer.remaining(now) == pytest.approx((7 + 10_001 * 10_000_000 - now) / _S)


def test_a_third_of_a_second_is_kept_to_the_nanosecond():
    timer = Timer(1 / 3, print, _at(0))
    assert timer.period == 333_333_333


@pytest.mark.parametrize("seconds", [0, 0.0, -1, float("nan"), float("inf"), -float("inf")])
def test_a_period_that_is_none_is_refused(begin, seconds):
    begin()
    with raises_saying(UsageError, "period", "positive"):
        Node("a").create_timer(seconds, print)


def test_a_cancelled_timer_calls_no_more_until_it_is_reset():
    now = [0]
    timer = Timer(1.0, print, lambda: now[0])
    timer.cancel()
    assert timer.remaining(0) is None
    assert not timer.is_due(100 * _S)
    now[0] = 100 * _S
    timer.reset()
    assert _calls(timer, [100.9, 101.0]) == [101.0]


def test_a_timer_starts_anew_when_time_is_set_back():
    timer = Timer(1.0, print, _at(1000 * _S))
    assert _calls(timer, [1001.0, 3.0, 3.9, 4.0, 5.0]) == [1001.0, 4.0, 5.0]


def test_a_timer_is_late_never_early_when_time_jumps_ahead():
    assert _calls(
        Timer(1.0, print, _at(0)), [1_700_000_000.25, 1_700_000_000.9, 1_700_000_001.0]
    ) == [
        1_700_000_000.25,
        1_700_000_001.0,
    ]


@pytest.fixture
def clock(monkeypatch):
    """The monotonic clock of nodes: one number that a test sets [ns]."""
    now = [0]
    monkeypatch.setattr(Callbacks, "time", lambda _callbacks: now[0])
    return now


def test_a_node_calls_its_timers_when_they_are_due(begin, clock):
    begin()
    node, called = Node("a"), []
    node.create_timer(1.0, lambda: called.append("slow"))
    node.create_timer(0.5, lambda: called.append("fast"))
    assert node.callbacks.time_to_timer() == 0.5
    for tenth in range(21):
        clock[0] = tenth * _S // 10
        lcmtools.spin_once(node)
    assert called == ["fast", "slow", "fast", "fast", "slow", "fast"]


def test_a_timer_that_raises_is_logged_and_called_again(begin, clock, capsys):
    begin()
    node = Node("a")
    node.create_timer(1.0, lambda: 1 / 0)
    for second in (1, 2):
        clock[0] = second * _S
        lcmtools.spin_once(node)
    log = capsys.readouterr().err
    assert log.count("[ERROR]") == 1
    assert node.describe().errors[0].count == 2
    assert_says(log, "timer 1 s", "ZeroDivisionError: division by zero")
    assert "Traceback" in log


def test_a_timer_may_cancel_itself(begin, clock):
    begin()
    node, called = Node("a"), []

    def once():
        called.append(1)
        timer.cancel()

    timer = node.create_timer(1.0, once)
    for second in range(5):
        clock[0] = second * _S
        lcmtools.spin_once(node)
    assert called == [1]
    assert node.callbacks.time_to_timer() is None


def test_a_destroyed_timer_calls_no_more_though_it_was_due(begin, clock):
    begin()
    node, called = Node("a"), []
    first = node.create_timer(1.0, lambda: node.destroy_timer(second))
    second = node.create_timer(1.0, lambda: called.append(1))
    clock[0] = 2 * _S
    lcmtools.spin_once(node)
    assert not called
    assert node.callbacks.timers == [first]
    node.destroy_timer(second)


def test_a_timer_wakes_a_waiting_node_in_time(begin):
    begin()
    node, called = Node("a"), []
    node.create_timer(0.01, lambda: called.append(1))
    lcmtools.spin_once(node, 5.0)
    assert called == [1]
