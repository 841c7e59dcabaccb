"""One side of a relay, without a bus."""

import time
from types import SimpleNamespace

from lcmtools.bounded import MOST_ENTRIES
from lcmtools.graph.model import Endpoint, NodeInfo, Role, Traffic
from lcmtools.graph.protocol import MOST_OBSERVED, NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.relay.rules import Direction, Rules
from lcmtools.relay.side import Side
from lcmtools.wire.packet import Packet, Sender

_PLAIN, _NODE = Sender("10.0.0.1", 1), Sender("10.0.0.1", 2)


def _side(prefix=""):
    end = SimpleNamespace(takes_origin=False)
    return Side("1/0", "here", end, Direction(Rules(prefix=prefix), back=False))


def _hear(side, *packets, age=1_000_000_000):
    arrival = time.time_ns() - age
    heard = [Packet(channel, bytes(8), arrival, sender) for channel, sender in packets]
    side.sort(heard, _side(), passes=True)


def test_the_other_bus_is_told_what_plain_programs_send_and_what_of_it_passes():
    side = _side("robot7")
    node = NodeInfo("/driver", "id", "ada", 3)
    announced = Packet(NODE_CHANNEL, encode_announcement(Announcement(node)), time.time_ns(), _NODE)
    side.add_announcement(announced)
    _hear(side, ("/odom", _PLAIN), ("/odom", _PLAIN), ("/of_node", _NODE), ("/cmd_vel", _PLAIN))
    (told,) = side.observed()
    assert (told.channel, told.sender, told.bus) == ("/robot7/odom", Sender("ada", 1), "here")
    assert (told.messages, told.bytes, told.fingerprints) == (2, 16, (0,))


def test_programs_that_fell_silent_or_may_be_nodes_are_not_told_of():
    side = _side()
    _hear(side, ("/old", _PLAIN), age=20_000_000_000)
    _hear(side, ("/young", _PLAIN), age=0)
    assert side.observed() == ()
    assert side.has_new_route  # so it looks again soon


def test_a_server_that_tells_no_senders_is_told_of_by_channel():
    side = _side()
    _hear(side, ("/odom", None))
    (told,) = side.observed()
    assert (told.channel, told.sender) == ("/odom", None)


def test_what_another_relay_tells_of_is_passed_with_it_and_not_repeated():
    side = _side()
    seen = Traffic("/odom", Sender("ada", 1), (), 1, 8, 1, 1, bus="far")
    relay = Announcement(NodeInfo("/relay", "id", "ada", 3, observed=(seen,)))
    side.add_announcement(Packet(NODE_CHANNEL, encode_announcement(relay), time.time_ns()))
    _hear(side, ("/odom", None), ("/more", None))
    assert [told.channel for told in side.observed()] == ["/more"]


def test_a_flood_of_channels_is_told_of_up_to_a_bound():
    side = _side()
    _hear(side, *((f"/{number}", _PLAIN) for number in range(300)))
    assert len(side.observed()) == MOST_OBSERVED


def test_a_stranger_who_makes_senders_up_or_sends_images_fills_no_memory():
    side, other = _side(), _side()
    for port in range(1, 12_000):
        packet = Packet("/a", bytes(100), time.time_ns(), Sender("10.0.0.1", port))
        assert len(side.sort([packet], other, passes=True)[1]) == 1
    assert len(side._last) <= MOST_ENTRIES
    image = Packet("/b", bytes(1 << 20), time.time_ns(), Sender("10.0.0.1", 1))
    assert len(side.sort([image], other, passes=True)[1]) == 1
    assert ("/b", image.sender) not in side._last


def test_state_is_kept_however_many_channels_come():
    side = _side()
    latched = Endpoint("/map", Role.PUBLISHER, latched=True)
    node = Announcement(NodeInfo("/driver", "id", "ada", 3, endpoints=(latched,)))
    announced = encode_announcement(node)
    side.add_announcement(Packet(NODE_CHANNEL, announced, time.time_ns(), _NODE))
    _hear(side, ("/map", _NODE), age=0)
    _hear(side, *((f"/call_{number}", _PLAIN) for number in range(11_000)), age=0)
    other, now = _side(), time.time_ns()
    odd = [Packet("/odd", number.to_bytes(8, "big"), now, _PLAIN) for number in range(11_000)]
    side.sort(odd, other, passes=True)
    assert [message.channel for message in side.latched()] == ["/map"]
    assert len(side._routes) <= MOST_ENTRIES


def test_what_was_held_up_before_it_came_is_dropped_unless_it_is_state():
    side, other = _side(), _side()
    latched = Endpoint("/map", Role.PUBLISHER, latched=True)
    node = Announcement(NodeInfo("/driver", "id", "ada", 3, endpoints=(latched,)))
    now = time.time_ns()
    side.add_announcement(Packet(NODE_CHANNEL, encode_announcement(node), now, _NODE))
    old = [Packet(channel, bytes(8), now - 1_100_000_000, _NODE) for channel in ("/map", "/odom")]
    new = Packet("/odom", bytes(8), now - 500_000_000, _NODE)
    passed = side.sort([*old, new], other, passes=True)[1]
    assert [message.channel for message in passed] == ["/map", "/odom"]
    other.end = side.end = SimpleNamespace(
        trouble="", ports=(), dropped=0, losses=dict, takes_origin=False
    )
    assert (other.state(side).dropped, side.state(other).dropped) == (1, 0)
