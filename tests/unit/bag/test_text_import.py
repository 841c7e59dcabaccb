"""JSON lines and comma-separated values become a log again."""

import math
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.bag.stamps import by_stamp
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import type_name
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import CompressedImage, JointState, LaserScan
from lcmtools.types.std_msgs import Bool, Float64, String
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet, Sender

_S = 10**9
_START = 1_795_384_180 * _S


def _messages():
    odometry, scan = Odometry(), LaserScan(ranges=[1.5, math.inf], intensities=[])
    odometry.header.stamp.sec, odometry.header.frame_id = 12, "odom"
    odometry.pose.covariance = [0.25 * number for number in range(36)]
    moved = TransformStamped(child_frame_id="base")
    moved.transform.translation.x = 0.1
    return [
        odometry,
        scan,
        TFMessage(transforms=[moved, moved]),
        JointState(name=["a", "b"], position=[1.0, 2.0]),
        String(data='"quoted", and\nanother line'),
        Float64(data=math.nan),
        Bool(data=True),
        CompressedImage(format="png", data=b"\x00\xff"),
    ]


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def _write(*messages):
    with LogWriter("in.lcmlog") as log:
        sender = log.sender_number(Sender("127.0.0.1", 4001), "/driver")
        for number, message in enumerate(messages):
            name = f"/{type(message).__name__.lower()}"
            log.add(Packet(name, encode(message), _START + number * _S), sender)
    return _read("in.lcmlog")


def _read(path):
    with LogFile(path) as log:
        return [one._replace(sender=None) for one in log.packets()]


def test_json_lines_come_back_as_they_went():
    sent = _write(*_messages())
    assert main(["bag", "export", "in.lcmlog", "a.jsonl"]) == 0
    assert main(["bag", "import", "a.jsonl", "out.lcmlog"]) == 0
    assert _read("out.lcmlog") == sent
    with LogFile("out.lcmlog") as log:
        assert {one.sender.name for one in log.packets() if one.sender} == {"/driver"}
    with by_stamp(["a.jsonl"], wanted=False) as paths, Playlist(paths, Choice()) as playlist:
        assert len([*playlist.messages(*playlist.span)]) == len(sent)


@pytest.mark.parametrize("message", _messages(), ids=lambda one: type(one).__name__)
def test_values_of_a_type_come_back_as_they_went(message):
    sent = _write(message)
    assert main(["bag", "export", "in.lcmlog", "a.csv"]) == 0
    words = f"bag import a.csv out.lcmlog --type {type_name(message)} --as {sent[0].channel}"
    assert main(words.split()) == 0
    found = _read("out.lcmlog")
    assert [one.payload for one in found] == [one.payload for one in sent]
    kind = type_name(message), sent[0].channel
    with by_stamp(["a.csv"], *kind, wanted=False) as paths, Playlist(paths, Choice()) as playlist:
        assert len([*playlist.messages(*playlist.span)]) == len(sent)


def test_a_line_that_cannot_be_read_costs_only_itself(capsys):
    good = '{"topic":"/a","time":5,"type":"std_msgs/Float64","message":{"data":1.5}}'
    lines = (good, "{", '{"topic":"/a"}', good.replace("1.5", '"x"'), good.replace("Float64", "X"))
    Path("a.jsonl").write_text("\n".join((*lines, "", good)) + "\n")
    assert main(["bag", "import", "a.jsonl", "out.lcmlog", "--as", "/b"]) == 1
    assert [one.channel for one in _read("out.lcmlog")] == ["/b", "/b"]
    said = capsys.readouterr().err
    assert_says(said, *(f"message {number} is left out: " for number in (2, 3, 4, 5)))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("a.csv", "a file of values has no type and no topic; add --type"),
        ("a.csv --type std_msgs/Float64 --as /a", "there is no column %time"),
        ("empty.jsonl", "nothing is imported: empty.jsonl has no message that can be read"),
        ("none.jsonl", "cannot read none.jsonl: No such file"),
        ("a.mcap --type std_msgs/String", "--type and --as are for .csv and .jsonl"),
    ],
)
def test_what_cannot_be_imported(words, says, capsys):
    Path("a.csv").write_text("x,y\n1,2\n")
    Path("empty.jsonl").touch()
    source, *options = words.split()
    assert main(["bag", "import", source, "out.lcmlog", *options]) == 2
    assert_says(capsys.readouterr().err, says)
    assert main(["bag", "play", source, *options]) != 0
    assert_says(capsys.readouterr().err, says)
    assert not Path("out.lcmlog").exists()
