"""Logs by the times in their messages."""

import json
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.bag.stamps import by_stamp
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.sensor_msgs import Imu
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet

_S = 10**9
_START = 1_795_384_180 * _S
_LATE = 1000 * _S  # of recording
_STAMPS = (0, 2, 1, 3)  # [s], in the order of recording


@pytest.fixture(autouse=True)
def _log(tmp_path, monkeypatch):
    """A log of /imu, whose messages came in another order, and of /note, which has no times."""
    monkeypatch.chdir(tmp_path)
    with LogWriter("in.lcmlog") as log:
        for number, second in enumerate(_STAMPS):
            imu = Imu()
            imu.header.stamp.sec = _START // _S + second
            messages = (
                ("/note", String(data=str(second))),
                ("/imu", imu),
            )
            for topic, message in messages:
                log.add(Packet(topic, encode(message), _START + _LATE + number * 10**6))


def _found(path):
    with LogFile(path) as log:
        return [(one.channel, (one.time - _START) / _S) for one in log.packets()]


def test_a_log_is_sorted_by_the_times_in_its_messages():
    assert main(["bag", "sort", "in.lcmlog", "out.lcmlog", "--by-stamp"]) == 0
    found = _found("out.lcmlog")
    assert [time for topic, time in found if topic == "/imu"] == [0, 1, 2, 3]
    notes = [time for topic, time in found if topic == "/note"]
    assert notes == pytest.approx([0, 0, 1, 2], abs=0.01)  # moved as the message before


def test_a_log_is_played_and_exported_by_the_times_in_its_messages():
    with by_stamp(["in.lcmlog"]) as paths, Playlist(paths, Choice()) as playlist:
        assert playlist.span == (_START, _START + 3 * _S)
        assert len([*playlist.messages(*playlist.span)]) == 8
    command = "bag export in.lcmlog out.jsonl --by-stamp -t /imu -s 1s -e 2s"
    assert main(command.split()) == 0
    rows = [json.loads(line) for line in Path("out.jsonl").read_text().splitlines()]
    assert [(row["time"] - _START) / _S for row in rows] == [1, 2]


def test_rates_are_measured_by_the_times_in_the_messages(capsys):
    assert main(["bag", "sort", "in.lcmlog", "sorted.lcmlog", "--by-stamp"]) == 0
    assert main(["hz", "/imu", "-b", "in.lcmlog"]) == 0
    assert "average rate: 1000.0" in capsys.readouterr().out
    for log in ("sorted.lcmlog", "in.lcmlog"):
        assert main(f"hz /imu -b {log} --by-stamp".split()) == 0
        assert "average rate: 1.000" in capsys.readouterr().out


def test_a_log_without_times_in_its_messages_says_so(capsys):
    assert main(["bag", "filter", "in.lcmlog", "notes.lcmlog", "-t", "/note"]) == 0
    for command in (
        "sort notes.lcmlog out.lcmlog",
        "play notes.lcmlog",
        "export notes.lcmlog a.csv",
    ):
        assert main(["bag", *command.split(), "--by-stamp"]) == 1
        assert_says(capsys.readouterr().err, "no message in notes.lcmlog has a time in it")
