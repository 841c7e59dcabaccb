"""The rates that a full line takes, from counts of messages."""

import pytest

from lcmtools.graph.full_line import LineRates, NodeLines
from lcmtools.graph.model import Endpoint, FullLine, Role

_IMAGE = "/camera/image"


def _rates(*counts):
    """Update with times, and messages of a channel that passed and that were dropped."""
    line, found = LineRates(), {}
    for now, passed, dropped in counts:
        found = line.update({_IMAGE: passed, "/odom": 100}, {_IMAGE: dropped}, now)
    return found


@pytest.mark.parametrize(
    ("counts", "expected"),
    [
        ([(0, 0, 0)], {}),
        ([(0, 0, 0), (0.5, 2, 9)], {}),  # too soon to tell
        ([(0, 0, 0), (2, 8, 50)], {_IMAGE: 4.0}),
        ([(0, 0, 0), (2, 8, 0)], {}),  # nothing was dropped
        ([(0, 0, 9), (2, 8, 9)], {}),  # what was dropped before
        ([(0, 0, 0), (2, 0, 50)], {_IMAGE: 0.0}),
        ([(0, 0, 0), (5, 10, 9), (10, 20, 9), (11, 22, 9)], {}),  # longer ago than some seconds
        ([(0, 50, 90), (2, 8, 9)], {}),  # counts were forgotten in a flood of channels
    ],
)
def test_channels_that_lose_messages_have_the_rate_that_passes(counts, expected):
    assert _rates(*counts) == expected


def test_a_flood_of_channels_is_cut_to_those_that_lose_most():
    line = LineRates()
    line.update({}, {}, 0.0)
    dropped = {f"/{number}": number for number in range(100)}
    assert list(line.update({}, dropped, 2.0)) == [f"/{number}" for number in range(99, 89, -1)]


def test_a_node_tells_of_what_it_publishes_itself():
    def update(to, messages, dropped, now):
        ends = [Endpoint(_IMAGE, Role.PUBLISHER, messages=messages)]
        ends.append(Endpoint("/odom", Role.SUBSCRIBER, messages=100))
        return line.update(ends, (to, {_IMAGE: dropped, "/odom": 7} if dropped else {}), now)

    line = NodeLines()
    assert update("", 10, 0, 0.0) == ()
    assert update("10.0.0.2", 40, 20, 1.0) == ()
    assert update("10.0.0.2", 100, 70, 3.0) == (FullLine("10.0.0.2", 70, ((_IMAGE, 5.0),)),)
    assert update("", 160, 70, 5.0) == ()  # nobody is connected: all seems to pass
    assert update("10.0.0.2", 220, 75, 7.0) == ()
    assert update("10.0.0.2", 280, 125, 9.0) == (FullLine("10.0.0.2", 125, ((_IMAGE, 5.0),)),)
