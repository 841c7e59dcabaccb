"""One side of a relay, without a bus."""

from types import SimpleNamespace
from typing import Any

from lcmtools.relay.rules import Direction, Rules
from lcmtools.relay.side import Side
from lcmtools.wire.packet import Packet, Sender


def _side() -> Side:
    end: Any = SimpleNamespace(takes_origin=False)
    return Side("1/0", "here", end, Direction(Rules(), back=False))


def test_a_stranger_who_makes_senders_up_or_sends_images_fills_no_memory() -> None:
    side, other = _side(), _side()
    for port in range(1, 12_000):
        packet = Packet("/a", bytes(100), 1, Sender("10.0.0.1", port))
        assert len(side.sort([packet], other, passes=True)[1]) == 1
    assert len(side._last) <= 10_000
    image = Packet("/b", bytes(1 << 20), 1, Sender("10.0.0.1", 1))
    assert len(side.sort([image], other, passes=True)[1]) == 1
    assert ("/b", image.sender) not in side._last
