"""When a service is asked again."""

import itertools

import pytest

from lcmtools.publish import calls, schedule


class Time:
    """A clock that passes by sleeping."""

    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        """Read it [s]."""
        return self.now

    def sleep(self, seconds):
        """Let time pass [s]."""
        self.now += seconds


@pytest.fixture
def time(monkeypatch):
    """Put in place of the computer's."""
    clock = Time()
    for module in (calls, schedule):
        monkeypatch.setattr(module, "time", clock)
    return clock


def asked(time, *, rate, times, answer=0.0):
    """The requests and their times, from the first on; each answer takes so long [s]."""
    found = []
    for request in itertools.islice(calls.requests_in_time(["a", "b"], rate, times), 5):
        found.append((request, round(time.now - 100.0, 3)))
        time.now += answer
    return found


def test_each_request_goes_once_where_nothing_is_said(time):
    assert asked(time, rate=None, times=None, answer=2.0) == [("a", 0.0), ("b", 2.0)]


def test_requests_are_repeated_in_turn(time):
    found = asked(time, rate=2.0, times=None, answer=0.1)
    assert found == [("a", 0.0), ("b", 0.5), ("a", 1.0), ("b", 1.5), ("a", 2.0)]


def test_so_many_go_once_a_second(time):
    assert asked(time, rate=None, times=3) == [("a", 0.0), ("b", 1.0), ("a", 2.0)]


def test_a_slow_service_is_not_asked_in_bursts(time):
    requests = calls.requests_in_time(["a"], 10.0, 4)
    starts = []
    for answer in (1.0, 0.0, 0.0, 0.0):
        next(requests)
        starts.append(round(time.now - 100.0, 3))
        time.now += answer
    assert starts == [0.0, 1.0, 1.1, 1.2]
