"""Logs in the formats of tables."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.bag.export import FORMATS, export, format_of
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.geometry_msgs import TransformStamped, Twist
from lcmtools.types.sensor_msgs import JointState, LaserScan
from lcmtools.types.std_msgs import String
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet, Sender

_SECOND = 10**9
_SENDER = Sender("127.0.0.1", 4001, "/driver")


def _scan(number, beams):
    scan = LaserScan()
    scan.header.stamp.sec = number
    scan.ranges = [float(number)] * beams
    return scan


def _twist(number):
    twist = Twist()
    twist.linear.x = number / 4
    return twist


def _names(size):
    return JointState(name=[str(number) for number in range(size)])


def _transforms(size):
    message = TFMessage()
    message.transforms = [TransformStamped() for _ in range(size)]
    for number, transform in enumerate(message.transforms):
        transform.transform.translation.x = float(number)
    return message


def _packets(beams=3):
    for number in range(4):
        for topic, message in (
            ("/cmd", _twist(number)),
            ("/scan", _scan(number, number if beams is None else beams)),
        ):
            yield Packet(topic, encode(message), number * _SECOND, _SENDER)


def _export(packets, target, name=None):
    return export(packets, Decoder(lambda _: ()), target, format_of(target, name))


def _of(topic, packets):
    return (packet for packet in packets if packet.channel == topic)


def test_csv_is_as_echo_prints_it(tmp_path):
    assert _export(_of("/cmd", _packets()), tmp_path / "a.csv").messages == 4
    head, *rows = csv.reader((tmp_path / "a.csv").read_text().splitlines())
    assert head[:2] == ["%time", "field.linear.x"]
    assert [row[:2] for row in rows] == [[str(n * _SECOND), str(n / 4)] for n in range(4)]


def test_csv_of_several_topics_is_a_folder(tmp_path):
    _export(_packets(), tmp_path / "out", "csv")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["cmd.csv", "scan.csv"]
    assert len((tmp_path / "out" / "scan.csv").read_text().splitlines()) == 5


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_topics_whose_names_are_alike_have_files_of_their_own(kind, tmp_path):
    names = ("/scan", "scan", "SCAN", "/a/b", "/a_b", "a\udcff", "")
    packets = (Packet(name, encode(_twist(1)), _SECOND) for name in names)
    assert _export(packets, tmp_path / "out", kind).messages == len(names)
    found = sorted(path.stem for path in (tmp_path / "out").iterdir())
    assert found == ["SCAN_3", "a", "a_b", "a_b_2", "scan", "scan_2", "topic"]


@pytest.mark.parametrize("target", ["a.npz", "a.parquet", "a.mcap"])
def test_a_time_of_damage_is_left_out(target, tmp_path):
    packets = (Packet("/cmd", encode(_twist(1)), time) for time in (_SECOND, 2**70))
    done = _export(packets, tmp_path / target)
    assert (done.messages, len(done.left_out)) == (1, 1)


@pytest.mark.parametrize("target", ["a.mcap", "a.bag", "folder", "a.npz", "a.jsonl"])
def test_a_channel_that_is_no_utf_8_is_written(target, tmp_path):
    packets = (Packet(name, encode(_twist(1)), _SECOND) for name in ("/cmd", "a\udcff"))
    kind = None if "." in target else "ros2"
    assert _export(packets, tmp_path / target, kind).messages == 2


def test_csv_of_several_topics_into_one_file_is_refused(tmp_path):
    with pytest.raises(UsageError, match="holds one topic"):
        _export(_packets(), tmp_path / "a.csv")
    assert not list(tmp_path.iterdir())


def test_json_lines_have_topic_time_sender_type_and_message(tmp_path):
    _export(_packets(), tmp_path / "a.jsonl")
    rows = [json.loads(line) for line in (tmp_path / "a.jsonl").read_text().splitlines()]
    assert rows[2] == {
        "topic": "/cmd",
        "time": _SECOND,
        "sender": "/driver",
        "type": "geometry_msgs/Twist",
        "types": ["geometry_msgs/Twist", "geometry_msgs/Accel"],
        "message": {
            "linear": {"x": 0.25, "y": 0.0, "z": 0.0},
            "angular": {"x": 0.0, "y": 0.0, "z": 0.0},
        },
    }


def test_npz_has_an_array_for_each_field(tmp_path):
    _export(_of("/scan", _packets()), tmp_path / "a.npz")
    arrays = np.load(tmp_path / "a.npz")
    assert arrays["%time"].tolist() == [n * _SECOND for n in range(4)]
    assert arrays["ranges"].tolist() == [[n] * 3 for n in range(4)]
    _export(_packets(), tmp_path / "b.npz")
    assert np.load(tmp_path / "b.npz")["/cmd/linear.x"].tolist() == [0.0, 0.25, 0.5, 0.75]


def test_npz_of_arrays_of_several_lengths_has_the_lengths(tmp_path):
    _export(_of("/scan", _packets(None)), tmp_path / "a.npz")
    arrays = np.load(tmp_path / "a.npz")
    assert arrays["ranges"].tolist() == [1, 2, 2, 3, 3, 3]
    assert arrays["ranges.lengths"].tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("target", ["a.npz", "a.parquet", "a.mcap", "a.bag"])
def test_a_type_that_holds_itself_is_left_out(target, tmp_path, odd):
    tree, path = Packet("/tree", encode(odd.Tree()), _SECOND), tmp_path / target
    with raises_saying(LcmtoolsError, "odd/Tree", "itself"):
        export([tree, tree], Decoder(lambda _: (), odd.Tree), path, format_of(path, None))


def test_npz_has_arrays_of_messages_and_text_that_are_empty_now_and_then(tmp_path):
    for name, sizes in (("some.npz", (0, 2, 1)), ("none.npz", (0, 0))):
        _export((Packet("/js", encode(_names(size)), 1) for size in sizes), tmp_path / name)
        arrays = np.load(tmp_path / name)
        assert arrays["name"].tolist() == [str(n) for size in sizes for n in range(size)]
        assert arrays["name.lengths"].tolist() == list(sizes)
    tfs = (_transforms(size) for size in (0, 2, 1))
    _export((Packet("/tf", encode(tf), 1) for tf in tfs), tmp_path / "tf.npz")
    arrays = np.load(tmp_path / "tf.npz")
    assert arrays["transforms.transform.translation.x"].tolist() == [0.0, 1.0, 0.0]
    assert arrays["transforms.child_frame_id.lengths"].tolist() == [0, 2, 1]


def test_parquet_has_lists_for_arrays(tmp_path):
    from pyarrow import parquet

    for beams in (3, None):
        name = f"{beams}.parquet"
        _export(_of("/scan", _packets(beams)), tmp_path / name)
        found = parquet.read_table(tmp_path / name).to_pydict()
        assert found["ranges"] == [[float(n)] * (n if beams is None else 3) for n in range(4)]
        assert found["%time"] == [n * _SECOND for n in range(4)]
    _export(_packets(), tmp_path / "all", "parquet")
    assert (tmp_path / "all" / "cmd.parquet").is_file()


def test_what_cannot_be_decoded_is_told_and_left_out(tmp_path):
    packets = [*_of("/cmd", _packets()), Packet("/cmd", b"not LCM", 1), Packet("/x", b"?" * 9, 2)]
    done = _export(iter(packets), tmp_path / "a.jsonl")
    assert done.messages == 4
    short, unknown = done.left_out.values()
    assert_says(short, "/cmd", "left out", "too short")
    assert_says(unknown, "/x", "left out", "0x3f3f3f3f3f3f3f3f")


@pytest.mark.parametrize("target", ["a.npz", "a.parquet"])
def test_columns_of_a_topic_are_of_its_first_type(target, tmp_path):
    other = Packet("/cmd", encode(_names(2)), 1)
    done = _export(iter([*_of("/cmd", _packets()), other]), tmp_path / target)
    assert done.messages == 4
    (told,) = done.left_out.values()
    assert_says(told, "sensor_msgs/JointState", "geometry_msgs/Twist", "before")


def test_nothing_stays_where_nothing_is_written(tmp_path):
    for name in ("a.jsonl", "a.npz", "a.mcap", "a.bag"):
        with raises_saying(LcmtoolsError, "nothing is written", "; ", "/x"):
            _export(iter([Packet("/x", b"?" * 9, 2)]), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_target_that_exists_stays_as_it_is(tmp_path):
    target = tmp_path / "a.jsonl"
    target.write_text("mine")
    with raises_saying(LcmtoolsError, "exists; ", "--force"):
        _export(_packets(), target)
    assert target.read_text() == "mine"
    export(_packets(), Decoder(lambda _: ()), target, "jsonl", force=True)
    assert target.read_text().startswith('{"topic":"/cmd"')


@pytest.mark.parametrize(
    ("name", "named", "meant"),
    [
        ("a.csv", None, "csv"),
        ("a.ndjson", None, "jsonl"),
        ("a", "ros2", "ros2"),
        ("a.bag", None, "ros1"),
    ],
)
def test_formats(name, named, meant):
    assert format_of(Path(name), named) == meant
    assert meant in FORMATS


def test_a_format_that_is_not_known_has_its_near_name():
    with raises_saying(UsageError, "'parket'", "did you mean parquet?"):
        format_of(Path("a"), "parket")
    with raises_saying(UsageError, "format", "a.txt", "suffix"):
        format_of(Path("a.txt"), None)


def _message(message):
    return Packet("/chatter", encode(message), 5)


def test_text_that_is_no_utf_8_is_written_all_the_same(tmp_path):
    payload = encode(String()).replace(b"\0\0\0\1\0", b"\0\0\0\3\xff\xfe\0")
    for name in ("a.csv", "a.jsonl", "a.npz"):
        _export(iter([Packet("/chatter", payload, 5)]), tmp_path / name)
        assert (tmp_path / name).stat().st_size
