"""The real bus: what goes over it, and that its sharp edges are covered."""

import threading
import time
from pathlib import Path

import pytest

from lcmtools.bus.kernel import IS_LINUX, SUBSCRIBED
from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.tap import Tap
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError, InvalidName


def test_a_message_arrives_with_the_time_it_came(bus, other, wait_until):
    heard = []
    other.subscribe("/chatter", lambda payload, arrival: heard.append((payload, arrival)))
    before = time.time_ns()
    bus.publish("/chatter", b"hello")
    wait_until(lambda: heard)
    payload, arrival = heard[0]
    assert payload == b"hello"
    assert before <= arrival <= time.time_ns()


@pytest.mark.parametrize(
    ("channel", "decoys"),
    [
        ("/a.b+", ["/aXb+", "/a.bb", "/a.b", "/a.b+c", "x/a.b+"]),
        ("A|B", ["A", "B", "AXX", "YB"]),
        (".*", ["a", ".", "..", "*"]),
        ("^a$", ["a"]),
        ("a\\b", ["a", "ab", "a\\\\b"]),
        ("(?i)a", ["A", "a"]),
        ("[ab]{2}", ["ab", "aa"]),
        ("a b\tc#d", ["abc", "ab c"]),
        ("été ☃", ["ete", "été"]),
        ("C" * 63, ["C" * 62]),
    ],
)
def test_every_character_of_a_channel_is_literal(bus, other, wait_until, channel, decoys):
    heard = []
    end = threading.Event()
    other.subscribe(channel, lambda payload, _: heard.append(payload))
    other.subscribe("END", lambda _payload, _time: end.set())
    for decoy in decoys:
        bus.publish(decoy, b"decoy")
    bus.publish(channel, b"meant")
    bus.publish("END", b"")
    wait_until(end.is_set)
    assert heard == [b"meant"]


def test_several_handlers_of_one_channel_hear_each_message_once(bus, other, wait_until):
    heard = []

    def one(_payload, _time):
        heard.append("one")

    other.subscribe("a", one)
    other.subscribe("a", lambda _payload, _time: heard.append("two"))
    bus.publish("a", b"")
    wait_until(lambda: len(heard) == 2)
    other.unsubscribe("a", one)
    bus.publish("a", b"")
    wait_until(lambda: len(heard) == 3)
    assert heard == ["one", "two", "two"]


def test_an_unsubscribed_channel_is_heard_no_more_until_subscribed_again(bus, other, wait_until):
    heard = []
    end = []

    def handler(payload, _time):
        heard.append(payload)

    other.subscribe("END", lambda payload, _: end.append(payload))
    other.subscribe("a", handler)
    other.unsubscribe("a", handler)
    other.unsubscribe("a", handler)
    bus.publish("a", b"1")
    bus.publish("END", b"")
    wait_until(lambda: end)
    other.subscribe("a", handler)
    bus.publish("a", b"2")
    wait_until(lambda: heard)
    assert heard == [b"2"]


def test_handlers_may_subscribe_and_unsubscribe(bus, other, wait_until):
    heard = []

    def late(_payload, _time):
        heard.append("late")

    def once(_payload, _time):
        heard.append("once")
        other.subscribe("b", late)
        other.unsubscribe("a", once)

    other.subscribe("a", once)
    bus.publish("a", b"")
    bus.publish("a", b"")
    wait_until(lambda: "once" in heard)
    bus.publish("b", b"")
    wait_until(lambda: "late" in heard)
    assert heard == ["once", "late"]


@pytest.mark.parametrize("channel", ["", "a" * 64, "é" * 32, "a\0b"])
def test_a_channel_that_lcm_cannot_carry_is_refused(bus, channel):
    with pytest.raises(InvalidName):
        bus.subscribe(channel, lambda _payload, _time: None)
    for payload in (b"", bytes(200_000)):
        with pytest.raises(InvalidName):
            bus.publish(channel, payload)


def test_a_channel_that_is_not_utf8_is_sent_by_udp_only_and_not_heard(bus, wait_until):
    with pytest.raises(InvalidName, match="UTF-8"):
        bus.subscribe("\udcff", lambda _payload, _time: None)
    with Tap(bus.url, whole=True) as tap:
        bus.publish("\udcff", b"x")
        wait_until(lambda: any(one.channel == "\udcff" for one in tap.receive(0.1)))
    memory = LcmBus(parse_url("memq://"))
    with pytest.raises(InvalidName, match="UTF-8"):
        memory.publish("\udcff", b"")
    memory.close()
    heard = []
    bus.subscribe("a", lambda payload, _: heard.append(payload))
    bus.publish("a", b"x")
    wait_until(lambda: heard)


def test_a_closed_bus_refuses_messages_and_subscriptions(bus_url):
    bus = UdpBus(parse_url(bus_url))
    bus.close()
    with pytest.raises(BusError, match="closed"):
        bus.publish("a", b"")
    with pytest.raises(BusError, match="closed"):
        bus.subscribe("a", lambda _payload, _time: None)
    bus.unsubscribe("a", lambda _payload, _time: None)


def test_closing_ends_the_threads_and_frees_the_descriptors(bus_url):
    def descriptors():
        return len(list(Path("/proc/self/fd").iterdir()))

    UdpBus(parse_url(bus_url)).close()
    threads, files = threading.active_count(), descriptors()
    for _ in range(10):
        bus = UdpBus(parse_url(bus_url))
        bus.subscribe("a", lambda _payload, _time: None)
        bus.publish("a", bytes(130_000))
        bus.close()
    assert threading.active_count() == threads
    assert descriptors() == files


def test_a_bus_within_the_process_works_without_a_network(wait_until):
    bus = LcmBus(parse_url("memq://"))
    heard = []
    bus.subscribe("a.b", lambda payload, _: heard.append(payload))
    bus.publish("aXb", b"decoy")
    bus.publish("a.b", b"x")
    bus.publish("a.b", bytes(1_000_000))
    wait_until(lambda: len(heard) == 2)
    assert heard == [b"x", bytes(1_000_000)]
    assert bus.ports == []
    bus.close()


def test_the_kernel_drops_what_a_bus_does_not_subscribe(bus, other, bus_url, wait_until):
    heard = []

    def dropped():
        table = SocketTable.read()
        found = table.marked(SUBSCRIBED) & table.listening(parse_url(bus_url))
        return [table.rows[inode].drops for inode in found]

    assert dropped() == []
    other.subscribe("a", lambda payload, _: heard.append(payload))
    other.subscribe("end", lambda payload, _: heard.append(payload))
    assert dropped() == ([0] if IS_LINUX else [])
    for channel in ("a", "ab", "b", "end"):
        bus.publish(channel, channel.encode())
    wait_until(lambda: heard == [b"a", b"end"])
    assert dropped() == ([2] if IS_LINUX else [])
