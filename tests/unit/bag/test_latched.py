"""What was latched before the start of a part of a log: it comes first."""

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

from lcmtools.bag.index_notes import IndexNotes
from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.bag.ring import Ring, SnapshotPlan
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.std_msgs import String
from lcmtools.wire.log_index import RecordedNode
from lcmtools.wire.packet import Packet, Sender

_S = 10**9
_START = 1_795_384_180 * _S
_SENDERS = [Sender("127.0.0.1", port) for port in range(3)]
_MESSAGES = (  # time, topic, text, index of the sender
    (0.0, "/map", "first map", 0),
    (0.1, "/map", "map", 0),
    (0.2, "/tf_static", "laser", 0),
    (0.3, "/tf_static", "camera", 1),
    (0.4, "/gone", "of a node that has left", 2),
    *((float(second), "/scan", str(second), 1) for second in range(1, 10)),
    (7.5, "/map", "new map", 0),
)
_LATCHED = ("map", "laser", "camera")


def _announced(number, *topics, leaving=False):
    ends = tuple(Endpoint(topic, Role.PUBLISHER, latched=True) for topic in topics)
    node = NodeInfo(f"/node{number}", str(number), "ada", number, endpoints=ends)
    return encode_announcement(Announcement(node, leaving=leaving))


def _packets():
    for time, topic, text, sender in sorted(_MESSAGES):
        payload = encode(String(data=text))
        yield Packet(topic, payload, _START + round(time * _S), _SENDERS[sender])


@pytest.fixture(autouse=True)
def _log(tmp_path, monkeypatch):
    """``in.lcmlog``, with announcements in its index; ``plain.lcmlog``, as lcm-logger writes it."""
    monkeypatch.chdir(tmp_path)
    with LogWriter("in.lcmlog") as log:
        numbers = [log.sender_number(one, "") for one in _SENDERS]
        for number, topics in enumerate((("/map", "/tf_static"), ("/tf_static",), ("/gone",))):
            log.add_node(RecordedNode(_START, numbers[number], _announced(number, *topics)))
        left = _announced(2, leaving=True)
        log.add_node(RecordedNode(_START + _S, numbers[2], left))
        for packet in _packets():
            log.add(packet, numbers[_SENDERS.index(packet.sender or _SENDERS[0])])
            log.flush()
    events = (encode_event(number, one) for number, one in enumerate(_packets()))
    Path("plain.lcmlog").write_bytes(b"".join(events))


def _texts(path):
    with LogFile(path) as log:
        return [
            ((one.time - _START) / _S, String.decode(one.payload).data) for one in log.packets()
        ]


@pytest.mark.parametrize(
    ("command", "start", "left"),
    [
        ("cut in.lcmlog out.lcmlog -s 5s -e 6s", 5, ["5", "6"]),
        ("cut in.lcmlog out.lcmlog -s end-4s -d 1s", 5, ["5", "6"]),
        ("filter in.lcmlog out.lcmlog -s 4s -e 6s", 4, ["4", "5", "6"]),
        ("downsample in.lcmlog out.lcmlog --every 2 -s 4s", 4, ["4", "6", "new map", "8"]),
        ("downsample in.lcmlog out.lcmlog -r 0.5 -s 4s", 4, ["4", "6", "new map", "8"]),
    ],
)
def test_a_part_begins_with_what_was_latched(command, start, left):
    assert main(["bag", *command.split()]) == 0
    found = _texts("out.lcmlog")
    assert found[:3] == [(start, text) for text in _LATCHED]
    assert [text for _, text in found[3:]] == left
    assert main(["bag", "cut", "out.lcmlog", "again.lcmlog", "-s", "end-0.5s"]) == 0
    assert [text for _, text in _texts("again.lcmlog")[:3]] == [*_LATCHED]  # it knows, too


def test_an_export_of_a_part_begins_with_what_was_latched():
    assert main(["bag", "export", "in.lcmlog", "out.jsonl", "-s", "7s", "-t", "/map"]) == 0
    rows = [json.loads(line) for line in Path("out.jsonl").read_text().splitlines()]
    assert [row["message"]["data"] for row in rows] == ["map", "new map"]
    assert rows[0]["time"] == _START + 7 * _S


@pytest.mark.parametrize(
    "command",
    ["cut {} out -s 5s", "filter {} out -s 5s", "export {} out.jsonl -s 5s"],
)
def test_a_log_that_cannot_tell_says_so(command, capsys):
    assert main(["bag", *command.format("plain.lcmlog").split()]) == 0
    assert_says(capsys.readouterr().err, "plain.lcmlog does not tell what was latched; ")
    assert main(["bag", "sort", "plain.lcmlog", "sorted.lcmlog"]) == 0
    assert not capsys.readouterr().err


def _played(player, count):
    found = [player.pop_due(0) for _ in range(count)]
    return [String.decode(one.payload).data for one in found if one]


def test_playing_from_a_time_a_seek_and_a_loop_begin_with_what_was_latched():
    with Playlist(["in.lcmlog"], Choice()) as playlist:
        assert {track.topic for track in playlist.tracks if track.is_latched} == {
            *("/map", "/tf_static", "/gone")
        }
        window = (_START + 5 * _S, _START + 6 * _S)
        player = Player(playlist.played, window, rate=0, loops=True)
        assert _played(player, 10) == 2 * [*_LATCHED, "5", "6"]
        player = Player(playlist.played, playlist.span, rate=0)
        player.seek(_START + 8 * _S, 0)
        assert _played(player, 9) == ["laser", "camera", "new map", "8", "9"]
        assert not [*playlist.untold()]
        assert [one.time for one in playlist.latched(_START + 6 * _S)] == [
            _START + _S // 10 * tenth for tenth in (1, 2, 3)
        ]
    with Playlist(["plain.lcmlog"], Choice()) as playlist:
        assert_says(*playlist.untold(), "plain.lcmlog does not tell what was latched")


def test_what_was_latched_in_a_pause_of_a_recording_follows_it():
    monitor = SimpleNamespace(losses=dict, types_of=lambda _: ())
    graph = SimpleNamespace(topics=lambda: [SimpleNamespace(name="/map", is_latched=True)])
    with ThreadPoolExecutor(1) as worker, LogWriter("paused.lcmlog") as writer:
        notes = IndexNotes(monitor, worker)
        notes.update(graph)
        packets = [*_packets()]
        notes.miss([one for one in packets if one.time < _START + 4 * _S])
        notes.add([one for one in packets if one.time >= _START + 8 * _S], writer)
        notes.add(packets[-1:], writer)
    assert _texts("paused.lcmlog") == [(8.0, "map"), (8.0, "8"), (9.0, "9"), (9.0, "9")]


def test_a_snapshot_begins_with_what_was_latched_before_it():
    monitor = SimpleNamespace(losses=dict, types_of=lambda _: ())
    graph = SimpleNamespace(topics=lambda: [SimpleNamespace(name="/map", is_latched=True)])
    ring = Ring(SnapshotPlan(1.0))
    with ThreadPoolExecutor(1) as worker, LogWriter("snapshot.lcmlog") as writer:
        notes = IndexNotes(monitor, worker)
        notes.update(graph)
        for packet in _packets():
            if packet.time < _START + 4 * _S:
                notes.hold(ring.add([packet], packet.time))
        notes.begin(writer, time=ring.packets[0].time)
        notes.add(list(ring.packets), writer)
    assert _texts("snapshot.lcmlog") == [(2.0, "map"), (2.0, "2"), (3.0, "3")]
