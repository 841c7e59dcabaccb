"""Whole messages of channels that change, beside a monitor that reads heads only."""

import threading
from collections.abc import Callable, Iterator

import pytest

from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.observe.channels.feed import Feed
from lcmtools.observe.channels.rows import ChannelSelection
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Packet

LARGE = {"A": b"a" * 200_000, "AB": b"b" * 300_000, "C": b"c" * 100_000}


@pytest.fixture
def feed(bus_url: str) -> Iterator[Feed]:
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor:
        feed = Feed(monitor, ChannelSelection())
        feed.listens_to_all = False
        feed.start()
        yield feed
        feed.stop()


def buses() -> int:
    return sum(thread.name == "bus receiver" for thread in threading.enumerate())


def test_large_messages_of_several_channels_come_whole_by_one_bus(
    feed: Feed, bus: UdpBus, wait_until: Callable[..., None]
) -> None:
    taken: dict[str, list[Packet]] = {name: [] for name in LARGE}

    def has_come(*names: str) -> bool:
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


def test_an_end_is_for_its_taker_only(
    feed: Feed, bus: UdpBus, wait_until: Callable[..., None]
) -> None:
    first: list[Packet] = []
    second: list[Packet] = []

    def publish() -> None:
        bus.publish("SMALL", b"12345678")

    end = feed.follow("SMALL", first.append)
    feed.follow("SMALL", second.append)
    wait_until(lambda: publish() or (first and second))
    end()
    wait_until(lambda: publish() or len(second) > len(first))  # one that was on its way is over
    count = len(first)
    wait_until(lambda: publish() or len(second) > count + 3)
    assert len(first) == count


def test_only_what_is_followed_is_announced_unless_all_is_wanted(
    feed: Feed, bus_url: str, wait_until: Callable[..., None]
) -> None:
    with BusMonitor(parse_url(bus_url), "other", {}) as other:

        def heard() -> set[str]:
            other.receive(0.05)
            return {end.topic for node in other.graph().nodes for end in node.endpoints}

        end = feed.follow("/wanted", lambda _: None)
        wait_until(lambda: heard() == {"/wanted"})
        end()
        wait_until(lambda: "/wanted" not in heard())
