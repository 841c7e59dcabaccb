"""The notes of a recorder, as the index of a file has them."""

import tracemalloc
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest

from lcmtools.bag import index_notes
from lcmtools.bag.index_notes import IndexNotes
from lcmtools.bag.writer import LogWriter
from lcmtools.graph.builder import MOST_FINGERPRINTS
from lcmtools.graph.model import CallbackError, Endpoint, Node, Role
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.losses import Loss
from lcmtools.wire.log_index import LostMessages
from lcmtools.wire.packet import Packet, Sender

_ONE, _OTHER = Sender("10.0.0.7", 4001), Sender("10.0.0.8", 4002)


@pytest.fixture
def worker() -> Iterator[Executor]:
    with ThreadPoolExecutor(1) as pool:
        yield pool


def test_a_node_that_ends_at_once_is_named(tmp_path: Path, worker: Executor) -> None:
    monitor = SimpleNamespace(
        losses=dict, types_of=lambda _: (), graph=lambda: SimpleNamespace(nodes=())
    )
    end = Endpoint("/a", Role.PUBLISHER, ())
    node = Node("/_lcmtools_pub_7", "7", "h", 7, endpoints=(end,), tool=True)
    said = [Announcement(node), Announcement(node, leaving=True)]
    hello, goodbye = (Packet(NODE_CHANNEL, encode_announcement(one), 1000, _ONE) for one in said)
    notes = IndexNotes(monitor, worker)  # type: ignore[arg-type] # all that it needs
    with LogWriter(tmp_path / "a.lcmlog") as writer:
        notes.begin(writer)
        notes.add_announcement(hello, writer)
        notes.add([Packet("/a", b"", 1000, _ONE), Packet("/a", b"", 1000, _OTHER)], writer)
        notes.add_announcement(goodbye, writer)
        notes.annotate(writer, in_full=True)
    with LogFile(tmp_path / "a.lcmlog") as log:
        assert [str(packet.sender) for packet in log.packets()] == [node.name, str(_OTHER)]


def test_of_nodes_that_end_little_is_kept(worker: Executor) -> None:
    notes = IndexNotes(_quiet_monitor(), worker)  # type: ignore[arg-type] # all that it needs
    tracemalloc.start()
    try:
        for number in range(100):
            error = CallbackError("callback", "Error", "x" * 20_000, "a.py:1", 1, 1)
            node = Node(f"/n{number}", f"{number}", "h", number, errors=(error,))
            payload = encode_announcement(Announcement(node, leaving=True))
            notes.add_announcement(Packet(NODE_CHANNEL, payload, 1000, _ONE), None)
        assert tracemalloc.get_traced_memory()[0] < 1_000_000
    finally:
        tracemalloc.stop()


def test_losses_are_noted_with_the_time_of_the_message_that_showed_them(
    tmp_path: Path, worker: Executor
) -> None:
    known: dict[Sender, Loss] = {}
    monitor = SimpleNamespace(
        losses=lambda: dict(known),
        types_of=lambda _: (),
        graph=lambda: SimpleNamespace(nodes=()),
    )
    notes = IndexNotes(monitor, worker)  # type: ignore[arg-type] # all that it needs
    first, second = tmp_path / "a.lcmlog", tmp_path / "b.lcmlog"
    with LogWriter(first) as writer:
        notes.begin(writer)
        for time, lost in ((1000, Loss(0, 10)), (2000, Loss(2, 20)), (3000, Loss(1, 30))):
            known.update({_ONE: lost, _OTHER: Loss(5, 50)})
            notes.add([Packet("/a", b"", time, _ONE)], writer)
            notes.annotate(writer)
        assert notes.losses == {str(_ONE): Loss(1, 30)}
        notes.annotate(writer, in_full=True)
    with LogWriter(second) as writer:
        notes.begin(writer, is_split=True)
        known[_ONE] = Loss(4, 40)
        notes.add([Packet("/a", b"", 4000, _ONE), Packet("/b", b"", 4000, _OTHER)], writer)
        notes.annotate(writer, in_full=True)
    with LogFile(first) as log:
        noted = [(0, 10), (2, 10), (-1, 10)]
        assert log.index.lost == [
            LostMessages(time * 1000, {0: counts})
            for time, counts in zip((1, 2, 3), noted, strict=True)
        ]
    with LogFile(second) as log:
        assert [loss for _, loss in sorted(log.losses().items())] == [Loss(3, 10)]


def _quiet_monitor() -> SimpleNamespace:
    return SimpleNamespace(
        losses=dict, types_of=lambda _: (), graph=lambda: SimpleNamespace(nodes=())
    )


def test_payloads_that_are_not_of_lcm_are_looked_up_a_few_times(
    tmp_path: Path, worker: Executor, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_up: list[Packet] = []
    monkeypatch.setattr(
        index_notes, "recorded_types", lambda packets, _: looked_up.extend(packets) or []
    )
    notes = IndexNotes(_quiet_monitor(), worker)  # type: ignore[arg-type] # all that it needs
    with LogWriter(tmp_path / "a.lcmlog") as writer:
        notes.begin(writer)
        for number in range(10_000):
            notes.add([Packet("/junk", number.to_bytes(8, "big"), number, _ONE)], writer)
        notes.annotate(writer, in_full=True)
        assert writer.messages == 10_000
    assert len(looked_up) == MOST_FINGERPRINTS


def test_types_of_many_new_channels_are_looked_up_within_a_bound(
    tmp_path: Path, worker: Executor, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_up: list[Packet] = []
    monkeypatch.setattr(
        index_notes, "recorded_types", lambda packets, _: looked_up.extend(packets) or []
    )
    notes = IndexNotes(_quiet_monitor(), worker)  # type: ignore[arg-type] # all that it needs
    with LogWriter(tmp_path / "a.lcmlog") as writer:
        notes.begin(writer)
        for number in range(20_000):
            notes.add([Packet(f"/reply_{number}", bytes(8), number, _ONE)], writer)
        notes.add([Packet("/late", b"of a new type", 1, _ONE)], writer)
        notes.annotate(writer, in_full=True)
    assert len(looked_up) == 1001
    assert looked_up[-1].channel == "/late"
    with LogFile(tmp_path / "a.lcmlog") as log:
        assert len({packet.channel for packet in log.packets()}) == 20_001


def test_losses_of_a_sender_that_is_no_longer_known_stay(tmp_path: Path, worker: Executor) -> None:
    known = {_ONE: Loss(3, 10)}
    monitor = _quiet_monitor()
    monitor.losses = lambda: dict(known)
    notes = IndexNotes(monitor, worker)  # type: ignore[arg-type] # all that it needs
    with LogWriter(tmp_path / "a.lcmlog") as writer:
        notes.begin(writer)
        notes.add([Packet("/a", b"", 1, _ONE)], writer)
        notes.annotate(writer)
        known.clear()
        notes.annotate(writer, in_full=True)
    assert notes.losses == {str(_ONE): Loss(3, 10)}
