"""Topics and frames that a simulator has left go when another one comes; slashes may be missing."""

from dataclasses import replace

import pytest
from fixtures.gui import FakeSource

from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness
from lcmtools.gui.source import topic_named
from lcmtools.gui.streams.topics import current_rows
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow

SECOND = 1_000_000_000
NOW = 1_000 * SECOND
CLOCK = Endpoint("/clock", Role.PUBLISHER, ("rosgraph_msgs/Clock",))
STEP = Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step",))
SIMULATOR = Node("/sim", "s", "here", 7, NOW - 10 * SECOND, endpoints=(CLOCK, STEP))
OLD = ChannelRow("/husky0/odometry", ("nav_msgs/Odometry",), age=20.0)


def publisher(stale=Staleness.NOT):
    return Node(
        "/p", "p", "here", 8, endpoints=(Endpoint(OLD.channel, Role.PUBLISHER),), stale=stale
    )


@pytest.mark.parametrize(
    ("row", "nodes", "is_kept"),
    [
        (OLD, (SIMULATOR,), False),
        (OLD, (), True),  # there is no other one
        (OLD, (SIMULATOR, publisher()), True),
        (OLD, (SIMULATOR, publisher(Staleness.ENDED)), False),
        (replace(OLD, age=5.0), (SIMULATOR,), True),
        (replace(OLD, age=None), (SIMULATOR,), True),
        (replace(OLD, listeners=("/ear",)), (SIMULATOR,), True),
    ],
)
def test_a_topic_that_a_simulator_has_left_goes_with_the_next_one(row, nodes, *, is_kept):
    latest = Snapshot((row,), graph=Graph(nodes, time=NOW))
    assert current_rows(latest) == [row][:is_kept]


@pytest.mark.parametrize(
    ("text", "topic"), [("a", "/a"), ("/a", "/a"), ("b", "b"), ("A", "A"), ("", "")]
)
def test_a_missing_slash_is_added_unless_a_channel_is_named_so(text, topic):
    source = FakeSource()
    source.know(a=None)
    source.latest = Snapshot((*source.latest.rows, ChannelRow("A"), ChannelRow("/A")))
    assert topic_named(source, text) == topic
