"""Observers on a bus with strangers: what they send costs a bounded amount of work and memory."""

from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import pytest
from fixtures.says import raises_saying

from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl
from lcmtools.errors import NothingReceived
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.graph.model import Endpoint, NodeInfo, Role, Traffic
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    decode_announcement,
    decode_probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.observe import node_requests
from lcmtools.observe.channels.activity import Activity
from lcmtools.observe.channels.rows import ChannelRows, ChannelSelection
from lcmtools.observe.reading import presence
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.presence import Presence
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.observe.reports import describe
from lcmtools.wire.packet import Packet, Sender

_NODE = NodeInfo("/talker", "id", "h", 1)


class Bus:
    """A bus on which a test says what arrives; ``sent`` is what was sent."""

    port = 0
    is_live, is_log, is_awaiting, has_strangers = True, False, False, False
    numbered: dict[Sender, Any] = {}  # noqa: RUF012 - never filled

    def __init__(self, answer=lambda *_: []):
        self._answer = answer
        self.sent = []
        self.waiting = []

    def receive(self, timeout):  # noqa: ARG002 - nothing else comes
        """What the test has put there."""
        packets, self.waiting = self.waiting, []
        return packets

    def send(self, channel, payload):
        """Keep it, and have it answered."""
        self.sent.append((channel, payload))
        self.waiting += self._answer(channel, payload)

    def close(self):
        """Nothing is open."""


@contextmanager
def _monitor(bus, on_outage=lambda _: None):
    with BusMonitor(BusUrl("memq", ""), "spy", {}, bus, on_outage=on_outage) as monitor:
        yield monitor


def test_that_more_is_on_the_bus_than_is_remembered_is_told_once():
    told = []
    bus = Bus()
    with _monitor(bus, told.append) as monitor:
        for _ in range(2):
            bus.waiting = [Packet(f"/reply_{n}", bytes(8), 1) for n in range(MOST_FLOWS + 10)]
            monitor.receive(0.0)
            monitor.receive(0.0)
    (sentence,) = told
    assert f"more than {MOST_FLOWS} channels" in sentence
    assert "no longer listed" in sentence


def test_it_announces_that_it_listens_to_a_bounded_number_of_topics():
    bus = Bus()
    node = _NODE._replace(endpoints=(Endpoint("/z", Role.PUBLISHER, ("a/B",)),))
    bus.waiting = [Packet(NODE_CHANNEL, encode_announcement(Announcement(node)), 1)]
    with _monitor(bus) as monitor:
        monitor.receive(0.0)
        monitor.listen_to([*(f"/reply_{n:05}" for n in range(5000)), "/z"])
        said = decode_announcement(bus.sent[-1][1])
    topics = [end.topic for end in said.node.endpoints]
    assert len(topics) == 2000
    assert topics[0] == "/z"  # whose publisher may wait for a subscriber


def _answering(lost):
    """A node that answers each probe but the first few, which are lost."""
    probes = []

    def answer(channel, payload):
        if channel != PROBE_CHANNEL or (probe := decode_probe(payload)) is None:
            return []
        probes.append(probe)
        if len(probes) <= lost:
            return []
        said = encode_announcement(Announcement(_NODE, answers=probe.nonce))
        return [Packet(NODE_CHANNEL, said, 1)]

    return answer


@pytest.mark.parametrize("lost", [0, 1, 3])
def test_a_ping_is_repeated_until_an_answer_comes(lost, monkeypatch):
    monkeypatch.setattr(node_requests, "_ASK_AGAIN", 0.01)
    bus = Bus(_answering(lost))
    with _monitor(bus) as monitor:
        assert 0 <= node_requests.ping(monitor, _NODE, 20.0) < 10
    probes = [payload for channel, payload in bus.sent if channel == PROBE_CHANNEL]
    assert len(set(probes)) == len(probes) == lost + 1


def test_a_node_that_answers_no_ping_is_told():
    with _monitor(Bus()) as monitor, raises_saying(NothingReceived, "/talker did not answer"):
        node_requests.ping(monitor, _NODE, 0.05)


def test_answers_to_a_flood_of_probes_take_a_tenth_of_the_time(monkeypatch):
    now = SimpleNamespace(wall=100.0, cpu=0.0)
    monkeypatch.setattr(presence.time, "monotonic", lambda: now.wall)
    monkeypatch.setattr(presence.time, "thread_time", lambda: now.cpu)
    sent = []

    def send(_channel, payload):
        sent.append(decode_announcement(payload))
        now.cpu += 0.01

    own = Presence(_NODE, send)
    for nonce in range(1, 1001):  # within a second
        own.answer(PROBE_CHANNEL, encode_probe(Probe("", nonce)))
        own.attend()
        now.wall += 0.001
    assert 9 <= len(sent) <= 11
    now.wall += 1.0
    own.attend()
    assert sent[-1] is not None
    assert sent[-1].answers == 1000  # who asked last, while it rested, is answered too


def test_the_socket_table_is_read_once_for_all_publishers(monkeypatch):
    read = []

    def reading():
        read.append(1)
        return SocketTable()

    monkeypatch.setattr(describe.SocketTable, "read", reading)
    senders = [Sender("127.0.0.1", port) for port in range(4000, 4500)]
    senders += [Sender("192.0.2.7", 4000), Sender("ada", 0, "driver")]
    texts = describe.program_texts([Traffic("/a", one, (), 1, 1, 1, 1) for one in senders])
    assert texts[0] == "a program of this computer, port 4000"
    assert texts[-2:] == ["a program on 192.0.2.7, port 4000", "driver (when it was recorded)"]
    assert read == [1]


def test_a_table_has_the_announced_and_the_latest_channels():
    bus, activity = Bus(), Activity(2.0)
    node = _NODE._replace(endpoints=(Endpoint("/z", Role.PUBLISHER, ("a/B",)),))
    bus.waiting = [Packet(NODE_CHANNEL, encode_announcement(Announcement(node)), 1)]
    bus.waiting += [Packet(f"/reply_{n:03}", bytes(8), n) for n in range(100)]
    with _monitor(bus) as monitor:
        monitor.receive(0.0)
        rows = ChannelRows(ChannelSelection(), SenderNames())
        shown, left_out = rows.make_most(3, monitor.graph(), activity, {})
    assert [row.channel for row in shown] == ["/reply_098", "/reply_099", "/z"]
    assert left_out == 98


def test_the_activity_of_channels_is_bounded_in_a_live_view():
    live, whole = Activity(2.0), Activity()
    for number in range(MOST_FLOWS + 10):
        for one in (live, whole):
            one.add(Packet(f"/reply_{number}", bytes(8), number))
    assert (len(live), len(whole)) == (MOST_FLOWS, MOST_FLOWS + 10)
