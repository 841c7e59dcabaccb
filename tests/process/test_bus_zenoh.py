"""A bus that is Zenoh: nodes and commands, as on any other."""

import os
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from typing import Any

import pytest

from lcmtools.bus.url import BusUrl, parse_url
from lcmtools.bus.zenoh_bus import ZenohBus
from lcmtools.bus.zenoh_listener import ZenohListener
from lcmtools.graph.protocol import PROBE_CHANNEL, Probe, encode_probe
from lcmtools.labs.nodes.talker import Talker
from lcmtools.wire.packet import Packet
from lcmtools.wire.stamp import Origin

WaitUntil = Callable[..., None]


@pytest.fixture
def bus_url(free_port: Callable[[], int], monkeypatch: pytest.MonkeyPatch) -> str:
    """A bus of Zenoh that belongs to this test alone and stays on this computer."""
    monkeypatch.setenv("LCM_DEFAULT_URL", f"zenoh://224.0.0.224:{free_port()}")
    return os.environ["LCM_DEFAULT_URL"]


@contextmanager
def _listening(url: BusUrl) -> Iterator[ZenohListener]:
    """A listener that all others know of: they have answered it."""
    with ZenohListener(url) as listener:
        listener.send(PROBE_CHANNEL, encode_probe(Probe()))
        while listener.is_awaiting or listener.receive(0.0):
            listener.receive(0.1)
        yield listener


def _receive(listener: ZenohListener, count: int) -> list[Packet]:
    packets: list[Packet] = []
    while len(packets) < count:
        packets += listener.receive(20.0)
    return packets


def test_zenoh_carries_channels_of_any_name(bus_url: str) -> None:
    url, heard = parse_url(bus_url), []
    names = ["/a/b", "EXAMPLE", "odom#nav_msgs.Odometry", "a *?$ b", "@x", "/", "ä"]
    with closing(ZenohBus(url)) as bus, _listening(url) as listener:
        for name in names:
            bus.subscribe(name, lambda payload, _: heard.append(payload))
            bus.publish(name, name.encode())
        packets = _receive(listener, len(names))
    assert [packet.channel for packet in packets] == names
    assert heard == [name.encode() for name in names]


def test_zenoh_says_who_sent_what(bus_url: str) -> None:
    url = parse_url(bus_url)
    with closing(ZenohBus(url)) as bus, _listening(url) as listener:
        bus.publish("a", b"own")
        bus.publish("a", b"relayed", origin=Origin(7, 8, 2))
        own, relayed = _receive(listener, 2)
        assert own.sender == relayed.sender != listener.sender
        assert own.seqno is not None
        assert own.origin == Origin(int(own.sender.address, 16), own.seqno)
        assert relayed.origin == Origin(7, 8, 2)
        assert listener.numbered[own.sender].lost == 0


def test_commands_look_at_zenoh(cli: Any, start_node: Any) -> None:
    start_node(Talker, "__ns:=/a")
    assert "/a/chatter" in cli("list").ok().splitlines()
    assert "/a/talker" in cli("info", "/a/chatter").ok()
    assert "hello world" in cli("echo", "-n", "1", "/a/chatter").ok()
    assert cli("node", "list").ok().splitlines() == ["/a/talker"]
