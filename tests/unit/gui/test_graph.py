"""The graph as a page draws it."""

import pytest
from fixtures.other_version import other_version
from fixtures.protocol.messages import NODE

from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation
from lcmtools.graph.drawing.subgraph import DiagramOptions
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.gui.streams.graph import GraphMaker
from lcmtools.messages.codec import encode
from lcmtools.observe.reports.bus_diagram import diagram_of
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet, Sender


def _diagram(*more):
    members = (Member("n1", "/a/talker", pid=7), Member("n2", "/b/listener"), *more)
    channels = (Channel("t1", "/a/chatter", ("std_msgs/String",), messages=3),)
    edges = (
        Edge("n1", "t1", Relation.PUBLISHES, 3, rate=10.04),
        Edge("t1", "n2", Relation.SUBSCRIBES, 3),
    )
    return Diagram(members, channels, edges)


def _made(diagram, *, topics=True, groups=False, **options):
    maker = GraphMaker(DiagramOptions(**options), has_topics=topics, has_groups=groups)
    return maker.make(diagram)


def test_data_flow_from_left_to_right():
    made = _made(_diagram())
    left = {one["key"]: one["box"][0] for one in made["vertices"]}
    assert left["node:/a/talker"] < left["topic:/a/chatter"] < left["node:/b/listener"]
    assert made["edges"][0]["rate"] == 10.0
    assert made["counted"] == "2 nodes, 1 topic"


def test_without_topics_nodes_are_joined():
    made = _made(_diagram(), topics=False)
    assert [one["kind"] for one in made["vertices"]] == ["node", "node"]
    [edge] = made["edges"]
    assert (edge["relation"], edge["topics"]) == ("feeds", ("/a/chatter",))


def test_each_namespace_has_a_band():
    made = _made(_diagram(), groups=True)
    assert [one["name"] for one in made["groups"]] == ["/a", "/b"]
    assert _made(_diagram())["groups"] == []


def test_places_stay_when_something_comes_and_ids_are_others():
    maker = GraphMaker(DiagramOptions())
    first = maker.make(_diagram())
    again = maker.make(_diagram())
    assert again == first
    more = maker.make(_diagram(Member("n3", "/new")))
    order = [one["key"] for one in sorted(more["vertices"], key=lambda one: one["box"][1])]
    assert set(order) == {*(one["key"] for one in first["vertices"]), "node:/new"}


def test_tools_are_drawn_where_they_are_wanted():
    tool = Member("n3", "/_lcmtools_echo_1", is_tool=True)
    assert len(_made(_diagram(tool))["vertices"]) == 3
    assert _made(_diagram(tool))["leftOut"].startswith("not drawn: 1 command")
    assert len(_made(_diagram(tool), tools=True)["vertices"]) == 4


@pytest.mark.parametrize("kind", ["newer", "older", "unreadable", "before"])
def test_a_node_of_another_version_is_drawn_with_its_topics(kind):
    builder, sender = GraphBuilder(), Sender("127.0.0.1", 4001)
    payload = encode_announcement(Announcement(NODE._replace(tool=False)))
    builder.add(Packet(NODE_CHANNEL, other_version(payload, kind), 1, sender))
    builder.add(Packet("/husky0/odometry", encode(String()), 2, sender))
    made = _made(diagram_of(builder.snapshot(3), [], None))
    assert {"node:/husky0/driver", "topic:/husky0/odometry"} <= {
        one["key"] for one in made["vertices"]
    }
    assert not any(one.get("stale") for one in made["vertices"])
