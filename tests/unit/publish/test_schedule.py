"""When messages are sent, by options and by where the messages come from."""

import math

import pytest

from lcmtools.errors import UsageError
from lcmtools.publish import schedule as module
from lcmtools.publish.incoming import Incoming
from lcmtools.publish.schedule import Schedule, due_times, schedule_for

VALUES = Incoming(iter([]), is_one=True)
ONE_IN_A_FILE = Incoming(iter([]), is_file=True, is_one=True)
FILE = Incoming(iter([]), is_file=True)
STREAM = Incoming(iter([]))


@pytest.mark.parametrize(
    ("options", "incoming", "schedule"),
    [
        ({}, VALUES, Schedule(stay=math.inf)),
        ({}, ONE_IN_A_FILE, Schedule(rate=10.0, is_endless=True)),
        ({}, FILE, Schedule(rate=10.0)),
        ({}, STREAM, Schedule()),
        ({"rate": 5.0}, VALUES, Schedule(rate=5.0, is_endless=True)),
        ({"rate": 5.0}, ONE_IN_A_FILE, Schedule(rate=5.0, is_endless=True)),
        ({"rate": 5.0}, FILE, Schedule(rate=5.0)),
        ({"rate": 5.0}, STREAM, Schedule(rate=5.0)),
        ({"count": 1}, VALUES, Schedule(rate=1.0, count=1)),
        ({"count": 1, "latch": True, "keep_alive": 0.0}, VALUES, Schedule(rate=1.0, count=1)),
        ({"count": 1, "keep_alive": 3.0}, VALUES, Schedule(rate=1.0, count=1, stay=3.0)),
        ({"count": 1}, STREAM, Schedule(count=1)),
        ({"count": 3}, VALUES, Schedule(rate=1.0, count=3)),
        ({"count": 3, "rate": 5.0}, VALUES, Schedule(rate=5.0, count=3)),
        ({"count": 3}, FILE, Schedule(rate=10.0, count=3)),
        ({"count": 3}, STREAM, Schedule(count=3)),
        ({"latch": True}, ONE_IN_A_FILE, Schedule(rate=10.0, stay=math.inf)),
        ({"latch": True}, FILE, Schedule(rate=10.0, stay=math.inf)),
        ({"latch": True}, STREAM, Schedule(stay=math.inf)),
        (
            {"latch": True, "rate": 5.0},
            VALUES,
            Schedule(rate=5.0, is_endless=True, stay=math.inf),
        ),
        ({"keep_alive": 3.0}, VALUES, Schedule(stay=3.0)),
    ],
)
def test_options_and_source_decide_when_to_send(options, incoming, schedule):
    assert schedule_for(incoming, **options) == schedule


@pytest.mark.parametrize(
    "options", [{"rate": 0.0}, {"rate": -5.0}, {"rate": math.nan}, {"count": 0}, {"count": -1}]
)
def test_rates_and_counts_are_positive(options):
    with pytest.raises(UsageError, match=f"got {next(iter(options.values()))}"):
        schedule_for(VALUES, **options)


class Time:
    """A clock that passes by sleeping."""

    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        """Read it [s]."""
        return self.now


def due(monkeypatch, rate, most_behind, takes):
    """The times at which messages are due, where sending each takes so long [s]."""
    clock = Time()
    monkeypatch.setattr(module, "time", clock)
    found = []
    for one, seconds in zip(due_times(rate, most_behind), takes, strict=False):
        clock.now = max(clock.now, one)
        found.append(round(one - 100.0, 3))
        clock.now += seconds
    return found


def test_a_short_delay_is_made_up_for_and_a_long_one_is_not(monkeypatch):
    assert due(monkeypatch, 10.0, 0.1, [0.15, 0.0, 0.0]) == [0.0, 0.1, 0.2]
    assert due(monkeypatch, 10.0, 0.1, [1.0, 0.0, 0.0, 0.0]) == [0.0, 1.0, 1.1, 1.2]
    assert due(monkeypatch, 10.0, 0.0, [0.15, 0.0, 0.0]) == [0.0, 0.15, 0.25]
