"""A ping of a node among many others, which it answers together."""

import pytest

from lcmtools.errors import NothingReceived
from lcmtools.graph.model import Graph, NodeInfo, Staleness
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.observe.node_requests import ping, pings
from lcmtools.wire.packet import Packet

NODE = NodeInfo("/a", "id of a", "host", 1)


def _probe(nonce, target="/a"):
    return Packet(PROBE_CHANNEL, encode_probe(Probe(target, nonce)), 1)


def _answer(nonce, node=NODE):
    announcement = Announcement(node, answers=nonce)
    return Packet(NODE_CHANNEL, encode_announcement(announcement), 1)


class Bus:
    """A monitor of a bus on which others say something after a request."""

    def __init__(self, *packets, nodes=(NODE,)):
        self._packets, self._coming, self._nodes = packets, list[Packet](), nodes

    def graph(self):
        """Return the nodes on the bus."""
        return Graph(self._nodes)

    def probe(self, _target, _nonce):
        """Let the others speak."""
        self._coming += self._packets

    def receive(self, _timeout):
        """Return what they said."""
        found, self._coming = self._coming, []
        return found


@pytest.mark.parametrize(
    "flood", [1, 5000], ids=["another request", "more requests than are remembered"]
)
def test_the_answer_to_somebodys_later_request_counts(flood):
    others = [_probe(nonce) for nonce in range(7, 7 + flood)]
    bus = Bus(*others, _answer(6 + flood))
    assert 0 <= ping(bus, NODE, 60.0) < 60


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
def test_nothing_else_counts(packets):
    with pytest.raises(NothingReceived, match=r"/a did not answer within 0\.05 s"):
        ping(Bus(*packets), NODE, 0.05)


@pytest.mark.parametrize(
    ("others", "is_found"),
    [
        ((), True),
        ((NODE._replace(stale=Staleness.ENDED),), True),
        ((NODE,), False),  # two nodes of one name
    ],
)
def test_a_node_that_was_started_anew_answers_from_then_on(others, *, is_found):
    again = NODE._replace(id="its next run", pid=2, start_time=NODE.start_time + 1)
    bus = Bus(_probe(7), _answer(7, again), nodes=(*others, again))
    answers = pings(bus, NODE, 0.05)
    if is_found:
        assert [next(answers)[0].id for _ in range(2)] == [again.id] * 2
    else:
        with pytest.raises(NothingReceived):
            next(answers)
