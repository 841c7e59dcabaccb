"""Bags of ROS and MCAP files: written, and read again."""

import pytest
from fixtures.says import raises_saying
from mcap.writer import Writer

from lcmtools.bag.ros_bags import McapFile, RosBag
from lcmtools.bag.ros_import import RosImport
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.messages.codec import encode
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages import provide_user_types
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.wire.packet import Packet

_TIME = 1_700_000_000_123_456_789


_TARGETS = {
    "a.mcap": McapFile,
    "ros1.mcap": lambda path: McapFile(path, "ros1", "lz4"),
    "plain.mcap": lambda path: McapFile(path, compression="none"),
    "a.bag": lambda path: RosBag(path, 1),
    "folder": lambda path: RosBag(path, 2),
    "folder of mcap": lambda path: RosBag(path, 2, "mcap"),
}


def _written(make, path, messages):
    decoder = Decoder(lambda _: ())
    with make(path) as target:
        for number, message in enumerate(messages):
            topic = f"/{type(message).__name__.lower()}"
            target.add(Packet(topic, encode(message), _TIME + number * 10**6), decoder)
    return list(RosImport().read(path))


def _messages():
    scan, odometry, stat = LaserScan(), Odometry(), ControllerEvaluationStat()
    scan.ranges, scan.header.frame_id = [1.5, 2.5], "laser"
    odometry.pose.covariance = [0.25] * 36
    odometry.header.stamp.sec = 12
    return [scan, odometry, stat, scan]


@pytest.mark.parametrize("name", _TARGETS)
def test_messages_come_back_as_they_went(name, tmp_path):
    messages = _messages()
    found = _written(_TARGETS[name], tmp_path / name, messages)
    assert [encode(one.message) for one in found] == [encode(message) for message in messages]
    assert [one.time for one in found] == [_TIME + number * 10**6 for number in range(4)]
    assert [one.topic for one in found][:2] == ["/laserscan", "/odometry"]


@pytest.mark.parametrize("name", _TARGETS)
@pytest.mark.parametrize("time", [-1, 2**63])
def test_a_time_that_ros_has_not_is_left_out(name, time, tmp_path):
    with (
        _TARGETS[name](tmp_path / name) as target,
        pytest.raises(DecodeError, match="cannot represent the time"),
    ):
        target.add(Packet("/scan", encode(LaserScan()), time), Decoder(lambda _: ()))


def test_types_that_are_not_known_are_translated(tmp_path):
    schema = "std_msgs/Header header\nmine_msgs/Point2[] points\nuint16 COUNT=3\nint8[2] pair\n"
    schema += "=" * 80 + "\nMSG: mine_msgs/Point2\nfloat32 x\nstring name\n"
    schema += "=" * 80 + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        number = writer.register_schema("mine_msgs/msg/Polyline", "ros2msg", schema.encode())
        channel = writer.register_channel("/line", "cdr", number)
        data = b"\0\1\0\0" + b"\7\0\0\0\x08\0\0\0" + b"\4\0\0\0map\0"
        data += b"\1\0\0\0" + b"\0\0\xc0\x3f" + b"\2\0\0\0a\0" + b"\xff\5"
        writer.add_message(channel, log_time=5, data=data, publish_time=5)
        writer.finish()
    reading = RosImport()
    (one,) = reading.read(path)
    assert to_plain(one.message) == {
        "header": {"seq": 0, "stamp": {"sec": 7, "nsec": 8}, "frame_id": "map"},
        "points": [{"x": 1.5, "name": "a"}],
        "pair": [-1, 5],
    }
    assert sorted(reading.types) == ["mine_msgs/Point2", "mine_msgs/Polyline"]


def test_what_is_no_bag_is_said_to_be_none(tmp_path):
    (tmp_path / "a.png").write_bytes(b"\x89PNG....")
    (tmp_path / "a.db3").write_bytes(b"SQLite format 3\0")
    with raises_saying(LcmtoolsError, "a.png", "ROS bag", "MCAP"):
        list(RosImport().read(tmp_path / "a.png"))
    with raises_saying(LcmtoolsError, "ROS 2 bag", "; ", "folder"):
        list(RosImport().read(tmp_path / "a.db3"))
    with raises_saying(LcmtoolsError, "cannot read", "gone.bag: No such file"):
        list(RosImport().read(tmp_path / "gone.bag"))


@pytest.mark.parametrize("file", ["Wheel.msg", "Wheel.lcm"])
@pytest.mark.parametrize("version", [1, 2])
def test_a_bag_without_definitions_has_the_types_of_the_workspace(
    file, version, tmp_path, monkeypatch
):
    folder = tmp_path / "types" / "own_msgs"
    folder.mkdir(parents=True)
    is_ros = file.endswith("msg")
    text = (
        "uint16 number\nfloat64[] speeds\nPart part\n"
        if is_ros
        else (
            "package own_msgs;"
            "struct Wheel { int16_t number; int32_t n; double speeds[n]; Part part; }"
        )
    )
    part = "uint8 x\n" if is_ros else "package own_msgs; struct Part { byte x; }"
    (folder / file).write_text(text)
    (folder / file.replace("Wheel", "Part")).write_text(part)
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(folder.parent))
    provide_user_types()
    path = tmp_path / "a.mcap"
    with path.open("wb") as out:
        writer = Writer(out)
        writer.start()
        name = "own_msgs/Wheel" if version == 1 else "own_msgs/msg/Wheel"
        schema = writer.register_schema(name, "", b"")
        channel = writer.register_channel("/wheel", "ros1" if version == 1 else "cdr", schema)
        rest = b"\1\0\0\0" + bytes(6) + b"\xf8\x3f" + b"\7"
        data = (b"\xe8\3" if version == 1 else b"\0\1\0\0\xe8\3\0\0") + rest
        writer.add_message(channel, log_time=5, data=data, publish_time=5)
        writer.finish()
    reading = RosImport()
    (one,) = reading.read(path)
    assert reading.report.is_complete
    found = to_plain(one.message)
    assert (found["number"], found["speeds"], found["part"]) == (1000, [1.5], {"x": 7})
    assert isinstance(one.message, message_class("own_msgs/Wheel"))
