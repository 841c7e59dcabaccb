"""A ping of a node among many others, which it answers together."""

import pytest

from lcmtools.errors import NothingReceived
from lcmtools.graph.model import Node
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.observe.node_requests import ping
from lcmtools.wire.packet import Packet

NODE = Node("/a", "id of a", "host", 1)


def _probe(nonce: int, target: str = "/a") -> Packet:
    return Packet(PROBE_CHANNEL, encode_probe(Probe(target, nonce)), 1)


def _answer(nonce: int, node: Node = NODE) -> Packet:
    announcement = Announcement(node, answers=nonce)
    return Packet(NODE_CHANNEL, encode_announcement(announcement), 1)


class Bus:
    """A monitor of a bus on which others say something after a request."""

    def __init__(self, *packets: Packet) -> None:
        self._packets, self._coming = packets, list[Packet]()

    def probe(self, _target: str, _nonce: int) -> None:
        """Let the others speak."""
        self._coming += self._packets

    def receive(self, _timeout: float) -> list[Packet]:
        """Return what they said."""
        found, self._coming = self._coming, []
        return found


@pytest.mark.parametrize(
    "flood", [1, 5000], ids=["another request", "more requests than are remembered"]
)
def test_the_answer_to_somebodys_later_request_counts(flood: int) -> None:
    others = [_probe(nonce) for nonce in range(7, 7 + flood)]
    bus = Bus(*others, _answer(6 + flood))
    assert 0 <= ping(bus, NODE, 60.0) < 60  # type: ignore[arg-type] # all of a monitor that it needs


@pytest.mark.parametrize(
    "packets",
    [
        [_answer(7)],
        [_answer(0), _probe(0), _answer(0)],
        [_probe(7, "/b"), _answer(7)],
        [_probe(7), _answer(7, NODE._replace(id="another run"))],
    ],
    ids=["an earlier request", "no request", "a request to another node", "another node"],
)
def test_nothing_else_counts(packets: list[Packet]) -> None:
    with pytest.raises(NothingReceived, match=r"/a did not answer within 0\.05 s"):
        ping(Bus(*packets), NODE, 0.05)  # type: ignore[arg-type] # likewise
