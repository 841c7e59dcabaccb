"""When a connection that is lost is tried again."""

import pytest

from lcmtools.bus.reconnect import ReconnectBackoff


def test_there_is_nothing_to_wait_for_without_an_outage() -> None:
    outage = ReconnectBackoff()
    assert not outage.is_on
    assert outage.left(5.0) is None


def test_each_attempt_waits_twice_as_long_up_to_two_seconds() -> None:
    outage, now, pauses = ReconnectBackoff(), 10.0, []
    outage.begin(now)
    for _ in range(6):
        left = outage.left(now)
        assert left is not None
        pauses.append(round(left, 3))
        now += left
        assert outage.left(now) == 0.0
        outage.put_off(now)
    assert pauses == [0.2, 0.4, 0.8, 1.6, 2.0, 2.0]


def test_the_next_outage_begins_with_short_pauses_again() -> None:
    outage = ReconnectBackoff()
    outage.begin(0.0)
    outage.put_off(1.0)
    outage.end()
    assert not outage.is_on
    outage.begin(2.0)
    assert outage.left(2.0) == pytest.approx(0.2)
