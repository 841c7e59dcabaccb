"""The graph grows out of packets: announcements, traffic, silence, goodbyes and records."""

from time import thread_time

import pytest

from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, NodeInfo, RelayStep, Role, Staleness, Traffic
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.wire.packet import Packet, Sender

_S = 1_000_000_000
_ALICE, _BOB, _EVE = (Sender("10.0.0.1", port) for port in (40_001, 40_002, 40_003))


def _node(name="/a", **changes):
    values = {"name": name, "id": f"id of {name}", "host": "h", "pid": 1}
    return NodeInfo(**{**values, **changes})


def _announce(builder, node, *, sender=_ALICE, time=0, leaving=False):
    payload = encode_announcement(Announcement(node, leaving))
    return builder.add(Packet(NODE_CHANNEL, payload, time, sender, 0))


def _publisher(topic, *fingerprints):
    types = tuple(f"t/T{n}" for n in range(len(fingerprints)))
    return Endpoint(topic, Role.PUBLISHER, types, fingerprints)


def test_an_announced_node_is_known_with_its_sender_and_time():
    builder = GraphBuilder()
    announcement = _announce(builder, _node(), time=5)
    assert announcement.node.name == "/a"
    (node,) = builder.snapshot(5).nodes
    assert (node.name, node.sender, node.last_announced, node.stale) == ("/a", _ALICE, 5, "")


@pytest.mark.parametrize(
    ("sent", "lags"), [((0, 0), None), ((90, 107), 3), ((95, 90), 5), ((90, 0), 10), ((0, 90), 20)]
)
def test_the_quickest_announcement_tells_of_the_clock(sent, lags):
    builder = GraphBuilder()
    for time, announced in zip((100, 110), sent, strict=True):
        _announce(builder, _node(sent=announced), time=time)
    (node,) = builder.snapshot(110).nodes
    assert (node.sent, node.lag) == (sent[1], lags)


def test_what_relays_kept_does_not_count_as_a_difference_of_clocks():
    builder, steps = GraphBuilder(), [RelayStep("r", "/r", "0", kept=30), RelayStep("s", "/s", "1")]
    _announce(builder, _node(sent=50, path=tuple(steps)), time=100)
    assert [node.lag for node in builder.snapshot(100).nodes] == [20]
    _announce(builder, _node(sent=150, path=(*steps[1:], steps[1]._replace(kept=1))), time=161)
    assert [node.lag for node in builder.snapshot(161).nodes] == [10]


def test_nodes_come_sorted_by_name_and_start():
    builder = GraphBuilder()
    for name, identity, start in (("/b", "1", 0), ("/a", "2", 9), ("/a", "3", 4)):
        _announce(builder, _node(name, id=identity, start_time=start))
    assert [node.id for node in builder.snapshot(0).nodes] == ["3", "2", "1"]


def test_a_later_announcement_replaces_the_earlier():
    builder = GraphBuilder()
    _announce(builder, _node())
    _announce(builder, _node(endpoints=(_publisher("/t"),)), time=1, sender=_BOB)
    (node,) = builder.snapshot(1).nodes
    assert [endpoint.topic for endpoint in node.endpoints] == ["/t"]
    assert node.sender == _BOB


def test_two_nodes_of_one_name_are_two():
    builder = GraphBuilder()
    _announce(builder, _node(id="1"))
    _announce(builder, _node(id="2"), sender=_BOB)
    assert len(builder.snapshot(0).nodes) == 2


@pytest.mark.parametrize(
    ("silence", "stale"),
    [(0, ""), (3 * _S, ""), (3 * _S + 1, "no longer announces itself")],
)
def test_a_silent_node_is_stale_after_three_seconds(silence, stale):
    builder = GraphBuilder()
    _announce(builder, _node(), time=100)
    assert [node.stale for node in builder.snapshot(100 + silence).nodes] == [stale]


def test_a_stale_node_that_is_heard_again_is_alive():
    builder = GraphBuilder()
    _announce(builder, _node(), time=0)
    _announce(builder, _node(), time=9 * _S)
    assert [node.stale for node in builder.snapshot(9 * _S).nodes] == [""]


def test_a_node_that_says_goodbye_is_gone_even_if_an_old_announcement_comes_late():
    builder = GraphBuilder()
    _announce(builder, _node())
    _announce(builder, _node(), leaving=True)
    assert builder.snapshot(0).nodes == ()
    _announce(builder, _node())
    assert builder.snapshot(0).nodes == ()
    _announce(builder, _node(id="next run"))
    assert [node.id for node in builder.snapshot(0).nodes] == ["next run"]


def test_a_recorded_node_that_does_not_answer_is_stale():
    builder = GraphBuilder()
    builder.recall([_node("/a", stale=Staleness.ENDED), _node("/b")])
    stale = {node.name: node.stale for node in builder.snapshot(0).nodes}
    assert stale == {"/a": "ended without saying goodbye", "/b": "does not answer"}


def test_a_recorded_node_that_answers_is_alive_and_one():
    builder = GraphBuilder()
    builder.recall([_node(stale=Staleness.HANGS)])
    _announce(builder, _node())
    assert [node.stale for node in builder.snapshot(0).nodes] == [""]


def test_a_recorded_node_that_left_is_gone():
    builder = GraphBuilder()
    builder.recall([_node(stale=Staleness.ENDED)])
    _announce(builder, _node(), leaving=True)
    assert builder.snapshot(0).nodes == ()
    builder.recall([_node()])
    assert builder.snapshot(0).nodes == ()


def test_a_forgotten_node_is_gone_until_it_is_heard():
    builder = GraphBuilder()
    builder.recall([_node("/b")])
    _announce(builder, _node("/a"))
    builder.forget("id of /a")
    builder.forget("id of /b")
    builder.forget("nobody")
    assert builder.snapshot(0).nodes == ()
    _announce(builder, _node("/a"))
    assert len(builder.snapshot(0).nodes) == 1


def test_traffic_is_counted_by_channel_and_sender():
    builder = GraphBuilder()
    for time, channel, sender, payload in (
        (10, "A", _ALICE, b"12345678rest"),
        (20, "A", _BOB, b"12345678"),
        (30, "A", _ALICE, b"abcdefgh"),
        (40, "B", _ALICE, b"short"),
    ):
        builder.add(Packet(channel, payload, time, sender, 0))
    one, other = int.from_bytes(b"12345678", "big"), int.from_bytes(b"abcdefgh", "big")
    assert builder.snapshot(50).traffic == (
        Traffic("A", _ALICE, (one, other), 2, 20, 10, 30),
        Traffic("A", _BOB, (one,), 1, 8, 20, 20),
        Traffic("B", _ALICE, (), 1, 5, 40, 40),
    )


def test_announcements_and_probes_are_no_traffic():
    builder = GraphBuilder()
    _announce(builder, _node())
    builder.add(Packet(PROBE_CHANNEL, encode_probe(Probe()), 0, _EVE, 0))
    builder.add(Packet(NODE_CHANNEL, b"nonsense", 0, _EVE, 0))
    assert builder.snapshot(0).traffic == ()
    assert builder.senders() == {_ALICE}


def test_data_of_no_lcm_type_does_not_fill_the_memory():
    builder = GraphBuilder()
    for number in range(1000):
        builder.add(Packet("RAW", number.to_bytes(8, "big"), number, _ALICE, number))
    (seen,) = builder.snapshot(0).traffic
    assert seen.messages == 1000
    assert len(seen.fingerprints) <= 16


def test_types_are_not_collected_again_for_messages_that_tell_none(monkeypatch):
    builder, collected = GraphBuilder(), []
    collect = builder._types_by_channel

    def collect_and_note():
        collected.append(1)
        return collect()

    monkeypatch.setattr(builder, "_types_by_channel", collect_and_note)
    _announce(builder, _node(endpoints=(_publisher("/a", 1),)))
    for number in range(10):
        builder.add_all([Packet(f"/b{number}", bytes(8), 0, _BOB)])
        builder.add(Packet(f"/c{number}", bytes(8), 0, _BOB))
        assert builder.types_of("/a") == ("t/T0",)
    assert len(collected) == 1
    for name in ("t/One", "t/Two"):
        typed = Packet("/a", bytes(8), 0, _BOB, type_name=name)
        builder.add_all([typed]) if name == "t/One" else builder.add(typed)
        assert name in builder.types_of("/a")
    builder.forget("id of /a")
    assert builder.types_of("/a") == ("t/One", "t/Two")


@pytest.mark.timing
def test_nodes_without_details_make_a_snapshot_no_slower_by_every_channel():
    usual, unknown = _snapshot_seconds(has_details=True), _snapshot_seconds(has_details=False)
    assert unknown < 8 * usual  # 40 times as long if every channel is looked at for each node


def _snapshot_seconds(*, has_details):
    builder = GraphBuilder()
    for port in range(1000):
        node = _node(f"/n{port}", has_details=has_details)
        _announce(builder, node, sender=Sender("10.0.0.1", port))
    for port in range(4000):
        builder.add(Packet(f"/c{port}", bytes(8), 0, Sender("10.0.0.1", port)))
    start = thread_time()
    builder.snapshot(0)
    return thread_time() - start


def test_every_port_of_a_node_is_a_known_sender():
    builder = GraphBuilder()
    _announce(builder, _node(ports=(40_002,)))
    builder.add(Packet("X", b"", 0, _EVE, 0))
    assert builder.senders() == {_ALICE, _BOB, _EVE}


def _mixed_graph():
    """Alice and her extra port are a node that publishes /t; Eve is no node, and does too."""
    builder = GraphBuilder()
    _announce(builder, _node(ports=(40_002,), endpoints=(_publisher("/t", 7),)))
    for sender in (_ALICE, _BOB, _EVE):
        builder.add(Packet("/t", bytes(8), 0, sender, 0))
    builder.add(Packet("OTHER", bytes(8), 0, _EVE, 0))
    return builder.snapshot(0)


def test_foreign_traffic_is_what_no_announced_sender_sent():
    topic = _mixed_graph().topic("/t")
    assert [seen.sender for seen in topic.traffic] == [_ALICE, _BOB, _EVE]
    assert [seen.sender for seen in topic.foreign] == [_EVE]
    assert [node.name for node, _ in topic.publishers] == ["/a"]


def test_a_foreign_topic_has_traffic_only():
    topic = _mixed_graph().topic("OTHER")
    assert topic.publishers == topic.subscribers == ()
    assert topic.foreign == topic.traffic
    assert topic.types == ()
    assert topic.fingerprints == (0,)


def test_the_same_port_on_another_computer_is_another_sender():
    builder = GraphBuilder()
    _announce(builder, _node())
    builder.add(Packet("/t", b"", 0, Sender("10.0.0.9", _ALICE.port), 0))
    assert len(builder.snapshot(0).topic("/t").foreign) == 1


def test_where_the_bus_names_no_sender_an_announced_publisher_explains_the_traffic():
    builder = GraphBuilder()
    _announce(builder, _node(endpoints=(_publisher("/t", 7),)), sender=None)
    builder.add(Packet("/t", bytes(8), 0))
    builder.add(Packet("OTHER", bytes(8), 0))
    graph = builder.snapshot(0)
    assert graph.topic("/t").foreign == ()
    assert len(graph.topic("OTHER").foreign) == 1


def _relay(**changes):
    seen = Traffic("/far", Sender("ada", 7), (5,), 3, 24, 100, 300, bus="the other bus")
    return _node("/relay", observed=(seen,), sent=1_000, **changes)


def test_what_a_relay_has_observed_is_traffic_of_programs_by_the_clock_here():
    builder = GraphBuilder()
    _announce(builder, _relay(), time=1_010)
    graph = builder.snapshot(1_010)
    (seen,) = graph.topic("/far").foreign
    assert seen == graph.foreign()[0]
    assert (seen.observer, seen.bus, seen.first_time, seen.last_time) == (
        *("/relay", "the other bus"),
        *(110, 310),
    )
    assert str(seen.sender) == "ada:7, on the other bus"
    assert (seen.fingerprints, seen.messages, seen.bytes) == ((5,), 3, 24)


def test_a_relay_that_is_silent_or_recorded_tells_of_nothing():
    live, log = GraphBuilder(), GraphBuilder(is_log=True)
    for builder in (live, log):
        _announce(builder, _relay(), time=1_010)
        assert builder.snapshot(10 * _S).traffic == ()


def test_what_a_relay_has_observed_explains_messages_without_senders():
    builder = GraphBuilder()
    _announce(builder, _relay(), sender=None, time=1_010)
    builder.add(Packet("/far", bytes(8), 1_020))
    graph = builder.snapshot(1_020)
    assert [seen.observer for seen in graph.foreign()] == ["/relay"]
    assert len(graph.topic("/far").traffic) == 2
