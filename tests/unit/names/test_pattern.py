"""Patterns of names: one table of cases for all commands."""

import pytest

from lcmtools.graph.drawing.subgraph import is_meant
from lcmtools.graph.model import Graph, Traffic
from lcmtools.names import Pattern, has_wildcard, is_hidden
from lcmtools.observe.channels.rows import ChannelSelection
from lcmtools.observe.reading.selection import TopicPattern

CASES = [
    ("/*/odometry", "/husky0/odometry", True),
    ("/*/odometry", "/a/b/odometry", False),
    ("/**/odometry", "/a/b/odometry", True),
    ("**/odometry", "/husky0/odometry", True),
    ("/husky*/odometry", "/husky/odometry", True),
    ("/husky*/odometry", "/husky0/odometry2", False),
    ("/husky?/odometry", "/husky0/odometry", True),
    ("/husky?/odometry", "/husky10/odometry", False),
    ("/husky?odometry", "/husky/odometry", False),
    ("husky*/scan", "/husky0/scan", True),
    ("husky*/scan", "husky0/scan", True),
    ("/husky*/scan", "husky0/scan", False),
    ("*", "EXAMPLE", True),
    ("*", "/chatter", True),
    ("**", "/husky0/scan", True),
    ("/a/**", "/a/b/c", True),
    ("**", "/_lcmtools/nodes", False),
    ("/*/x", "/_hidden/x", False),
    ("/_hidden/*", "/_hidden/x", True),
    ("A.B*", "AxBC", False),
    ("A.B*", "A.BC", True),
    ("[ab]*", "a", False),
]
"""Pattern, topic, and whether the one matches the other, in every command."""


@pytest.mark.parametrize(("pattern", "name", "matches"), CASES)
def test_a_pattern_means_the_same_in_every_command(pattern, name, *, matches):
    assert Pattern(pattern).matches(name) == matches
    assert ChannelSelection((pattern,)).has(name) == matches  # spy
    assert is_meant(name, pattern, is_topic=True) == (matches or is_hidden(name))  # graph
    echo = TopicPattern(pattern)
    echo.update(Graph(traffic=(Traffic(name, None, (), 1, 8, 1, 1),)))
    assert (echo.path_on(name) is not None) == matches


@pytest.mark.parametrize(
    ("pattern", "name", "covers"),
    [
        ("", "/a/b", True),
        ("/", "EXAMPLE", True),
        ("/a", "/a", True),
        ("/a/", "/a/b/c", True),
        ("/a", "/ab", False),
        ("a", "/a/b", True),
        ("a", "a/b", True),
        ("/a*", "/ab/c/d", True),
        ("/*/c", "/a/c/d", True),
        ("/*/d", "/a/c/d", False),
        ("/a", "/a/_b", False),
        ("/a/_b", "/a/_b/c", True),
    ],
)
def test_a_namespace_covers_everything_below(pattern, name, *, covers):
    assert Pattern(pattern).covers(name) == covers


@pytest.mark.parametrize(
    ("pattern", "name", "means"),
    [
        ("driv*", "/husky1/driver", True),
        ("driver", "/husky1/driver", True),
        ("/driv*", "/husky1/driver", False),
        ("husky1", "/husky1/driver", True),
        ("husky?/dr*r", "/husky1/driver", True),
        ("_driv*", "/husky1/_driver", True),
        ("*", "/_tool", False),
    ],
)
def test_one_part_means_a_nodes_last_part_too(pattern, name, *, means):
    assert Pattern(pattern).means_node(name) == means


def test_a_relative_pattern_is_resolved_in_the_namespace_too():
    pattern = Pattern("odo*", "/husky0")
    assert pattern.matches("/husky0/odometry")
    assert pattern.matches("odometry")
    assert not pattern.matches("/odometry")


def test_hidden_names_are_matched_where_they_are_wanted():
    assert Pattern("/*", hidden=True).matches("/_tool")
    assert Pattern("/a", hidden=True).covers("/a/_b")


def test_wildcards_are_stars_and_question_marks():
    assert has_wildcard("/a*")
    assert has_wildcard("/a?")
    assert not has_wildcard("/a[0]")
