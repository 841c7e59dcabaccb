"""Streams of large messages, and the last messages of channels."""

import pytest

from lcmtools.observe.reading.large_messages import LargeStreams
from lcmtools.wire.packet import Packet

_SECOND = 1_000_000_000  # [ns]
_ALL = 0xFFFFFFFF


def _packet(channel, size, time=0.0):
    return Packet(channel, bytes(size), round(time * _SECOND))


@pytest.mark.parametrize(
    ("times", "limit"),
    [([0.0], _ALL), ([0, 1, 2, 3, 4, 5], _ALL), ([0, 0.1, 0.2, 0.3], 99_999)],
)
def test_only_what_streams_is_dropped(times, limit):
    streams = LargeStreams()
    for time in times:
        streams.add(_packet("/camera", 100_000, time))
    assert streams.limit(round(times[-1] * _SECOND)) == limit


def test_a_stream_is_looked_at_again():
    streams = LargeStreams()
    for number in range(10):
        streams.add(_packet("/camera", 100_000, number / 10))
    assert streams.limit(2 * _SECOND) < 100_000
    assert streams.limit(60 * _SECOND) == _ALL
