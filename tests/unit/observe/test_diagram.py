"""The knowledge of a bus, as a diagram."""

import socket

from fixtures.says import assert_says

from lcmtools.bus.processes import Process
from lcmtools.graph.drawing.diagram import Edge, Member, Relation
from lcmtools.graph.drawing.labels import notes
from lcmtools.graph.drawing.subgraph import DiagramOptions, select
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness, Traffic
from lcmtools.messages.registry import fingerprint
from lcmtools.observe.reading.senders import Program
from lcmtools.observe.reports.bus_diagram import diagram_of
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Sender

HOST = socket.gethostname()
_SECOND = 1_000_000_000


def _node(name, *endpoints, port=0, **other):
    sender = Sender("127.0.0.1", port) if port else None
    return NodeInfo(name, f"{name} {port}", HOST, 7, endpoints=endpoints, sender=sender, **other)


def _seen(channel, port, messages=3):
    sender = Sender("127.0.0.1", port)
    return Traffic(channel, sender, (fingerprint(String),), messages, 0, 0, _SECOND)


def _edge(diagram, source, target):
    """The edge between two names."""
    names = {vertex.id: vertex.name for vertex in diagram.vertices()}
    (edge,) = (e for e in diagram.edges if (names[e.source], names[e.target]) == (source, target))
    return edge


def test_nodes_and_their_topics():
    talker = _node("/a", Endpoint("/t", Role.PUBLISHER, ("std_msgs/String",), messages=5))
    hearer = _node("/b", Endpoint("/t", Role.SUBSCRIBER, messages=4))
    diagram = diagram_of(Graph((talker, hearer)), [], None)
    assert [m.name for m in diagram.members] == ["/a", "/b"]
    (channel,) = diagram.channels
    assert (channel.name, channel.types, channel.messages) == ("/t", ("std_msgs/String",), 5)
    assert _edge(diagram, "/a", "/t") == Edge("n1", "t1", Relation.PUBLISHES, 5)
    assert _edge(diagram, "/t", "/b") == Edge("t1", "n2", Relation.SUBSCRIBES, 4)


def test_services_are_channels_of_their_own_even_by_a_topics_name():
    server = _node("/a", Endpoint("/x", Role.SERVICE, ("std_srvs/SetBool",)))
    client = _node("/b", Endpoint("/x", Role.CLIENT), Endpoint("/x", Role.PUBLISHER))
    diagram = diagram_of(Graph((server, client)), [], None)
    assert [(c.id, c.is_service) for c in diagram.channels] == [("t1", False), ("s1", True)]
    assert diagram.channels[1].types == ("std_srvs/SetBool",)
    relations = {(edge.source, edge.target): edge.relation for edge in diagram.edges}
    assert relations == {
        ("s1", "n1"): Relation.SERVES,
        ("n2", "s1"): Relation.CALLS,
        ("n2", "t1"): Relation.PUBLISHES,
    }


def test_a_topic_twice_in_a_node_is_one_edge():
    node = _node("/a", *(Endpoint("/t", Role.SUBSCRIBER, messages=2) for _ in range(2)))
    (edge,) = diagram_of(Graph((node,)), [], None).edges
    assert edge.messages == 4


def test_a_program_publishes_what_was_seen_of_it():
    traffic = (_seen("X", 9, 3), _seen("X", 10, 4))
    program = Program(Process(5, "prog -x"), "me", "127.0.0.1", (9, 10), traffic, listens=True)
    diagram = diagram_of(Graph((), traffic), [program], None)
    assert diagram.members == (
        Member(
            "n1", "prog -x", HOST, pid=5, command="prog -x", user="me", is_node=False, listens=True
        ),
    )
    (channel,) = diagram.channels
    assert (channel.types, channel.messages) == (("std_msgs/String",), 7)
    assert [edge.messages for edge in diagram.edges] == [7]


def test_a_program_of_another_computer_is_there():
    sender = Sender("10.1.2.3", 5)
    traffic = (Traffic("X", sender, (), 1, 0, 0, 0),)
    program = Program(None, "", "10.1.2.3", (5,), traffic, None)
    (member,) = diagram_of(Graph((), traffic), [program], None).members
    assert (member.host, member.is_here, member.pid) == ("10.1.2.3", False, None)


def test_a_node_of_another_computer_and_a_stale_one():
    far = NodeInfo("/far", "id", "robot", 7)
    dead = _node("/dead", stale=Staleness.ENDED)
    one, other = diagram_of(Graph((far, dead)), [], None).members
    assert (one.is_here, one.host, one.stale) == (False, "robot", "")
    assert (other.is_here, other.stale) == (True, "ended without saying goodbye")


def test_the_rate_of_a_topic_is_its_one_publishers():
    talker = _node("/a", Endpoint("/t", Role.PUBLISHER), port=1)
    graph = Graph((talker,), (_seen("/t", 1),))
    diagram = diagram_of(graph, [], {"/t": 10.0})
    assert _edge(diagram, "/a", "/t").rate == 10.0
    assert diagram.channels[0].rate == 10.0
    assert _edge(diagram_of(graph, [], None), "/a", "/t").rate is None


def test_of_several_publishers_each_has_its_own_rate():
    nodes = tuple(_node(name, Endpoint("/t", Role.PUBLISHER), port=p) for name, p in _PORTS)
    traffic = (_seen("/t", 1, 11), _seen("/t", 2, 6))
    diagram = diagram_of(Graph(nodes, traffic), [], {"/t": 15.0})
    assert [_edge(diagram, name, "/t").rate for name, _ in _PORTS] == [10.0, 5.0]


_PORTS = (("/a", 1), ("/b", 2))


def test_a_command_that_publishes_is_no_onlooker():
    pub = _node("/_lcmtools_pub_1", Endpoint("/t", Role.PUBLISHER), tool=True)
    echo = _node("/_lcmtools_echo_2", Endpoint("/t", Role.SUBSCRIBER), tool=True)
    whole = diagram_of(Graph((pub, echo), ()), [], None)
    shown, left = select(whole, DiagramOptions(leaf_topics=True))
    assert [(member.name, notes(member)) for member in shown.members] == [("/_lcmtools_pub_1", [])]
    assert_says(left.text(), "not drawn: 1 command", "--tools")


def test_tools_are_marked_and_what_they_hear_is_known():
    tool = _node("/_lcmtools_echo_1", Endpoint("/t", Role.SUBSCRIBER), tool=True)
    diagram = diagram_of(Graph((tool,)), [], None)
    assert diagram.members[0].is_tool
    assert [channel.name for channel in diagram.channels] == ["/t"]
