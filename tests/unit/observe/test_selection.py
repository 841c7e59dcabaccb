"""The meaning of echo's arguments: topics, patterns, and the field paths behind them."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import UsageError
from lcmtools.graph.model import Graph, Traffic
from lcmtools.messages.path import Path, parse_path
from lcmtools.names import Resolver
from lcmtools.observe.reading.selection import OneTopic, TopicPattern, select_topics


def bus(*channels):
    """A bus on which something was seen on some channels."""
    return Graph(traffic=tuple(Traffic(name, None, (), 1, 8, 1, 1) for name in channels))


@pytest.mark.parametrize(
    ("pattern", "channel", "path"),
    [
        ("/husky*/odometry", "/husky0/odometry", ""),
        ("/husky*/odometry", "/husky/odometry", ""),
        ("/husky*/odometry", "/husky0/arm/odometry", None),
        ("/husky*/odometry", "/husky0/odometry2", None),
        ("/husky?/odometry", "/husky10/odometry", None),
        ("/husky*/odometry/pose.pose", "/husky0/odometry", "pose.pose"),
        ("/husky*/odometry/pose", "/husky0/odometry/pose", ""),
        ("/husky*/scan/ranges[0:5]", "/husky0/scan", "ranges[0:5]"),
        ("husky*/scan", "/husky0/scan", ""),
        ("husky*/scan", "husky0/scan", ""),
        ("/husky*/scan", "husky0/scan", None),
        ("*", "EXAMPLE", ""),
        ("*", "/chatter", ""),
        ("*", "/husky0/scan", None),
        ("**", "/husky0/scan", ""),
        ("**/scan", "/a/b/scan", ""),
        ("/a/**", "/a/b/c", ""),
        ("**/scan/ranges", "/a/scan", None),
        ("**", "/_lcmtools/nodes", None),
        ("/*/x", "/_hidden/x", None),
        ("/_hidden/*", "/_hidden/x", ""),
        ("A.B*", "AxBC", None),
        ("A.B*", "A.BC", ""),
    ],
)
def test_a_pattern_matches_whole_names_and_stays_within_a_part(pattern, channel, path):
    one = select_topics(pattern)
    assert isinstance(one, TopicPattern)
    one.update(bus(channel))
    assert one.path_on(channel) == (None if path is None else parse_path(path))
    assert one.channels() == ([] if path is None else [channel])


def test_a_relative_pattern_is_resolved_in_the_namespace():
    one = select_topics("odo*", Resolver("/husky0"))
    assert one.path_on("/husky0/odometry") == Path()
    assert one.path_on("/odometry") is None
    assert one.path_on("odometry") == Path()


def test_a_topic_that_is_named_like_the_pattern_is_meant_alone():
    one = select_topics("A*B")
    assert isinstance(one, TopicPattern)
    one.update(bus("AXB"))
    assert (one.is_literal, one.path_on("AXB")) == (False, Path())
    one.update(bus("AXB", "A*B"))
    assert (one.is_literal, one.path_on("AXB"), one.path_on("A*B")) == (True, None, Path())
    assert one.channels() == ["A*B"]


@pytest.mark.parametrize("argument", ["/a*/x[a]", "/a*/x[0", "/a*/x[0]]"])
def test_an_index_that_is_wrong_is_found_at_once(argument):
    with pytest.raises(UsageError, match="field path"):
        select_topics(argument)


def test_a_topic_is_told_from_its_path_when_it_is_on_the_bus():
    one = select_topics("scan/ranges[0]")
    assert isinstance(one, OneTopic)
    one.update(bus("/other"))
    assert (one.path_on("/scan"), one.path_on("/scan/ranges[0]")) == (None, None)
    one.update(bus("/scan"))
    assert one.path_on("/scan") == parse_path("ranges[0]")
    assert list(one.channels()) == ["scan", "/scan"]
    one.update(bus("/scan/ranges[0]"))  # too late: what is shown does not change
    assert one.path_on("/scan") == parse_path("ranges[0]")


def test_an_empty_name_is_refused():
    with raises_saying(UsageError, "topic", "empty"):
        select_topics("")


def test_a_remap_and_a_namespace_are_those_of_the_topic_that_is_meant():
    names = Resolver("/a", remaps=(("chatter", "/news"),))
    assert list(select_topics("chatter", names).channels()) == ["/news"]
    assert list(select_topics("/a/chatter", names).channels()) == ["/news"]
    assert list(select_topics("/chatter", names).channels()) == ["/chatter"]
    assert list(select_topics("other", names).channels()) == ["other", "/a/other"]
