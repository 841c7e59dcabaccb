"""The clock that hz, bw and delay go by."""

import pytest

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.arrivals import (
    ArrivalClock,
    Batch,
    SelectedPacket,
    taken,
    taken_together,
)
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.wire.packet import Packet


def _tick(seconds):
    message = Clock()
    message.clock.sec = seconds
    return Packet(CLOCK_TOPIC, encode(message), 99)


def test_real_time_is_a_packets_own():
    clock = ArrivalClock(is_simulated=False)
    assert not clock.update(_tick(5))
    assert clock.time(Packet("/a", b"", 7)) == 7


def test_simulated_time_is_what_the_clock_last_said():
    clock = ArrivalClock(is_simulated=True)
    assert clock.time(Packet("/a", b"", 7)) is None
    clock.update(_tick(5))
    clock.update(Packet(CLOCK_TOPIC, b"noise", 8))
    assert clock.time(Packet("/a", b"", 9)) == 5_000_000_000


def test_simulated_time_that_goes_back_is_noticed():
    clock = ArrivalClock(is_simulated=True)
    assert [clock.update(_tick(seconds)) for seconds in (5, 6, 6, 1, 2)] == [
        False,
        False,
        False,
        True,
        False,
    ]


class _Batches:
    """A stream whose arrivals, at these times, come in these batches; then it ends."""

    text = "/a"

    def __init__(self, *batches):
        self._batches = list(batches)

    def receive(self, _):
        if not self._batches:
            raise EOFError
        times = self._batches.pop(0)
        return Batch([SelectedPacket("/a", Packet("/a", b"", time), time) for time in times], 0)

    def silent(self):
        return []


def _stream(*batches):
    return _Batches(*batches)


def _even(found):
    if found.time > 90:
        raise ValueMismatch("too late")
    return found.time if found.time % 2 == 0 else None


def test_results_of_packets_that_arrived_together_come_together():
    stream = _stream([2, 4, 5, 6], [7], [8], [10, 12])
    assert list(taken_together(stream, _even, None, most=2)) == [[2, 4], [6], [8], [10, 12]]
    assert list(taken(_stream([2, 3], [4]), _even, None)) == [2, 4]


def test_what_came_before_an_error_is_not_lost():
    results = taken_together(_stream([2, 4, 99]), _even, None, most=8)
    assert next(results) == [2, 4]
    with pytest.raises(ValueMismatch):
        next(results)
