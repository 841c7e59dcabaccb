"""Following announcements without decoding those of which only the counters changed."""

import pytest

from lcmtools.graph import builder
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    SHUTDOWN_CHANNEL,
    Announcement,
    Shutdown,
    decode_announcement,
    encode_announcement,
    encode_shutdown,
    head_of,
)
from lcmtools.wire.packet import Packet

_NODE = NodeInfo("/a", "id-1", "h", 1, endpoints=(Endpoint("/t", Role.PUBLISHER),))


@pytest.fixture
def decoded(monkeypatch):
    """The payloads that were decoded."""
    payloads = []

    def decode(payload):
        payloads.append(payload)
        return decode_announcement(payload)

    monkeypatch.setattr(builder, "decode_announcement", decode)
    return payloads


def _hear(graph, node, time, *, leaving=False):
    payload = encode_announcement(Announcement(node, leaving))
    graph.add_head(head_of(payload), Packet(NODE_CHANNEL, payload, time))


def _counted(messages):
    return _NODE._replace(endpoints=(_NODE.endpoints[0]._replace(messages=messages),))


def test_counters_alone_are_not_decoded_and_the_node_counts_as_heard(decoded):
    graph = GraphBuilder()
    for second in range(5):
        _hear(graph, _counted(second), second * 1_000_000_000)
    assert len(decoded) == 1
    (node,) = graph.snapshot(6_000_000_000).nodes
    assert node.last_announced == 4_000_000_000
    assert not node.stale


def test_a_new_endpoint_is_learnt_at_once(decoded):
    graph = GraphBuilder()
    _hear(graph, _NODE, 1)
    _hear(graph, _NODE._replace(endpoints=(Endpoint("/u", Role.SUBSCRIBER),)), 2)
    assert len(decoded) == 2
    assert graph.snapshot(3).topic_names() == ["/u"]


def test_a_goodbye_counts_and_nothing_brings_the_node_back(decoded):
    graph = GraphBuilder()
    _hear(graph, _NODE, 1)
    _hear(graph, _NODE, 2, leaving=True)
    _hear(graph, _NODE, 3)
    assert graph.snapshot(4).nodes == ()
    assert len(decoded) == 3


def test_a_node_that_was_forgotten_is_decoded_again(decoded):
    graph = GraphBuilder()
    _hear(graph, _NODE, 1)
    graph.forget(_NODE.id)
    _hear(graph, _NODE, 2)
    assert [node.name for node in graph.snapshot(3).nodes] == ["/a"]
    assert len(decoded) == 2


def test_what_is_broken_is_passed_over():
    graph = GraphBuilder()
    payload = encode_announcement(Announcement(_NODE))[:-1]
    graph.add_head(head_of(payload), Packet(NODE_CHANNEL, payload, 1))
    assert graph.snapshot(2).nodes == ()


def test_a_request_to_end_is_no_topic():
    graph = GraphBuilder()
    graph.add(Packet(SHUTDOWN_CHANNEL, encode_shutdown(Shutdown("id-1")), 1))
    assert graph.snapshot(2).topic_names() == []
