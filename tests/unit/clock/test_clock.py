"""Time as integer nanoseconds."""

import time

import pytest

from lcmtools.clock import ManualClock, SystemClock, join_stamp, split_stamp


@pytest.mark.parametrize(
    ("nanoseconds", "stamp"),
    [
        (0, (0, 0)),
        (999_999_999, (0, 999_999_999)),
        (1_000_000_000, (1, 0)),
        (1_700_000_000_123_456_789, (1_700_000_000, 123_456_789)),
        (-1, (-1, 999_999_999)),
    ],
)
def test_a_stamp_splits_and_joins_without_loss(nanoseconds, stamp):
    assert split_stamp(nanoseconds) == stamp
    assert join_stamp(*stamp) == nanoseconds


def test_a_manual_clock_stands_until_it_is_set():
    clock = ManualClock(5)
    assert clock.now() == 5
    assert clock.now() == 5
    clock.set(3)
    assert clock.now() == 3


def test_the_system_clock_is_the_computers():
    before = time.time_ns()
    now = SystemClock().now()
    assert before <= now <= time.time_ns()
