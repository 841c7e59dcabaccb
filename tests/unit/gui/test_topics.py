"""Topics on the bus as the window has them: what goes, what is meant, and what is not known."""

from dataclasses import replace

import pytest
from fixtures.gui import FakeSource

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.gui.source import topic_named, topic_to_publish
from lcmtools.gui.streams.steer import Steer
from lcmtools.gui.streams.topics import Topics, current_rows
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.types.geometry_msgs import Twist

SECOND = 1_000_000_000
NOW = 1_000 * SECOND
CLOCK = Endpoint("/clock", Role.PUBLISHER, ("rosgraph_msgs/Clock",))
STEP = Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step",))
SIMULATOR = NodeInfo("/sim", "s", "here", 7, NOW - 10 * SECOND, endpoints=(CLOCK, STEP))
OLD = ChannelRow("/husky0/odometry", ("nav_msgs/Odometry",), age=20.0)


def publisher(stale=Staleness.NOT):
    return NodeInfo(
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


@pytest.mark.parametrize(
    ("text", "topic"), [("a", "/a"), ("/a", "/a"), ("A", "A"), ("new", "/new"), ("/new", "/new")]
)
def test_a_topic_to_publish_on_is_one_of_the_bus_else_a_name_of_ros(text, topic):
    source = FakeSource()
    source.know(a=None)
    source.latest = Snapshot((*source.latest.rows, ChannelRow("A", age=1.0)))
    assert topic_to_publish(source, text) == topic


@pytest.mark.parametrize(
    ("programs", "listeners", "shown"),
    [((), (), []), (("cat.py",), (), None), (("cat.py",), ("/ear",), ["/ear"])],
)
def test_listeners_are_not_known_beside_a_program_that_announces_nothing(
    programs, listeners, shown
):
    source = FakeSource()
    source.latest = Snapshot((ChannelRow("/a", listeners=listeners),), plain_listeners=programs)
    data = Topics(source).update().data
    assert [row["listeners"] for row in data["rows"]] == [shown]
    assert data["programs"] == programs


@pytest.mark.parametrize(
    ("topic", "programs", "problem"),
    [
        ("", (), "choose a topic"),
        ("/v", (), "no node obeys /v"),
        ("/v", ("cat.py",), "no node obeys /v; listening, to what is not known: cat.py"),
    ],
)
def test_steering_says_who_may_listen(topic, programs, problem):
    source = FakeSource()
    source.know(v=Twist)
    source.latest = replace(source.latest, plain_listeners=programs)
    assert Steer(source, topic=topic).problem() == problem


def test_steering_says_that_no_topic_commands_a_velocity():
    assert Steer(FakeSource(), topic="").problem() == "no topic commands a velocity yet"
