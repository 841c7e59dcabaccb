"""The tap that takes heads only: the same with the kernel's filter and without."""

import socket
import time
from contextlib import ExitStack

import lcm
import pytest

from lcmtools.bus.multicast import sending_socket
from lcmtools.bus.socket_filter import heads_only
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    encode_announcement,
)
from lcmtools.wire.datagram import fragments, short_message
from lcmtools.wire.packet import Sender

_URL = parse_url("udpm://239.255.76.67:7667?ttl=0")
_GROUP = (_URL.host, _URL.port)


@pytest.fixture(params=[True, False], ids=["filter", "no filter"])
def tap(bus_url, request, monkeypatch):
    if not request.param:
        monkeypatch.setattr("lcmtools.bus.group_receiver.attach", _attach_none)
    with Tap(parse_url(bus_url)) as tap:
        yield tap


def _attach_none(*_):
    """Attach no filter, as on a system that has none."""
    return False


def _until(tap, channel):
    """The packets up to the first on a channel, without LCM's self tests."""
    packets = []
    deadline = time.monotonic() + 40
    while not any(packet.channel == channel for packet in packets):
        assert time.monotonic() < deadline, packets
        packets += [p for p in tap.receive(0.1) if p.channel != "LCM_SELF_TEST"]
    return packets


@pytest.mark.parametrize("size", [65_496, 131_000, 1_000_000])
def test_of_a_large_message_the_head_and_the_size_come(tap, bus_url, size):
    plain = lcm.LCM(bus_url)
    payload = bytes(range(200)) + bytes(size - 200)
    plain.publish("BIG", payload)
    plain.publish("END", b"")
    big, end = _until(tap, "END")
    assert (big.channel, big.size, big.whole_bytes) == ("BIG", size, size)
    assert payload.startswith(big.payload)
    assert big.fingerprint == int.from_bytes(payload[:8], "big")
    assert end.seqno == (big.seqno or 0) + 1


@pytest.mark.parametrize("size", [0, 1, 65_000])
def test_a_message_of_one_datagram_comes_whole(tap, bus_url, size):
    lcm.LCM(bus_url).publish("SMALL", bytes(size))
    (packet,) = _until(tap, "SMALL")
    assert (packet.payload, packet.whole_bytes, packet.size) == (bytes(size), None, size)


def test_the_graph_counts_the_bytes_of_whole_messages(tap, bus_url):
    plain, builder = lcm.LCM(bus_url), GraphBuilder()
    for _ in range(3):
        plain.publish("BIG", bytes(200_000))
    plain.publish("END", b"")
    for packet in _until(tap, "END"):
        builder.add(packet)
    (traffic,) = (seen for seen in builder.snapshot(0).traffic if seen.channel == "BIG")
    assert (traffic.messages, traffic.bytes) == (3, 600_000)


def test_an_announcement_comes_whole_however_large_it_is(tap):
    endpoints = tuple(Endpoint(f"/a_long_topic_name/{n}", Role.PUBLISHER) for n in range(2000))
    node = NodeInfo("/large", "1", "here", 1, endpoints=endpoints)
    payload = encode_announcement(Announcement(node))
    assert len(payload) > 100_000
    for end in ("END 1", "END 2"):  # the kernel lets the rest pass once it knows the sender
        tap.send(NODE_CHANNEL, payload)
        tap.send(end, b"")
        found = [packet for packet in _until(tap, end) if packet.channel == NODE_CHANNEL]
    assert [(packet.payload, packet.whole_bytes) for packet in found] == [(payload, None)]


def test_what_a_sender_lost_is_counted(tap, bus_url):
    url = parse_url(bus_url)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for seqno in (5, 6, 9, 8):
            sender.sendto(short_message(seqno, "A", b""), (url.host, url.port))
        for part in fragments(12, "BIG", bytes(100_000)):
            sender.sendto(part, (url.host, url.port))
        sender.sendto(short_message(13, "END", b""), (url.host, url.port))
        packets = _until(tap, "END")
    assert packets[0].sender is not None
    sequence = tap.sequences[packets[0].sender]
    assert (sequence.messages, sequence.lost) == (6, 3)


def test_the_time_to_live_of_a_sender_is_known(bus_url, tap):
    lcm.LCM(bus_url).publish("A", b"")
    (packet,) = _until(tap, "A")
    assert packet.sender is not None
    assert tap.ttls[packet.sender] == 0


def _hostile():
    head = b"LC03\0\0\0\1"
    short = [b"", b"L", b"LC0", b"LC02", b"LC02\0\0\0", b"LC03", b"LC03" + bytes(15)]
    bad = [head + bytes(12), head + b"\0\0\0\5\0\0\0\0\0\2\0\1abc", b"\xff" * 60_000]
    return [*short, *bad, head + b"\0\0\0\2\0\0\0\0\0\0\0\2A\0bcdef", b"LC02\0\0\0\0" + b"a" * 70]


@pytest.mark.usefixtures("private_network")
def test_both_ways_see_the_same_of_anything(monkeypatch):
    with ExitStack() as stack:
        taps = [stack.enter_context(Tap(_URL))]
        monkeypatch.setattr("lcmtools.bus.group_receiver.attach", _attach_none)
        taps.append(stack.enter_context(Tap(_URL)))
        seen = []
        senders = []
        for datagram in _hostile():
            plain = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            plain.sendto(datagram, _GROUP)
            senders.append(plain.getsockname()[1])
        plain.sendto(short_message(0, "END", b""), _GROUP)
        for tap in taps:
            seen.append([packet[:2] for packet in _until(tap, "END")])
            seen[-1].append(dict(tap.malformed))
        assert seen[0] == seen[1]
        later = senders.pop(8)  # a fragment that is not the first is not looked at
        assert [sender.port for sender in taps[0].malformed] == senders
        assert Sender("0.0.0.0", later) not in taps[0].malformed  # noqa: S104


@pytest.mark.usefixtures("private_network")
def test_a_tap_that_is_too_slow_knows_what_it_lost():
    with Tap(_URL, whole=True) as tap, Tap(_URL) as heads:
        assert tap.drops() == 0
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for seqno in range(3000):
                sender.sendto(short_message(seqno, "A", bytes(8000)), _GROUP)
        received = []
        while packets := tap.receive(0.1):
            received += packets
        dropped = tap.drops()
        assert dropped is not None
        assert dropped > 0
        assert dropped + len(received) == 3000 + _self_tests(received)
        assert heads.drops() is None


def _self_tests(packets):
    return sum(packet.channel == "LCM_SELF_TEST" for packet in packets)


@pytest.mark.usefixtures("private_network")
@pytest.mark.parametrize("longest_nap", [0.0, 0.01, 0.04, 0.1])
def test_a_stream_is_read_to_its_last_message(longest_nap):
    """Turns that follow each other at once begin with a nap, in which nothing may be lost."""
    with Tap(_URL) as tap, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        count, tap.longest_nap = 0, longest_nap
        for seqno in range(500):
            sender.sendto(short_message(seqno, "A", b"x"), _GROUP)
            count += sum(packet.channel == "A" for packet in tap.receive(0.001))
        deadline = time.monotonic() + 40
        while count < 500 and time.monotonic() < deadline:
            count += sum(packet.channel == "A" for packet in tap.receive(0.1))
        assert count == 500


@pytest.mark.usefixtures("private_network")
def test_a_request_ends_a_long_nap():
    with Tap(_URL) as tap, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        tap.longest_nap = 60.0
        for seqno in range(30):  # each message makes the next nap longer
            sender.sendto(short_message(seqno, "A", b"x"), _GROUP)
            tap.receive(0.05)
        sender.sendto(short_message(30, PROBE_CHANNEL, b""), _GROUP)
        begun = time.monotonic()
        found = tap.receive(60.0)
        assert PROBE_CHANNEL in [packet.channel for packet in found]
        assert time.monotonic() - begun < 30.0


def test_the_filter_is_short():
    assert len(heads_only()) <= 10


@pytest.mark.usefixtures("private_network")
def test_a_tap_of_large_messages_goes_on_with_them():
    with Tap(_URL, whole=True, large_only=True) as tap, sending_socket(_URL) as sender:
        found = []
        for number in range(3):
            sender.sendto(short_message(9, "SMALL", b""), _GROUP)
            for part in fragments(number, "BIG", bytes(200_000 + number)):
                sender.sendto(part, _GROUP)
            deadline = time.monotonic() + 20
            while len(found) == number and time.monotonic() < deadline:
                found += [len(packet.payload) for packet in tap.receive(0.1)]
        tap.pass_large(200_000)
        for number in (200_001, 200_000):
            for part in fragments(number, "BIG", bytes(number)):
                sender.sendto(part, _GROUP)
        while len(found) == 3 and time.monotonic() < deadline:
            found += [len(packet.payload) for packet in tap.receive(0.1)]
    assert found == [200_000, 200_001, 200_002, 200_000]
