"""What strangers may send without end is known up to a bound: the longest silent is forgotten."""

import tracemalloc

import pytest

from lcmtools.graph import protocol
from lcmtools.graph.builder import MOST_FLOWS, MOST_NODES, GraphBuilder
from lcmtools.graph.model import CallbackError, Endpoint, NodeInfo, RelayStep, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    Announcement,
    Retained,
    decode_announcement,
    encode_announcement,
    head_of,
)
from lcmtools.messages.codec import decode, encode
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.wire.packet import Packet, Sender

_MINUTE = 60_000_000_000
_STRANGER = Sender("10.0.0.66", 666)


def _message(channel, time=1):
    return Packet(channel, bytes(8), time, _STRANGER)


def _said(node, time=1, *, leaving=False):
    return Packet(NODE_CHANNEL, encode_announcement(Announcement(node, leaving)), time, _STRANGER)


def _nodes(count):
    return (NodeInfo(f"/n{number}", f"id{number}", "h", 1) for number in range(count))


def test_channels_are_bounded_and_the_longest_silent_is_forgotten():
    graph = GraphBuilder()
    for number in range(MOST_FLOWS + 1000):
        graph.add_all([_message(f"/reply_{number}"), _message("/odom")])
    names = graph.snapshot(2).topic_names()
    assert len(names) == MOST_FLOWS
    assert {"/odom", f"/reply_{MOST_FLOWS + 999}"} < set(names)
    assert "/reply_0" not in names
    assert graph.forgotten == 1001


def test_a_log_has_all_of_its_channels():
    graph = GraphBuilder(is_log=True)
    graph.add_all(_message(f"/reply_{number}") for number in range(MOST_FLOWS + 10))
    assert len(graph.snapshot(10 * _MINUTE).topic_names()) == MOST_FLOWS + 10


@pytest.mark.parametrize("leaving", [False, True])
def test_nodes_are_bounded(leaving):
    graph = GraphBuilder(but="me")
    for node in _nodes(MOST_NODES + 10):
        graph.add(_said(node, leaving=leaving))
    assert len(graph.heard()) == MOST_NODES + 1
    assert "id0" not in graph.heard()
    assert "me" in graph.heard()


def test_nodes_are_bounded_where_only_heads_are_followed():
    graph = GraphBuilder()
    for node in _nodes(MOST_NODES + 10):
        packet = _said(node)
        graph.add_head(head_of(packet.payload), packet)
    assert len(graph.snapshot(2).nodes) == MOST_NODES


def test_large_announcements_are_bounded_by_bytes():
    graph = GraphBuilder()
    topics = tuple(Endpoint(f"/t{number}", Role.PUBLISHER) for number in range(2000))
    for node in _nodes(40):
        graph.add(_said(node._replace(endpoints=topics)))
    assert 5 < len(graph.snapshot(2).nodes) < 30


def test_many_that_are_silent_for_a_minute_are_forgotten_down_to_some():
    graph = GraphBuilder()
    graph.add_all(_message(f"/reply_{number}") for number in range(3000))
    for node in _nodes(1500):
        graph.add(_said(node))
    assert len(graph.snapshot(_MINUTE).traffic) == 3000
    later = graph.snapshot(_MINUTE + 2)
    assert (len(later.traffic), len(later.nodes)) == (500, 500)


def test_types_of_many_channels_are_looked_up_in_one_go(monkeypatch):
    graph, passes = GraphBuilder(), []
    ends = tuple(Endpoint(f"/t{number}", Role.PUBLISHER, ("a/B",)) for number in range(100))
    graph.add(_said(NodeInfo("/n", "id", "h", 1, endpoints=ends)))
    whole = graph._types_by_channel
    monkeypatch.setattr(graph, "_types_by_channel", lambda: passes.append(1) or whole())
    assert {graph.types_of(f"/t{number}") for number in range(100)} == {("a/B",)}
    assert len(passes) == 1


def _bomb(size):
    """An announcement whose details are an array of ``size`` bytes of empty endpoints."""
    message = decode(
        msgs.Announcement, encode_announcement(Announcement(NodeInfo("/n", "i", "h", 1)))
    )
    count = size // 4
    # ports, endpoints and errors are counted by the first three numbers
    message.details = b"\0\0\0\0" + count.to_bytes(4, "big") + bytes(4 * count + 16)
    return encode(message)


def test_an_announcement_that_is_too_large_is_not_unpacked():
    payload = _bomb(5_000_000)
    tracemalloc.start()
    try:
        announcement = decode_announcement(payload)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert not announcement.node.has_details
    assert peak < 20_000_000


@pytest.mark.parametrize(
    "node",
    [
        NodeInfo("/n", "i" * 100_000, "h", 1),
        NodeInfo("/n", "i", "h" * 100_000, 1),
        NodeInfo("/n", "i" * 1_000_000, "h", 1, path=(RelayStep("r", "/r", "b"),)),
    ],
    ids=["id", "host", "behind a relay"],
)
def test_an_announcement_with_a_large_head_is_none(node):
    assert decode_announcement(encode_announcement(Announcement(node))) is None


def test_an_announcement_of_thousands_of_endpoints_is_read():
    ends = tuple(
        Endpoint(f"/robot_{n}/camera/image", Role.PUBLISHER, ("a/B",)) for n in range(3000)
    )
    errors = (CallbackError("/a", "E", "m", "x.py:1", 1, 1),) * 5
    node = NodeInfo("/n", "i", "h", 1, endpoints=ends, errors=errors)
    found = decode_announcement(encode_announcement(Announcement(node)))
    assert len(found.node.endpoints) == 3000


def test_retained_announcements_are_bounded():
    retained = Retained()
    for node in _nodes(MOST_NODES + 10):
        retained.keep(encode_announcement(Announcement(node)), 1.0)
    assert len(list(retained.payloads(1.0))) == MOST_NODES


def test_decoded_endpoints_are_kept_by_number_and_size():
    kept = protocol._known_endpoint.cache_info
    many = tuple(Endpoint(f"/t{n}", Role.PUBLISHER, ("a/B",)) for n in range(3000))
    for round_ in range(4):
        ends = tuple(end._replace(depth=round_) for end in many)
        decode_announcement(_said(NodeInfo("/n", "i", "h", 1, endpoints=ends)).payload)
    assert kept().currsize == kept().maxsize
    large = Endpoint("/t", Role.PUBLISHER, ("x" * 10_000,))
    before = kept().misses
    found = decode_announcement(_said(NodeInfo("/n", "i", "h", 1, endpoints=(large,))).payload)
    assert found.node.endpoints == (large,)
    assert kept().misses == before
