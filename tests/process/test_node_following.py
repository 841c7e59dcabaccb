"""Nodes that follow the graph of a real bus: what they know of the others, and how soon."""

import json
import time

import pytest

from lcmtools import Node
from lcmtools.arguments import split_arguments
from lcmtools.bus.group_receiver import ChannelSocket
from lcmtools.bus.kernel import SELECTIVE
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Endpoint, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    encode_announcement,
)
from lcmtools.node.context import Context
from lcmtools.types.std_msgs import String


@pytest.fixture
def join(bus_url):
    """``join()``: a program with nodes, on a connection of its own."""
    url, contexts = parse_url(bus_url), []
    said, _ = split_arguments([])

    def run():
        contexts.append(Context(UdpBus(url), said, {}, url=url))
        return contexts[-1]

    yield run
    for context in contexts:
        context.close()


@pytest.fixture
def channel_socket(bus_url):
    """``channel_socket()``: the inode of this process's only channel socket."""

    def find():
        table = SocketTable.read()
        (inode,) = table.marked(SELECTIVE) & table.listening(parse_url(bus_url))
        return inode

    return find


def _names(node):
    return [found.name for found in node.graph().nodes]


def _waiting_bytes(inode):
    row = SocketTable.read().rows[inode]
    return row.queued_bytes


def test_a_follower_knows_who_comes_changes_and_goes(join, wait_until):
    follower = Node("follower", context=join())
    other = Node("other", context=join())
    wait_until(lambda: _names(follower) == ["/follower", "/other"])
    subscription = other.create_subscription(String, "chatter", print)
    wait_until(lambda: "/chatter" in follower.subscribed_topics())
    other.destroy_subscription(subscription)
    wait_until(lambda: "/chatter" not in follower.subscribed_topics())
    other.destroy_node()
    wait_until(lambda: _names(follower) == ["/follower"])


def test_a_new_follower_asks_those_who_are_there(join, wait_until):
    probes = []
    other = join()
    other.bus.subscribe(PROBE_CHANNEL, lambda payload, _: probes.append(payload))
    follower = Node("follower", context=join())
    assert probes == []
    follower.graph()
    wait_until(lambda: probes)


@pytest.mark.usefixtures("private_network")
def test_announcements_do_not_pile_up_while_nobody_asks(join, channel_socket, wait_until):
    follower = Node("follower", context=join())
    other = Node("other", context=join())
    follower.graph()
    other.context.announcer.close()
    wait_until(lambda: _waiting_bytes(channel_socket()) == 0)
    payload = encode_announcement(Announcement(other.describe()))

    def wait_in_the_socket():
        other.context.bus.publish(NODE_CHANNEL, payload)
        return _waiting_bytes(channel_socket()) > 0

    wait_until(wait_in_the_socket)
    wait_until(lambda: _waiting_bytes(channel_socket()) == 0)


@pytest.mark.usefixtures("private_network")
def test_a_node_with_very_many_endpoints_is_known(join, channel_socket, wait_until):
    follower, sender = Node("follower", context=join()), join()
    follower.graph()
    assert channel_socket()
    endpoints = tuple(Endpoint(f"/topic{n}", Role.SUBSCRIBER, ("a/B",)) for n in range(2000))
    large = follower.describe()._replace(name="/large", id="1" * 32, endpoints=endpoints)
    payload = encode_announcement(Announcement(large))
    assert len(payload) > 66_000  # more than a datagram takes

    def is_known():
        sender.bus.publish(NODE_CHANNEL, payload)  # as nodes do again and again
        return "/large" in _names(follower)

    wait_until(is_known)
    Node("small", context=join())
    wait_until(lambda: "/small" in _names(follower))


@pytest.mark.usefixtures("private_network")
def test_a_followers_own_channel_socket_is_no_foreign_listener(join, channel_socket, wait_until):
    follower = Node("follower", context=join())
    follower.graph()
    assert channel_socket()
    wait_until(lambda: not follower.has_plain_listeners())


def test_a_channel_socket_is_left_with_the_bus(join, bus_url):
    context = join()
    Node("follower", context=context).graph()
    assert SocketTable.read().listening(parse_url(bus_url))
    context.close()
    assert not SocketTable.read().listening(parse_url(bus_url))


def test_a_channel_socket_takes_one_channel_whatever_else_comes(bus_url, wait_until):
    url = parse_url(bus_url)
    channel_socket, bus = ChannelSocket(url, "/a"), UdpBus(url)
    for channel, payload in (("/b", b"no"), ("/a", b"1"), ("/ab", b"no"), ("/", b""), ("/a", b"2")):
        bus.publish(channel, payload)
    received = []

    def has_all():
        received.extend(payload for payload, _ in channel_socket.receive())
        return received[-1:] == [b"2"]

    wait_until(has_all)
    bus.close()
    channel_socket.close()
    assert received == [b"1", b"2"]
    assert channel_socket.receive() == []


def test_what_waited_in_a_channel_socket_came_before_it_was_taken(
    bus_url, channel_socket, wait_until
):
    receiver, bus = ChannelSocket(parse_url(bus_url), "/a"), UdpBus(parse_url(bus_url))
    bus.publish("/a", b"1")
    wait_until(lambda: _waiting_bytes(channel_socket()) > 0)
    before = time.time_ns()
    ((_, arrival),) = receiver.receive()
    assert before - 10_000_000_000 < arrival <= before
    bus.close()
    receiver.close()


_FOLLOWER = """
import lcmtools
lcmtools.init()
node = lcmtools.Node("follower")
node.graph()
print("ready", flush=True)
lcmtools.spin(node)
"""
_TALKER = """
import time, lcm
bus = lcm.LCM()
for number in range(100_000):
    bus.publish("A", bytes(8) + bytes(100))
    if number == 3:
        print("ready", flush=True)
    time.sleep(0.002)
"""


@pytest.mark.usefixtures("private_network")
def test_wtf_does_not_blame_a_channel_socket_for_what_its_filter_drops(
    start_python, cli, channel_socket, bus_url
):
    for source in (_FOLLOWER, _TALKER):
        start_python(source, LCM_DEFAULT_URL=bus_url).wait_for("ready")
    row = SocketTable.read().rows[channel_socket()]
    assert row.drops > 0  # the kernel counts them
    found = json.loads(cli("wtf", "--json", "--wait", "0.5s", env={"LCM_DEFAULT_URL": bus_url}).out)
    assert "kernel-drops" not in [finding["rule"] for finding in found]
