"""Whole messages of channels that change, beside a monitor that reads heads only."""

import threading

import pytest

from lcmtools.bus.url import parse_url
from lcmtools.observe.channels.feed import Feed
from lcmtools.observe.channels.rows import ChannelSelection
from lcmtools.observe.reading.monitor import BusMonitor

LARGE = {"A": b"a" * 200_000, "AB": b"b" * 300_000, "C": b"c" * 100_000}


@pytest.fixture
def feed(bus_url):
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor:
        feed = Feed(monitor, ChannelSelection())
        feed.listens_to_all = False
        feed.start()
        yield feed
        feed.stop()


def buses():
    return sum(thread.name == "bus receiver" for thread in threading.enumerate())


def test_large_messages_of_several_channels_come_whole_by_one_bus(feed, bus, wait_until):
    taken = {name: [] for name in LARGE}

    def has_come(*names):
        for name, payload in LARGE.items():
            bus.publish(name, payload)
        return all(taken[name] for name in names)

    before = buses()
    ends = [feed.follow("A", taken["A"].append)]
    wait_until(lambda: has_come("A"))
    ends += [feed.follow(name, taken[name].append) for name in ("AB", "C")]
    wait_until(lambda: has_come("AB", "C"))
    assert buses() == before + 1
    for name, payload in LARGE.items():
        assert {(packet.channel, packet.payload) for packet in taken[name]} == {(name, payload)}
    for end in ends:
        end()
        end()  # the second time does nothing
    feed.stop()
    assert buses() == before


def test_an_end_is_for_its_taker_only(feed, bus, wait_until):
    first = []
    second = []

    def publish():
        bus.publish("SMALL", b"12345678")

    end = feed.follow("SMALL", first.append)
    feed.follow("SMALL", second.append)
    wait_until(lambda: publish() or (first and second))
    end()
    wait_until(lambda: publish() or len(second) > len(first))  # one that was on its way is over
    count = len(first)
    wait_until(lambda: publish() or len(second) > count + 3)
    assert len(first) == count


def test_only_what_is_followed_is_announced_unless_all_is_wanted(feed, bus_url, wait_until):
    with BusMonitor(parse_url(bus_url), "other", {}) as other:

        def heard():
            other.receive(0.05)
            return {end.topic for node in other.graph().nodes for end in node.endpoints}

        end = feed.follow("/wanted", lambda _: None)
        wait_until(lambda: heard() == {"/wanted"})
        end()
        wait_until(lambda: "/wanted" not in heard())
