"""A recorder's notes on senders, without a bus."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

from lcmtools.bag.index_notes import IndexNotes
from lcmtools.bag.writer import LogWriter
from lcmtools.graph.model import NodeInfo, RelayStep
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.wire.packet import Packet, Sender

_SENDERS = _HERE, _RELAY = Sender("10.0.0.1", 1), Sender("10.0.0.1", 2)


def test_a_node_that_left_behind_a_relay_gives_the_relay_no_name(tmp_path):
    graph = SimpleNamespace(nodes=())
    monitor = SimpleNamespace(losses=dict, types_of=lambda _: (), graph=lambda: graph)
    near = NodeInfo("/near", "1", "ada", 7)
    far = NodeInfo("/far", "2", "bob", 7, path=(RelayStep("r", "/relay", "0"),))
    path = tmp_path / "a.lcmlog"
    with ThreadPoolExecutor(1) as worker, LogWriter(path) as writer:
        notes = IndexNotes(monitor, worker)
        notes.begin(writer)
        for node, sender in zip((near, far), _SENDERS, strict=True):
            payload = encode_announcement(Announcement(node, leaving=True))
            notes.add_announcement(Packet(NODE_CHANNEL, payload, 1, sender), writer)
        notes.add([Packet("/a", bytes(8), 1, sender) for sender in _SENDERS], writer)
        notes.annotate(writer, in_full=True)
    with LogFile(path) as log:
        names = [packet.sender and packet.sender.name for packet in log.packets()]
    assert names == ["/near", str(_RELAY)]
