"""Selection of what is drawn, and a word on what is left out."""

from dataclasses import replace

import pytest

from lcmtools.graph.drawing.diagram import Channel, Edge, Relation
from lcmtools.graph.drawing.subgraph import (
    DiagramOptions,
    LeftOut,
    is_meant,
    members_only,
    select,
)


def shown(diagram, **wanted):
    """The names of what is drawn."""
    found, _ = select(diagram, DiagramOptions(**wanted))
    return {vertex.name for vertex in (*found.members, *found.channels)}


def test_a_topic_with_one_side_and_no_message_is_left_out_and_counted(draw):
    diagram = draw("/a > /t1 > /b", "/a > /t2", "/t3 > /b")
    found, left = select(diagram, DiagramOptions())
    assert [channel.name for channel in found.channels] == ["/t1"]
    assert [(edge.source, edge.target) for edge in found.edges] == [("n1", "t1"), ("t1", "n2")]
    assert left.text() == (
        "not drawn: 2 unused topics, without a publisher or without a subscriber"
        " (add --leaf-topics)"
    )
    assert shown(diagram, leaf_topics=True) == {"/a", "/b", "/t1", "/t2", "/t3"}


def test_a_topic_that_carries_messages_is_drawn(draw):
    assert "/t" in shown(draw("/a > /t", changes={"/t": {"messages": 1}}))


def test_a_topic_named_outright_is_drawn(draw):
    assert shown(draw("/t > /a", "/b"), topics=("/t",)) >= {"/t", "/a"}


def test_topics_bring_along_who_uses_them_alone(draw):
    diagram = draw("/a > /t1 > /b", "/a > /t2 > /c", "/d")
    assert shown(diagram, topics=("/t1", "x*")) == {"/a", "/t1", "/b"}


def test_clock_and_rosout_are_quiet(draw):
    diagram = draw("/a > /t > /b", changes={"/t": {"name": "/rosout", "messages": 9}})
    assert shown(diagram) == {"/a", "/b"}
    assert select(diagram, DiagramOptions())[1].text() == (
        "not drawn: /rosout, which nearly all nodes use (add --all)"
    )
    assert "/rosout" in shown(diagram, everything=True)
    assert "/rosout" in shown(diagram, topics=("/rosout",))


def test_tools_and_what_only_they_hear_are_left_out(draw):
    tool = {"is_tool": True, "name": "/_lcmtools_echo_1"}
    diagram = draw(
        "/t > /echo", "/a > /t2 > /echo", changes={"/echo": tool, "/t2": {"messages": 1}}
    )
    assert shown(diagram) == {"/a", "/t2"}
    assert select(diagram, DiagramOptions())[1] == LeftOut(tools=1)
    assert shown(diagram, tools=True) == {"/a", "/t2", "/_lcmtools_echo_1"}


def test_hidden_names_are_left_out(draw):
    diagram = draw("/_h > /t > /b", "/b > /_x/t > /b")
    assert shown(diagram, leaf_topics=True) == {"/b", "/t"}
    assert (
        select(diagram, DiagramOptions())[1]
        .text()
        .endswith("; 2 names with a part that begins with _ (add --all)")
    )
    assert shown(diagram, everything=True) == {"/_h", "/t", "/b", "/_x/t"}


def test_services_are_drawn_where_they_are_asked_for(draw):
    service = Channel("s1", "/switch", is_service=True)
    diagram = draw("/a")
    diagram = replace(diagram, channels=(service,), edges=(Edge("s1", "n1", Relation.SERVES),))
    assert shown(diagram) == {"/a"}
    assert shown(diagram, services=True) == {"/a", "/switch"}


def test_a_namespace_keeps_what_it_is_connected_to(draw):
    diagram = draw("/sim > /r/t1 > /r/driver", "/other > /t2 > /r/driver", "/t2 > /far", "/x > /t3")
    assert shown(diagram, parts=("/r",), leaf_topics=True) == {
        *("/sim", "/r/t1", "/r/driver"),
        *("/t2", "/other"),  # who feeds the driver, but not who else hears that
    }


def test_a_programs_pid_and_command_are_meant(draw):
    program = {"is_node": False, "name": "/bin/lcm-source -m X", "pid": 77}
    diagram = draw("/a > X", "/b", changes={"/a": program, "X": {"messages": 1}})
    for word in ("lcm-source", "77", "lcm*"):
        assert shown(diagram, parts=(word,)) == {"/bin/lcm-source -m X", "X"}


def test_what_is_excluded_is_not_drawn(draw):
    diagram = draw("/a > /r/t1 > /b", "/a > /t2 > /b")
    assert shown(diagram, excluded=("/r",)) == {"/a", "/b", "/t2"}
    assert shown(diagram, excluded=("/b",), leaf_topics=True) == {"/a", "/r/t1", "/t2"}


@pytest.mark.parametrize(
    ("name", "wanted", "expected"),
    [
        ("/husky0/odometry", "/husky0", True),
        ("/husky0/odometry", "husky0/", True),
        ("/husky01/odometry", "/husky0", False),
        ("/husky0/odometry", "odometry", True),
        ("/husky0/odometry", "/odometry", False),
        ("/husky0/odometry", "odo*", True),
        ("/husky0/odometry", "/husky?/*", True),
        ("/husky0/odometry", "*/odometry", True),
        ("EXAMPLE", "EXAMPLE", True),
        ("EXAMPLE", "EX*", True),
        ("EXAMPLE", "EX", False),
        ("/a", "/", True),
    ],
)
def test_which_names_a_word_means(name, wanted, *, expected):
    assert is_meant(name, wanted) is expected


def test_without_channels_members_are_connected_by_their_topics(draw):
    diagram = members_only(draw("/a > /t1 > /b", "/a > /t2 > /b", "/b > /t3 > /b", "/c > /t4"))
    assert diagram.channels == ()
    assert [(e.source, e.target, e.topics) for e in diagram.edges] == [
        ("n1", "n2", ("/t1", "/t2")),
        ("n2", "n2", ("/t3",)),
    ]
    assert len(diagram.members) == 3


def test_calls_are_not_mixed_with_topics(draw):
    diagram = draw("/a > /t1 > /b", "/a > /t2 > /b", changes={"/t2": {"is_service": True}})
    assert [edge.relation for edge in members_only(diagram).edges] == [
        Relation.FEEDS,
        Relation.CALLS,
    ]
