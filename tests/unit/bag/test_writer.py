"""Logs as they are written, and their index."""

import os

import lcm
import pytest
from fixtures.limits import small_files
from fixtures.says import raises_saying

from lcmtools.bag.writer import LogWriter
from lcmtools.errors import LcmtoolsError
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_ONE, _OTHER = Sender("127.0.0.1", 4001), Sender("127.0.0.1", 4002)
_MINUTE = 60_000_000_000


def _packet(number, channel="/a", size=8):
    return Packet(channel, bytes([number % 256]) * size, number * 1_000_000)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "ride.lcmlog"


def test_a_log_has_the_messages_in_order_with_their_senders(path):
    with LogWriter(path) as writer:
        senders = [writer.sender_number(_ONE, "/driver"), writer.sender_number(_OTHER, "b.py")]
        for number in range(10):
            writer.add(_packet(number, "/a" if number % 3 else "/b"), senders[number % 2])
            writer.flush()
    with LogFile(path) as log:
        found = list(log.packets())
    assert [packet.payload for packet in found] == [_packet(n).payload for n in range(10)]
    named = [_ONE._replace(name="/driver"), _OTHER._replace(name="b.py")]
    assert [packet.sender for packet in found] == named * 5
    assert [packet.time for packet in found] == [n * 1_000_000 for n in range(10)]


def test_a_log_that_was_not_closed_is_read_to_its_last_message(path):
    writer = LogWriter(path)
    number = writer.sender_number(_ONE, "/driver")
    for second in range(0, 40, 4):
        writer.add(_packet(second * 100), number)
        writer.flush()
    with LogFile(path) as log:
        found = list(log.packets())
        assert log.index.size is None
        assert log.index.blocks
    assert len(found) == 10
    assert found[0].sender == _ONE._replace(name="/driver")
    assert found[-1].sender is None  # behind the last block of the index
    writer.close()


def test_types_announcements_and_losses_are_kept(path):
    kind = RecordedType("a_msgs/A", 2**64 - 1, "a_msgs/A.lcm", "package a_msgs;\nstruct A {}\n")
    with LogWriter(path) as writer:
        writer.add_types([kind, kind])
        writer.add_node(RecordedNode(5, 0, b"\xff\x00"))
        writer.add_lost(LostMessages(5, {0: (1, 9)}))
        writer.add_lost(LostMessages(9, {0: (2, 11), 1: (1, 5)}))
    with LogFile(path) as log:
        assert log.index.types == {"a_msgs/A": kind}
        assert log.index.nodes == [RecordedNode(5, 0, b"\xff\x00")]
        assert [lost.time for lost in log.index.lost] == [5, 9]
        assert log.losses() == {}  # of senders that the index does not name
    assert index_path(path).read_text().count("a_msgs/A.lcm") == 1


def test_a_file_that_exists_is_replaced_only_when_forced(path):
    path.write_text("mine")
    with raises_saying(LcmtoolsError, "exists; ", "--force"):
        LogWriter(path)
    assert path.read_text() == "mine"
    LogWriter(path, force=True).close()
    assert path.read_bytes() == b""


def test_a_full_disk_leaves_whole_events(path):
    writer = LogWriter(path)
    for number in range(100):
        writer.add(_packet(number, size=300))
    with (
        small_files() as most,
        raises_saying(LcmtoolsError, "cannot write", "ride.lcmlog: File too large"),
    ):
        writer.flush()
    writer.close()
    assert most - 400 < path.stat().st_size <= most
    with LogFile(path) as log:
        found = list(log.packets())
    assert len(found) == path.stat().st_size // (28 + 2 + 300)
    assert path.stat().st_size % (28 + 2 + 300) == 0


def test_an_index_of_another_file_says_nothing(path):
    with LogWriter(path) as writer:
        writer.add(_packet(1), writer.sender_number(_ONE, "/driver"))
    path.write_bytes(path.read_bytes() * 2)
    with LogFile(path) as log:
        assert [packet.sender for packet in log.packets()] == [None, None]


def test_a_pipe_in_place_of_the_index_is_not_waited_for(path):
    LogWriter(path).close()
    index_path(path).unlink()
    os.mkfifo(index_path(path))
    with LogFile(path) as log:
        assert log.index.blocks == []


def test_the_times_of_the_index_are_those_of_the_log(path):
    with LogWriter(path) as writer:
        writer.add(Packet("/a", b"", 1_234_567))
        writer.add(Packet("/a", b"", 2_345_678))
    with LogFile(path) as log:
        (block,) = log.index.blocks
        times = [packet.time for packet in log.packets()]
    assert times == [block.first_time, block.last_time] == [1_234_000, 2_345_000]


def test_the_offset_of_a_time_is_not_behind_its_messages(path):
    times = [0, 3, 1, 2, 9, 4, 12]  # minutes: a block each, not all in order
    with LogWriter(path) as writer:
        for minute in times:
            writer.add(Packet("/a", b"", minute * _MINUTE))
            writer.add(Packet("/a", b"", minute * _MINUTE + _MINUTE // 2))
            writer.flush()
    with LogFile(path) as log:
        assert len(log.index.blocks) == len(times)
        for minute in times:
            left = [packet.time for packet in log.packets(log.offset_at(minute * _MINUTE))]
            wanted = [m for m in times if m >= minute]
            assert {m * _MINUTE for m in wanted} <= set(left)
        assert log.offset_at(9 * _MINUTE) > log.offset_at(3 * _MINUTE)


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_compressed_log_is_read_as_a_plain_one_even_cut_off(path, compression):
    with LogWriter(path, compression=compression) as writer:
        for number in range(10):
            writer.add(_packet(number, size=10_000), writer.sender_number(_ONE, "/driver"))
            writer.flush()
    assert path.stat().st_size < 10_000
    with LogFile(path) as log:
        found = list(log.packets())
        assert log.index.size == log.size
    assert [packet.payload for packet in found] == [
        _packet(n, size=10_000).payload for n in range(10)
    ]
    assert {packet.sender for packet in found} == {_ONE._replace(name="/driver")}
    path.write_bytes(path.read_bytes()[:-20])
    with LogFile(path) as log:
        assert len(list(log.packets())) == 9


def test_a_full_disk_leaves_whole_frames(path):
    writer = LogWriter(path, compression="lz4")
    for number in range(3):
        writer.add(Packet("/a", os.urandom(3000), number))
        writer.flush()
    writer.add(Packet("/a", os.urandom(3000), 4))
    with (
        small_files() as most,
        raises_saying(LcmtoolsError, "cannot write", "ride.lcmlog: File too large"),
    ):
        writer.flush()
    writer.close()
    assert path.stat().st_size <= most
    with LogFile(path) as log:
        assert len(list(log.packets())) == 3


def test_decompressing_makes_a_log_that_others_read(path):
    import zstandard

    with LogWriter(path, compression="zstd") as writer:
        writer.add(_packet(7))
    plain = path.with_suffix(".plain")
    with path.open("rb") as packed, plain.open("wb") as unpacked:
        zstandard.ZstdDecompressor().copy_stream(packed, unpacked)
    log = lcm.EventLog(str(plain), "r")
    assert [event.data for event in log] == [_packet(7).payload]
    log.close()
