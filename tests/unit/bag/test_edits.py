"""Logs made of logs."""

import json
from pathlib import Path

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, decode_announcement, encode_announcement
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.losses import Loss
from lcmtools.types.std_msgs import Float64, String
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_SECOND = 1_000_000_000
_START = 1_795_384_180 * _SECOND
_ONE, _OTHER = Sender("127.0.0.1", 1), Sender("127.0.0.1", 2)
_TYPE = RecordedType("a_msgs/A", 5, "a_msgs/A.lcm", "package a_msgs; struct A { int8_t a; }")


def _number(value):
    return Float64(data=value).encode()


def _text(text):
    return String(data=text).encode()


@pytest.fixture(autouse=True)
def path(tmp_path, monkeypatch):
    """A log of 100 s: /a/number at 10 Hz and /chatter at 1 Hz, by two senders."""
    monkeypatch.chdir(tmp_path)
    with LogWriter("in.lcmlog") as log:
        one, other = log.sender_number(_ONE, "/driver"), log.sender_number(_OTHER, "talker.py")
        ends = (
            Endpoint("/a/number", Role.PUBLISHER, ("std_msgs/Float64",)),
            Endpoint("/a/silent", Role.SUBSCRIBER),
        )
        said = encode_announcement(
            Announcement(NodeInfo("/driver", "id", "ada", 1, endpoints=ends))
        )
        log.add_node(RecordedNode(_START, one, said))
        log.add_types([_TYPE])
        for tenth in range(1000):
            time = _START + tenth * _SECOND // 10
            log.add(Packet("/a/number", _number(tenth), time), one)
            if tenth % 10 == 0:
                log.add(Packet("/chatter", _text(str(tenth)), time), other)
            log.flush()
        log.add_lost(LostMessages(_START + 20 * _SECOND, {one: (2, 202), other: (-1, 20)}))
        log.add_lost(LostMessages(_START + 80 * _SECOND, {one: (1, 601), other: (1, 60)}))
    return tmp_path / "in.lcmlog"


def _read(name):
    with LogFile(name) as log:
        return list(log.packets())


def _bag(*words):
    assert main(["bag", *words]) == 0


def _times(packets):
    return [(packet.time - _START) / 1e9 for packet in packets]


def test_filter_keeps_what_meets_the_condition_with_its_senders():
    _bag("filter", "in.lcmlog", "out.lcmlog", "m.data >= 990 or data == 5", "-t", "/a")
    found = _read("out.lcmlog")
    assert [packet.payload for packet in found] == [_number(n) for n in (5, *range(990, 1000))]
    assert {packet.sender for packet in found} == {_ONE._replace(name="/driver")}
    with LogFile("out.lcmlog") as log:
        assert log.index.types == {"a_msgs/A": _TYPE}
        assert log.losses() == {_ONE._replace(name="/driver"): Loss(3, 803)}
        assert log.senders[log.index.nodes[0].sender].name == "/driver"
        assert log.index.size == log.size


@pytest.mark.parametrize(
    "words",
    [
        ("/a/number", "m.data >= 990", "--keep-others"),
        ("m.data >= 990", "-t", "/a/*", "--keep-others"),
        ("/a", "m.data >= 990", "--keep-others", "-x", "/none/**"),
    ],
)
def test_a_condition_for_one_topic_keeps_the_others(words, capsys):
    is_wrong = "-x" in words  # there is no such topic
    assert main(["bag", "filter", "in.lcmlog", "out.lcmlog", *words]) == is_wrong
    if is_wrong:
        assert_says(capsys.readouterr().err, "there is no topic /none")
        return
    found = _read("out.lcmlog")
    assert [one.payload for one in found if one.channel == "/a/number"] == [
        _number(n) for n in range(990, 1000)
    ]
    assert len(found) == 110


def test_a_condition_after_a_topic_is_for_it_alone(capsys):
    _bag("filter", "in.lcmlog", "out.lcmlog", "/a/number", "m.data >= 990")
    assert {packet.channel for packet in _read("out.lcmlog")} == {"/a/number"}
    for words in (["m.data > 1", "--keep-others"], ["--keep-others"], ["/a", "/b", "m.data > 1"]):
        assert main(["bag", "filter", "in.lcmlog", "out2.lcmlog", *words]) == 2
    assert_says(capsys.readouterr().err, "name a topic and its condition", "too many arguments: /b")


def test_filter_leaves_out_topics_and_times():
    _bag("filter", "in.lcmlog", "out.lcmlog", "-x", "/a", "-s", "10s", "-e", "end-10s")
    found = _read("out.lcmlog")
    assert {packet.channel for packet in found} == {"/chatter"}
    assert _times(found) == list(range(10, 90))


def test_filter_says_how_topics_and_times_are_chosen(capsys):
    assert main(["bag", "filter", "in.lcmlog", "out.lcmlog", "topic == '/a' and t.secs > 3"]) == 2
    assert capsys.readouterr().err.endswith("; -t chooses topics, -s and -e times\n")
    assert not Path("out.lcmlog").exists()


def test_cut_takes_a_part():
    _bag("cut", "in.lcmlog", "out.lcmlog", "-s", "end-50s", "-d", "1s")
    assert _times(_read("out.lcmlog")) == pytest.approx(
        [49.9 + n / 10 for n in (0, 1, 1, *range(2, 11))]
    )


def test_a_part_has_the_losses_of_its_times_and_senders():
    one, other = _ONE._replace(name="/driver"), _OTHER._replace(name="talker.py")
    _bag("cut", "in.lcmlog", "early.lcmlog", "-e", "50s")
    with LogFile("early.lcmlog") as log:
        assert log.losses() == {one: Loss(2, 202), other: Loss(0, 20)}
    _bag("filter", "in.lcmlog", "late.lcmlog", "-s", "30s", "-t", "/chatter")
    _bag("shift", "late.lcmlog", "shifted.lcmlog", "--by", "10m")
    _bag("cut", "shifted.lcmlog", "again.lcmlog", "-s", "40s", "-d", "11s")
    with LogFile("again.lcmlog") as log:
        assert log.losses() == {other: Loss(1, 60)}
    _bag("merge", "early.lcmlog", "again.lcmlog", "-o", "both.lcmlog")
    with LogFile("both.lcmlog") as log:
        assert log.losses() == {one: Loss(2, 202), other: Loss(0, 80)}


def test_rename_changes_announcements_too():
    _bag("rename", "in.lcmlog", "out.lcmlog", "/a/:=/b/c/", "/chatter:=/words")
    assert {packet.channel for packet in _read("out.lcmlog")} == {"/b/c/number", "/words"}
    with LogFile("out.lcmlog") as log:
        said = decode_announcement(log.index.nodes[0].payload)
    assert said is not None
    assert [end.topic for end in said.node.endpoints] == ["/b/c/number", "/b/c/silent"]


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["/a/number:=/chatter"], "two topics would be called /chatter; rename the other one too"),
        (["/b:=/c"], "there is no topic /b in the log; lcmtools bag info shows them"),
        (["/chater:=/c"], "there is no topic /chater in the log; did you mean /chatter?"),
        (["/a"], "'/a' is not a rename; write OLD:=NEW, or /old/:=/new/"),
    ],
)
def test_wrong_renames(words, error, capsys):
    assert main(["bag", "rename", "in.lcmlog", "out.lcmlog", *words]) != 0
    assert capsys.readouterr().err == f"lcmtools bag rename: {error}\n"
    assert not Path("out.lcmlog").exists()


def test_shift_moves_messages_and_announcements():
    _bag("shift", "in.lcmlog", "out.lcmlog", "--by", "-1.5s")
    assert _times(_read("out.lcmlog"))[0] == -1.5
    with LogFile("out.lcmlog") as log:
        assert log.index.nodes[0].time == _START - 3 * _SECOND // 2
    _bag("shift", "in.lcmlog", "out.lcmlog", "--to", "1000000000", "--force")
    assert _read("out.lcmlog")[0].time == 1_000_000_000 * _SECOND


def test_a_shift_that_no_log_can_hold_is_refused(capsys):
    Path("far").write_bytes(encode_event(0, Packet("/a", b"", (2**63 - 1) * 1000)))
    assert main(["bag", "shift", "far", "out.lcmlog", "--by", "1s"]) == 2
    assert_says(capsys.readouterr().err, "times", "1970")


def test_downsample_is_not_slowed_by_the_grid_of_the_messages():
    _bag("downsample", "in.lcmlog", "out.lcmlog", "--rate", "4", "-t", "/a/number")
    counts = [packet.channel for packet in _read("out.lcmlog")]
    assert counts.count("/a/number") in (399, 400)
    assert counts.count("/chatter") == 100
    _bag("downsample", "in.lcmlog", "out.lcmlog", "--every", "7", "--force")
    counts = [packet.channel for packet in _read("out.lcmlog")]
    assert (counts.count("/a/number"), counts.count("/chatter")) == (143, 15)


def test_parts_merge_to_the_whole_and_sort():
    _bag("filter", "in.lcmlog", "a.lcmlog", "-t", "/a")
    _bag("filter", "in.lcmlog", "b.lcmlog", "-x", "/a")
    _bag("merge", "a.lcmlog", "b.lcmlog", "-o", "out.lcmlog")
    assert _read("out.lcmlog") == _read("in.lcmlog")
    Path("mixed").write_bytes(Path("b.lcmlog").read_bytes() + Path("a.lcmlog").read_bytes())
    _bag("sort", "mixed", "sorted")
    assert sorted(_read("sorted"), key=lambda packet: packet.time) == _read("sorted")
    assert len(_read("sorted")) == 1100


def test_fix_says_what_it_leaves_out(path, capsys):
    data = bytearray(path.read_bytes())
    with LogFile(path) as log:
        places = list(log.events())
    data[places[500].start + 20 : places[502].start + 24] = b"x" * (
        places[502].start + 4 - places[500].start
    )
    path.write_bytes(data[:-5])
    assert main(["bag", "fix", "in.lcmlog", "out.lcmlog", "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert record["messages"] == 1100 - 4
    assert [(part["start"], part["end"]) for part in record["left_out"]] == [
        (places[500].start, places[503].start),
        (places[-1].start, len(data) - 5),
    ]
    assert record["left_out"][0]["after"] == places[499].time
    assert [packet.payload for packet in _read("out.lcmlog")][:500] == [
        bytes(data[one.payload_start : one.end]) for one in places[:500]
    ]
    assert main(["bag", "fix", "in.lcmlog", "out.lcmlog", "--force"]) == 1
    out = capsys.readouterr().out
    assert "left out in total: " in out
    assert f"bytes {places[500].start} to {places[503].start - 1}, after " in out


def test_senders_are_not_guessed_where_events_are_damaged():
    with LogWriter("two.lcmlog") as log:
        numbers = log.sender_number(_ONE, "/one"), log.sender_number(_OTHER, "/other")
        for n in range(10):
            log.add(Packet("/both", _number(n), n * 1000), numbers[n % 2])
            log.add(Packet("/one", _number(n), n * 1000), numbers[0])
    data = bytearray(Path("two.lcmlog").read_bytes())
    with LogFile("two.lcmlog") as log:
        place = list(log.events())[4]
    data[place.start] = 0
    Path("two.lcmlog").write_bytes(data)
    found = _read("two.lcmlog")
    assert {packet.sender for packet in found if packet.channel == "/both"} == {None}
    assert {str(packet.sender) for packet in found if packet.channel == "/one"} == {"/one"}
    assert len(found) == 19


def test_an_existing_target_stays_unless_forced(capsys):
    Path("out.lcmlog").write_text("mine")
    assert main(["bag", "sort", "in.lcmlog", "out.lcmlog"]) == 1
    assert_says(capsys.readouterr().err, "lcmtools bag sort: out.lcmlog exists; ", "--force\n")
    assert Path("out.lcmlog").read_text() == "mine"
    before = _read("in.lcmlog")
    _bag("sort", "in.lcmlog", "in.lcmlog", "--force")
    assert _read("in.lcmlog") == before
    assert sorted(one.name for one in Path.cwd().iterdir()) == [
        *("in.lcmlog", "in.lcmlog.index", "out.lcmlog")
    ]
