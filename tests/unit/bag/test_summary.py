"""The summary of a log, by its index and without."""

import json

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.bag.reindex import reindex_log
from lcmtools.bag.summary import summarize
from lcmtools.bag.summary_report import span_text, time_text, to_json
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.observe.reading.losses import Loss
from lcmtools.packages.user_types import source_text
from lcmtools.types.std_msgs import Header, String
from lcmtools.wire.log_index import LostMessages
from lcmtools.wire.packet import Packet, Sender

_SECOND = 1_000_000_000
_START = 1_795_384_180 * _SECOND
_ONE = Sender("10.0.0.7", 4001)


def _string(text):
    return String(data=text).encode()


@pytest.fixture
def path(tmp_path):
    """A log of two minutes: /chatter at 2 Hz with a gap of 20 s, and 8 bytes of another type."""
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as log:
        talker, driver = log.sender_number(_ONE, "/talker"), log.sender_number(_ONE, "driver")
        for half in range(240):
            time = _START + half * _SECOND // 2
            if not 100 <= half < 140:
                log.add(Packet("/chatter", _string("x" * 5), time), talker)
            if half % 10 == 0:
                log.add(Packet("RAW", b"\1" * 8, time), driver if half < 100 else talker)
            log.flush()
        log.add_lost(LostMessages(0, {talker: (3, 500)}))
    return path


@pytest.mark.parametrize("keeps_index", [True, False])
def test_a_summary_is_the_same_with_and_without_an_index(path, keeps_index):
    if not keeps_index:
        index_path(path).unlink()
    with LogFile(path) as log:
        found = summarize(log)
        assert len(list(log.blocks())) > 5
    chatter, raw = found.topics
    assert (found.bytes, found.damaged, found.messages) == (path.stat().st_size, 0, 224)
    assert (found.start, found.duration) == (_START, 119.5)
    assert found.indexed == (found.bytes if keeps_index else 0)
    assert (chatter.name, chatter.types, chatter.messages) == (
        "/chatter",
        ("std_msgs/String",),
        200,
    )
    assert chatter.longest_gap == 20.5 * _SECOND
    assert chatter.rate == pytest.approx(199 / 119.5)
    assert chatter.mean_bytes == len(_string("x" * 5))
    assert (raw.types, raw.bytes) == ((), 24 * 8)
    assert raw.senders == ({"driver": 10, "/talker": 14} if keeps_index else {})
    assert list(found.losses.values()) == ([Loss(3, 500)] if keeps_index else [])
    losses = to_json(found)["losses"]
    times = [one["times"] for one in losses] if isinstance(losses, list) else []
    assert times == [[{"time": 0, "lost": 3, "of": 500}]] * keeps_index
    assert len(found.histogram) == 60
    assert sum(found.histogram) == 224
    assert set(found.histogram[26:34]) <= {0, 1}  # the gap


@pytest.mark.parametrize("years", [-3, 3])
def test_a_time_that_is_damaged_and_not_in_the_index_costs_its_message_alone(path, years):
    time = _START + 70 * _SECOND
    wrong = (time + years * 365 * 86400 * _SECOND) // 1000
    written = path.read_bytes().replace(
        (time // 1000).to_bytes(8, "big"), wrong.to_bytes(8, "big", signed=True)
    )
    path.write_bytes(written)
    with LogFile(path) as log:
        assert sum(summarize(log).histogram) == 224 - 2


def test_an_index_is_completed_with_what_it_had(path):
    whole = index_path(path).read_text().splitlines(keepends=True)
    blocks = [place for place, line in enumerate(whole) if line.startswith('{"block"')]
    index_path(path).write_text("".join(whole[: blocks[4]]))
    with LogFile(path) as log:
        assert 0 < log.index.end < log.size
        reindex_log(log)
    with LogFile(path) as log:
        assert (log.index.end, log.index.size) == (log.size, log.size)
        assert len(log.senders) == 2
        assert (
            sum(
                b.channels["/chatter"].messages
                for b in log.index.blocks
                if "/chatter" in b.channels
            )
            == 200
        )
    assert not list(path.parent.glob(".*"))


def test_an_index_gets_the_definitions_of_types_that_are_known_here(tmp_path):
    log = tmp_path / "plain.lcmlog"
    head = encode(Header())
    packets = [
        Packet("/chatter", _string("a"), 0),
        Packet("/head", head, 0),
        Packet("/raw", head[:9], 0),
    ]
    log.write_bytes(b"".join(encode_event(number, one) for number, one in enumerate(packets)))
    with LogFile(log) as file:
        reindex_log(file)
    with LogFile(log) as file:
        types = file.index.types
        assert list(types) == ["std_msgs/String", "std_msgs/Header", "std_msgs/Time"]
        assert types["std_msgs/Header"].source.strip() == source_text(Header)
        reindex_log(file)
    with LogFile(log) as file:
        assert file.index.types == types


def test_info_prints_what_a_log_has(path, capsys):
    assert main(["bag", "info", str(path)]) == 0
    text = capsys.readouterr().out
    assert "in 224 messages\n" in text
    assert "duration:  2m 00s\n" in text
    assert "index:     complete\n" in text
    assert_says(text, "lost: ", "3 of 500 (0.6 %)", "/talker", "recorded")
    row = next(line for line in text.splitlines() if line.startswith("/chatter"))
    cells = "/chatter std_msgs/String 200 1.67 Hz 18 B 3.60 KB 20.5 s /talker"
    assert " ".join(row.split()) == cells
    assert main(["bag", "info", str(path), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)[0]
    assert (record["messages"], record["damaged_bytes"], record["duration"]) == (224, 0, 119.5)
    assert [topic["topic"] for topic in record["topics"]] == ["/chatter", "RAW"]


def test_strange_logs_have_a_summary(tmp_path, capsys):
    path = tmp_path / "a.log"
    path.write_bytes(b"")
    assert main(["bag", "info", str(path)]) == 0
    assert "0 B in 0 messages" in capsys.readouterr().out
    packets = [Packet("/\x1b[2J", b"x", n * 1000) for n in (2**63 - 1, -(2**63), 5, 4)]
    data = b"".join(encode_event(n, packet) for n, packet in enumerate(packets))
    path.write_bytes(b"bad" + data[:60] + data)
    assert main(["bag", "info", str(path)]) == 0
    text = capsys.readouterr().out
    assert "in 5 messages" in text
    assert_says(text, "do not belong")
    assert "\x1b" not in text
    assert main(["bag", "info", str(path), "--json"]) == 0
    path.write_text("hello\n" * 100)
    assert main(["bag", "info", str(path)]) == 1
    error = capsys.readouterr().err
    assert_says(error, "lcmtools bag info: ", "no messages", str(path), "not an LCM log\n")


def test_a_log_whose_times_go_back_is_said_to_be(tmp_path, capsys):
    def said(*words):
        assert main(list(words)) == 0
        return capsys.readouterr()

    log, ordered = str(tmp_path / "a.log"), str(tmp_path / "b.log")
    packets = [Packet("A", b"x", second * 10**9) for second in (10, 11, 12, 5, 6, 7)]
    data = b"".join(encode_event(n, packet) for n, packet in enumerate(packets))
    (tmp_path / "a.log").write_bytes(data)
    for _ in range(2):  # by the log, and by its index
        assert_says(said("bag", "info", log)[0], "order: ", "7 s", "lcmtools bag sort")
        (record,) = json.loads(said("bag", "info", log, "--json")[0])
        assert record["disorder"] == 7.0
        notes = []
        Playlist([log], Choice(), notes.append).close()
        (note,) = notes
        assert_says(note, str(log), "go back, by up to 7 s", "lcmtools bag sort")
        assert_says(said("hz", "-b", log, "A")[1], "go back; lcmtools bag sort")
        said("bag", "reindex", log)
    said("bag", "sort", log, ordered)
    assert "order:" not in said("bag", "info", ordered)[0]
    assert said("hz", "-b", ordered, "A") == (
        "average rate: 0.714\n\tmin: 1.000s max: 3.000s std dev: 0.80000s window: 6\n",
        "",
    )


def test_words_of_spans_and_times():
    assert list(map(span_text, (0.01234, 59.9, 60, 3600, 7265))) == [
        *("0.0123 s", "59.9 s", "1m 00s", "1h 00m", "2h 01m")
    ]
    assert time_text(2**70) == "1180591620717.411"
