"""From datagrams to messages and the graph, whatever the bytes are."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.wire.datagram import fragments, short_message
from lcmtools.wire.packet import Sender
from lcmtools.wire.reader import Reader
from lcmtools.wire.reassembly import INCOMPLETE

SENDER = Sender("10.0.0.1", 5000)
NODE = NodeInfo("/talker", "1", "here", 7, endpoints=(Endpoint("/chatter", Role.PUBLISHER),))
SEEDS = [
    short_message(0, NODE_CHANNEL, encode_announcement(Announcement(NODE))),
    short_message(1, PROBE_CHANNEL, encode_probe(Probe("/talker", 5))),
    short_message(2, "EXAMPLE", b"12345678abc"),
    *fragments(3, NODE_CHANNEL, bytes(70_000)),
    *fragments(4, "/image", bytes(150_000)),
]


def read(reader, datagrams):
    packets = [reader.read(data, SENDER, time) for time, data in enumerate(datagrams)]
    return [packet for packet in packets if packet is not None]


@st.composite
def datagrams(draw):
    """Any bytes, or a good datagram with some of them changed, or cut short."""
    if draw(st.booleans()):
        return draw(st.binary(max_size=200))
    data = bytearray(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(0, 4))):
        data[draw(st.integers(0, min(len(data), 300) - 1))] = draw(st.integers(0, 255))
    return bytes(data[: draw(st.integers(0, len(data)))] if draw(st.booleans()) else data)


@pytest.mark.parametrize("way", ["whole", "heads"])
@given(received=st.lists(datagrams(), max_size=30))
def test_no_bytes_harm_the_way_from_datagram_to_graph(way, received):
    reader, builder = Reader(whole=way == "whole"), GraphBuilder()
    for packet in read(reader, received):
        assert packet.size >= len(packet.payload)
        builder.add(packet)
    graph = builder.snapshot(10)
    assert sum(seen.messages for seen in graph.traffic) <= len(received)
    assert graph.topic_names() == sorted(graph.topic_names())
    assert graph.foreign() is not None
    assert all(sequence.lost >= 0 for sequence in reader.sequences.values())


def test_heads_are_of_first_fragments_alone():
    (packet,) = read(Reader(whole=False), SEEDS[-3:])
    assert (packet.channel, packet.size) == ("/image", 150_000)
    assert len(packet.payload) < 2000


def test_announcements_are_whole_where_heads_are_enough_for_others():
    reader = Reader(whole=False)
    assert not reader.needs_all
    (packet,) = read(reader, SEEDS[3:5])
    assert (packet.channel, packet.whole_bytes) == (NODE_CHANNEL, None)
    assert reader.needs_all


def test_senders_of_nonsense_are_bounded():
    reader = Reader(whole=False)
    for port in range(5000):
        reader.read(b"nonsense", Sender("10.0.0.1", port), 0)
        reader.read(short_message(0, "A", b""), Sender("10.0.0.2", port), 0, 1)
    counts = [len(known) for known in (reader.malformed, reader.sequences, reader.ttls)]
    assert counts == 3 * [4000]


def test_only_the_channels_that_are_wanted_whole_come_whole():
    reader = Reader(whole=False, always_whole=("/image",))
    large = bytes(range(250)) * 600
    found = read(reader, [*fragments(1, "/cloud", large), *fragments(2, "/image", large)])
    assert [(packet.channel, len(packet.payload), packet.size) for packet in found] == [
        ("/cloud", 1024, 150_000),
        ("/image", 150_000, 150_000),
    ]
    assert found[1].payload == large


def test_large_messages_that_never_become_whole_are_lost():
    reader = Reader(whole=True)
    whole, parts = list(fragments(7, "/image", bytes(150_000))), []
    read(reader, whole[1:])  # it had begun before
    assert reader.sequences == {}
    for number in range(8, 11):
        parts += list(fragments(number, "/image", bytes(150_000)))[:-1]
    read(reader, parts)
    assert (reader.sequences[SENDER].messages, reader.sequences[SENDER].lost) == (0, 2)


@pytest.mark.parametrize("whole", [True, False])
def test_the_size_of_large_messages_is_known_where_they_come_whole(*, whole):
    reader = Reader(whole=whole)
    read(reader, [short_message(2, "EXAMPLE", b"12345678abc")])
    assert reader.largest_whole == 0
    read(reader, list(fragments(4, "/image", bytes(150_000))))
    assert reader.largest_whole == (150_000 if whole else 0)


@pytest.mark.parametrize(("pause", "count"), [(INCOMPLETE, 1), (INCOMPLETE + 1, 0)])
def test_what_is_incomplete_for_long_is_forgotten(pause, count):
    reader = Reader(whole=True)
    first, *rest = fragments(7, "/image", bytes(150_000))
    reader.read(first, SENDER, 5)
    found = [reader.read(data, SENDER, 5 + pause) for data in rest]
    assert len([*filter(None, found)]) == count
