"""The nodes, senders, types and losses that a log knows, beside its messages."""

import struct

import pytest

from lcmtools.bag.writer import LogWriter
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.graph.model import Endpoint, NodeInfo, Role, Staleness
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import candidates, message_class
from lcmtools.messages.supply import set_supply
from lcmtools.observe import messages
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames, is_here
from lcmtools.observe.reading.sources import LogObserver
from lcmtools.observe.reports.describe import program_texts
from lcmtools.types.std_msgs import String
from lcmtools.wire.log_events import SYNC
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_HERE = Sender("127.0.0.1", 45678)
_SECOND = 1_000_000_000
_BUMP = RecordedType(
    "odd_msgs/Bump", 0, "odd_msgs/Bump.lcm", "package odd_msgs;\nstruct Bump { int8_t side; }\n"
)
_OTHER_STRING = RecordedType(
    "std_msgs/String", 0, "std_msgs/String.lcm", "package std_msgs;\nstruct String { int8_t n; }\n"
)


@pytest.fixture(autouse=True)
def own_supply(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    set_supply(None)
    yield
    set_supply(None)


def _string(text):
    message = String()
    message.data = text
    return encode(message)


def _node(name):
    publisher = Endpoint("/chatter", Role.PUBLISHER, ("std_msgs/String",))
    return NodeInfo(name, f"id-of-{name}", "ada", 12, endpoints=(publisher,))


def _monitor(path):
    return BusMonitor(BusUrl("file", str(path)), "test", {}, LogObserver(str(path)))


@pytest.fixture
def path(tmp_path):
    """A log of a node that left, of one that stayed, and of a program."""
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as log:
        stayed, left, program = (
            log.sender_number(_HERE._replace(port=port), name)
            for port, name in ((1, "/talker"), (2, "/gone"), (45678, "driver.py (pid 7)"))
        )
        for sender, name in ((stayed, "/talker"), (left, "/gone")):
            said = encode_announcement(Announcement(_node(name)))
            log.add_node(RecordedNode(_SECOND, sender, said))
        said = encode_announcement(Announcement(_node("/gone"), leaving=True))
        log.add_node(RecordedNode(2 * _SECOND, left, said))
        for second in range(1, 60):
            log.add(Packet("/chatter", _string(str(second)), second * _SECOND), stayed)
            log.add(Packet("RAW", b"\1" * 8, second * _SECOND), program)
        log.add_lost(LostMessages(0, {stayed: (3, 90)}))
    return path


def test_a_log_knows_its_nodes_whenever_they_were_there(path):
    with _monitor(path) as monitor:
        graph = monitor.settle()
        losses = monitor.losses()
    assert [(node.name, node.stale) for node in graph.nodes] == [
        ("/gone", Staleness.NOT),
        ("/talker", Staleness.NOT),
    ]
    assert not any(map(is_here, graph.nodes))
    assert graph.topic("/chatter").types == ("std_msgs/String",)
    assert [str(seen.sender) for seen in graph.foreign()] == ["driver.py (pid 7)"]
    assert losses == {Sender("127.0.0.1", 1, "/talker"): Loss(3, 90)}


def test_the_processes_of_this_computer_do_not_name_senders_of_a_log(path):
    def read(_):
        raise AssertionError("looked into the system's table")

    with _monitor(path) as monitor:
        seen = monitor.settle().foreign()[0]
    names = SenderNames(read)
    names.update([seen.sender])
    assert names.name(seen.sender) == "driver.py (pid 7)"
    assert program_texts([seen]) == ["driver.py (pid 7) (when it was recorded)"]


def test_arrivals_have_the_senders_of_the_recording(path):
    found = list(messages("/chatter", log=path))
    assert {arrival.sender for arrival in found} == {"/talker"}
    assert [arrival.time for arrival in found] == [n * _SECOND for n in range(1, 60)]


def test_types_that_are_not_installed_come_from_the_log(tmp_path):
    # lcm-gen's fingerprint of a struct with one int8_t, which a second look-up must find again
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as log:
        log.add_types([_BUMP, _OTHER_STRING])
        log.add(Packet("/a", b"", 1))
    with _monitor(path):
        number = message_class("odd_msgs/Bump")().get_hash()
        other = next(n for n in _fingerprints() if n != String().get_hash())
        assert candidates(number) == ["odd_msgs/Bump"]
        assert candidates(other) == ["std_msgs/String"]
        assert message_class("std_msgs/String") is String
        assert message_class("std_msgs/String", other).__slots__ == ["n"]
    with LogWriter(path, force=True) as log:
        log.add_types([_BUMP, _OTHER_STRING])
        log.add(Packet("/a", struct.pack(">Qb", number, 5), 1000))
        log.add(Packet("/b", struct.pack(">Qb", other, 6), 2000))
    set_supply(None)
    found = [arrival.message for arrival in messages("/*", log=path)]
    assert [type(one).__name__ for one in found] == ["Bump", "String"]
    assert vars_of(found) == [{"side": 5}, {"n": 6}]


def _fingerprints():
    from lcmtools.packages.user_types import user_types

    return [
        number
        for source in user_types().recorded()
        for name, number in source.fingerprints.items()
        if name == "std_msgs/String"
    ]


def vars_of(found):
    return [{name: getattr(one, name) for name in one.__slots__} for one in found]


@pytest.mark.parametrize(
    ("head", "text"),
    [
        (b"\x89MCAP0\r\n", "is not an LCM log but an MCAP file; lcmtools bag import "),
        (b"#ROSBAG V2.0\n", "is not an LCM log but a ROS bag; lcmtools bag import "),
        (b"SQLite format 3\0", "is not an LCM log but an SQLite database, like a ROS 2 bag; "),
        (b"\x89PNG\r\n\x1a\n", "is not an LCM log but a PNG image"),
        (b"no log of anything", "there are no messages in .*; it is not an LCM log"),
    ],
)
def test_a_foreign_file_is_named(head, text, tmp_path):
    (tmp_path / "a.file").write_bytes(head * 10)
    with pytest.raises(BusError, match=text):
        LogObserver(str(tmp_path / "a.file"))


@pytest.mark.parametrize("written", [0, 2, 30])
def test_a_log_whose_first_message_is_being_written_is_empty_so_far(written, tmp_path):
    file = tmp_path / "ride.lcmlog"
    file.write_bytes((SYNC + bytes(100))[:written])
    with LogFile(file) as log:
        assert list(log.events()) == []
