"""Questions to a graph."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.wire.packet import Sender


def _node(name, *endpoints, tool=False):
    return NodeInfo(name, f"id of {name}", "h", 1, tool=tool, endpoints=endpoints)


def _seen(channel, messages=1, last_time=0):
    return Traffic(channel, Sender("10.0.0.1", 1), (), messages, 0, 0, last_time)


_GRAPH = Graph(
    nodes=(
        _node("/_lcmtools_echo_1", Endpoint("/asked", Role.SUBSCRIBER), tool=True),
        _node("/_lcmtools_pub_2", Endpoint("/given", Role.PUBLISHER, ("t/B",)), tool=True),
        _node(
            "/husky0/driver",
            Endpoint("/z", Role.SUBSCRIBER, ("t/A",)),
            Endpoint("/b", Role.SUBSCRIBER, ("t/A",)),
            Endpoint("/given", Role.SUBSCRIBER, ("t/A",)),
            Endpoint("/srv", Role.SERVICE, ("t/S",)),
        ),
        _node("/husky1/driver", Endpoint("/srv", Role.CLIENT), Endpoint("/p", Role.PUBLISHER)),
    ),
    traffic=(_seen("SEEN"), _seen("/p")),
)


def test_topics_are_what_is_published_subscribed_or_seen_but_not_what_tools_ask_for():
    assert _GRAPH.topic_names() == ["/b", "/given", "/p", "/z", "SEEN"]


def test_a_topic_knows_its_publishers_subscribers_and_types():
    topic = _GRAPH.topic("/given")
    assert [node.name for node, _ in topic.publishers] == ["/_lcmtools_pub_2"]
    assert [node.name for node, _ in topic.subscribers] == ["/husky0/driver"]
    assert topic.types == ("t/B", "t/A")


def test_an_unknown_topic_is_empty():
    topic = _GRAPH.topic("/none")
    assert (topic.publishers, topic.subscribers, topic.traffic, topic.types) == ((), (), (), ())


def test_endpoints_of_a_role_come_sorted():
    node = _GRAPH.nodes[2]
    assert [e.topic for e in node.having(Role.SUBSCRIBER)] == ["/b", "/given", "/z"]
    assert [e.topic for e in node.having(Role.SERVICE)] == ["/srv"]
    assert node.having(Role.CLIENT) == ()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("/husky0/driver", ["/husky0/driver"]),
        ("husky0/driver", ["/husky0/driver"]),
        ("driver", ["/husky0/driver", "/husky1/driver"]),
        ("/driver", []),
        ("other", []),
        ("", []),
    ],
)
def test_a_node_is_found_by_its_full_name_or_its_last_part(name, expected):
    assert [node.name for node in _GRAPH.named(name)] == expected


@pytest.mark.parametrize(
    ("messages", "last_time", "rate"),
    [(1, 0, None), (2, 0, None), (2, 1_000_000_000, 1.0), (101, 2_000_000_000, 50.0)],
)
def test_a_rate_needs_two_messages_and_some_time(messages, last_time, rate):
    assert _seen("A", messages, last_time).rate() == rate


def test_a_hidden_node_is_known_as_such():
    assert _GRAPH.nodes[0].is_hidden
    assert not _GRAPH.nodes[2].is_hidden


def test_an_endpoint_without_types_has_no_type():
    assert Endpoint("/a", Role.PUBLISHER).type == ""
    assert Endpoint("/a", Role.PUBLISHER, ("t/A", "t/B")).type == "t/A"


def test_what_programs_send_to_themselves_at_first_is_nobodys_publication():
    graph = Graph(traffic=(_seen("LCM_SELF_TEST"), _seen("SEEN")))
    assert [seen.channel for seen in graph.foreign()] == ["SEEN"]


@pytest.mark.parametrize(("lag", "there"), [(None, 1000), (300, 700), (-300, 1300)])
def test_a_computer_whose_clock_is_behind_shows_less(lag, there):
    assert _node("/a")._replace(lag=lag).time_there(1000) == there
