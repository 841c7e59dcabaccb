"""Short messages and fragments, spread over several sockets."""

from collections import Counter

import lcm
import pytest

from lcmtools.bus import group_receiver, multicast
from lcmtools.bus.multicast import sending_socket
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url

_URL = "udpm://239.255.76.67:7667?ttl=0"


@pytest.fixture
def usual_buffers(monkeypatch):
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 212_992)


@pytest.mark.usefixtures("private_network", "usual_buffers")
def test_short_messages_have_room_in_several_usual_buffers_and_come_in_order_once(wait_until):
    packets = []
    with Tap(parse_url(_URL), whole=True, spread=True) as tap:
        plain = lcm.LCM(_URL)
        for number in range(1600):  # a single buffer holds about 500
            plain.publish("SHORT" if number % 100 else "LARGE", number.to_bytes(4, "big") * 25)
        plain.publish("LARGE", bytes(300_000))

        def has_all():
            packets.extend(p for p in tap.receive(0.1) if p.channel != "LCM_SELF_TEST")
            return len(packets) >= 1601

        wait_until(has_all)
        (sequence,) = tap.numbered.values()
    payloads = [int.from_bytes(packet.payload[:4], "big") for packet in packets[:-1]]
    assert payloads == list(range(1600))
    assert len(packets[-1].payload) == 300_000
    assert (sequence.lost, sequence.restarts) == (0, 0)


@pytest.mark.usefixtures("private_network", "usual_buffers")
def test_malformed_datagrams_are_seen_once_beside_several_sockets(wait_until):
    url, seen = parse_url(_URL), Counter[str]()
    with Tap(url, whole=True, spread=True) as tap, sending_socket(url) as sender:
        for data in (b"", b"LC02", b"LC03", b"LC03" + bytes(10), b"LC99" + bytes(40), b"x"):
            sender.sendto(data, (url.host, url.port))
        sender.sendto(b"LC02\0\0\0\x07END\0", (url.host, url.port))

        def has_end():
            reader = tap._reader
            parsed = reader.read_all

            def counted(datagrams):
                every = list(datagrams)
                seen.update(data.hex() for data, *_ in every if not data.startswith(b"LC02\0"))
                return parsed(every)

            reader.read_all = counted
            found = tap.receive(0.1)
            reader.read_all = parsed
            return any(packet.channel == "END" for packet in found)

        wait_until(has_end)
        assert len(tap.malformed) == 1
    assert sorted(seen.values()) == [1] * 6


@pytest.mark.usefixtures("private_network", "usual_buffers")
def test_times_count_only_until_the_first_messages_were_read(wait_until):
    """A clock that is set back later must leave nothing out."""
    packets = []
    with Tap(parse_url(_URL), whole=True, spread=True) as tap:
        plain = lcm.LCM(_URL)

        def comes(channel):
            packets.extend(tap.receive(0.1))
            return channel in {packet.channel for packet in packets}

        plain.publish("FIRST", b"")
        wait_until(lambda: comes("FIRST"))
        assert tap._sockets.since == 0


@pytest.mark.usefixtures("private_network", "usual_buffers")
def test_what_full_buffers_drop_is_counted_though_they_are_empty_when_they_are_looked_at():
    url, burst, few = parse_url(_URL), 5000, 100
    with Tap(url, whole=True, spread=True) as tap, sending_socket(url) as sender:
        for count in (burst, few):
            before = tap.overflows()
            for number in range(count):
                data = b"LC02" + number.to_bytes(4, "big") + b"A\0"
                sender.sendto(data, (url.host, url.port))
            arrived = []
            while packets := tap.receive(0.1):
                arrived += packets
            lost = count - len(arrived)
            assert (lost > 0) == (count == burst)
            assert tap.overflows() - before >= lost
        assert tap.overflows() == before


@pytest.mark.usefixtures("private_network", "usual_buffers")
def test_a_clock_that_was_set_back_keeps_no_message_waiting(monkeypatch, wait_until):
    """Datagrams of the future would wait for hours, and be looked at all the time."""
    url, found = parse_url(_URL), list[int]()
    with Tap(url, whole=True, spread=True) as tap, sending_socket(url) as sender:

        def has(number):
            found.extend(int(p.payload) for p in tap.receive(0.1) if p.channel == "A")
            return number in found

        for number in range(20):
            if number == 10:
                monkeypatch.setattr(group_receiver.time, "time_ns", lambda: 1)
            data = b"LC02" + number.to_bytes(4, "big") + b"A\0%d" % number
            sender.sendto(data, (url.host, url.port))
            wait_until(lambda number=number: has(number))
        assert not tap._sockets.held
    assert found == [*range(20)]
