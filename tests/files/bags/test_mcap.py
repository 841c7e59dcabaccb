"""MCAP files without the parts that only speed needs, damaged, and with other encodings."""

import struct

import pytest
from fixtures.ros_bags import SECOND
from fixtures.says import assert_says, raises_saying
from mcap.writer import CompressionType, IndexType, Writer

from lcmtools.bag.ros_import import RosImport
from lcmtools.bag.ros_reading import bag_messages
from lcmtools.errors import InvalidFile

_COUNT = 20
_OPTIONS = {
    "all": {},
    "no repeated channels": {"repeat_channels": False},
    "no repeated schemas": {"repeat_schemas": False},
    "neither": {"repeat_channels": False, "repeat_schemas": False},
    "no chunk indexes": {"index_types": IndexType.NONE},
    "no message indexes": {"index_types": IndexType.CHUNK},
    "no statistics": {"use_statistics": False, "use_summary_offsets": False},
    "no summary": {
        "index_types": IndexType.NONE,
        "repeat_channels": False,
        "repeat_schemas": False,
        "use_statistics": False,
        "use_summary_offsets": False,
    },
    "no chunks": {"use_chunking": False},
    "lz4": {"compression": CompressionType.LZ4},
    "plain": {"compression": CompressionType.NONE},
    "no checksums": {"enable_crcs": False},
}


def _message(number):
    text = f"message {number}\0".encode()
    return b"\0\1\0\0" + struct.pack("<I", len(text)) + text


def _write(path, times=None, **options):
    """Write strings on /a, in chunks of a few messages."""
    with path.open("wb") as file:
        writer = Writer(file, **{"chunk_size": 150, **options})
        writer.start("ros2")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = writer.register_channel("/a", "cdr", schema)
        for number, time in enumerate(times or range(_COUNT)):
            writer.add_message(channel, time * SECOND, _message(number), time * SECOND)
        writer.finish()


def _numbers(path):
    reading = RosImport()
    texts = [one.message for one in reading.read(path)]
    return reading, [int(one.data.removeprefix("message ")) for one in texts]


@pytest.mark.parametrize("name", _OPTIONS)
def test_all_is_read(name, tmp_path):
    path = tmp_path / "a.mcap"
    _write(path, **_OPTIONS[name])
    reading, numbers = _numbers(path)
    assert numbers == [*range(_COUNT)]
    assert reading.report.to_lines() == []


@pytest.mark.parametrize("name", ["all", "no chunks"])
@pytest.mark.parametrize("times", [[3, 2, 1, 0] * 5, [*range(10, 20), *range(10)], [5] * 20])
def test_messages_come_by_time(times, name, tmp_path):
    path = tmp_path / "a.mcap"
    _write(path, times, **_OPTIONS[name])
    assert _numbers(path)[1] == sorted(range(len(times)), key=times.__getitem__)


@pytest.mark.parametrize("name", ["all", "no chunks", "lz4", "plain"])
def test_cut_off_anywhere_it_is_read_as_far_as_it_goes(name, tmp_path):
    path = tmp_path / "a.mcap"
    _write(path, **_OPTIONS[name])
    whole, before = path.read_bytes(), 0
    start = 8 + [*_OPTIONS].index(name) % 4
    for size in range(start, len(whole) - 37, 4):  # before the footer
        path.write_bytes(whole[:size])
        damage = []
        count = len(list(bag_messages(path, damage.append)))
        assert count >= before
        assert damage == [f"{path}: it is cut off at byte {size}"]
        before = count
    assert before == _COUNT


def test_a_file_without_a_whole_message_says_why(tmp_path):
    path = tmp_path / "a.mcap"
    _write(path)
    path.write_bytes(path.read_bytes()[:60])
    with raises_saying(InvalidFile, "nothing is imported", "a.mcap", "byte 60"):
        list(RosImport().read(path))


def test_a_damaged_chunk_costs_only_itself(tmp_path):
    path = tmp_path / "a.mcap"
    for name, damage in (("all", b"\xff" * 8), ("plain", b"X")):
        _write(path, **_OPTIONS[name])
        whole = path.read_bytes()
        place = whole.index(b"message 1\0" if name == "plain" else b"\x28\xb5\x2f\xfd") + 4
        path.write_bytes(whole[:place] + damage + whole[place + len(damage) :])
        reading, numbers = _numbers(path)
        assert 0 < len(numbers) < _COUNT
        assert numbers == [*range(numbers[0], _COUNT)]
        (row,) = reading.report.to_lines()
        assert_says(row, "a.mcap", "byte", "damaged")


_CHANNELS = {  # encoding, schema, its encoding and text
    "json": ("json", "own_msgs/Item", "jsonschema", b"{}"),
    "my_format": ("my_format", "std_msgs/msg/String", "ros2msg", b"string data"),
    "protobuf": ("protobuf", "foxglove.Log", "protobuf", b"\x0a\xff\xfe"),
    "flatbuffer": ("cdr", "own_msgs/Item", "flatbuffer", b"\x0a"),
    "an unknown encoding": ("", "std_msgs/msg/String", "ros2msg", b"string data"),
    "definition": ("cdr", "own_msgs/srv/Add_Event", "ros2msg", b"int64 a\n---\nint64 b\n"),
    "own_msgs/Part": ("cdr", "own_msgs/msg/Item", "ros2msg", b"own_msgs/Part part\n"),
    "no definition of it": ("cdr", "own_msgs/msg/Item", "", b""),
    "wstring": ("cdr", "own_msgs/msg/Item", "ros2msg", b"wstring x"),
    "float128": (
        "cdr",
        "own_msgs/msg/Item",
        "ros2idl",
        b"module own_msgs { module msg { struct Item { long double x; }; }; };",
    ),
    "LCM's 268435456 bytes": ("cdr", "own_msgs/msg/Item", "ros2msg", b"float64[400000000] x"),
    "are no own_msgs/Item": ("cdr", "own_msgs/msg/Item", "ros2msg", b"float64[9] x"),
}


@pytest.mark.parametrize("said", _CHANNELS)
def test_a_channel_that_cannot_be_read_costs_only_itself(said, tmp_path):
    path = tmp_path / "a.mcap"
    encoding, schema, form, text = _CHANNELS[said]
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        fine = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        strange = writer.register_schema(schema, form, text)
        channels = [
            writer.register_channel("/a", "cdr", fine),
            writer.register_channel("/b", encoding, strange),
        ]
        for time in range(6):
            writer.add_message(channels[time % 2], time, _message(time), time)
        writer.finish()
    reading, numbers = _numbers(path)
    assert numbers == [0, 2, 4]
    (row,) = reading.report.to_lines()
    assert_says(row, "3 messages", "/b", said)


def test_messages_of_undescribed_channels_are_counted(tmp_path):
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=False)
        writer.start("ros2")
        channel = writer.register_channel("/b", "cdr", 0)
        writer.add_message(channel, 1, _message(1), 1)
        writer.add_message(channel + 1, 1, _message(1), 1)
        writer.finish()
    reading = RosImport()
    with raises_saying(InvalidFile, "nothing is imported", "/b"):
        list(reading.read(path))
    assert len(reading.report.left_out) == 2


def _idl_of_two():
    line = "=" * 80
    item = "module own_msgs { module msg { struct Item { own_msgs::msg::Part part; }; }; };"
    part = "module own_msgs { module msg { struct Part { uint16 x; octet y; }; }; };"
    head = f"{line}\nIDL: own_msgs/msg/"
    return f"{head}Item\n{item}\n{head}Part\n{part}\n".encode()


_FORMS = {
    "action": (
        "own_msgs/action/Go_FeedbackMessage",
        b"own_msgs/action/Go_Feedback feedback\n"
        + b"=" * 80
        + b"\nMSG: own_msgs/action/Go_Feedback\nuint16 x\n",
        lambda message: message.feedback.x,
        b"\x40\x9c",
    ),
    "idl": ("own_msgs/msg/Item", _idl_of_two(), lambda message: message.part.x, b"\x40\x9c\1"),
    "ROS 1's spelling": ("own_msgs/Item", b"uint16 x\n", lambda message: message.x, b"\x40\x9c"),
}


@pytest.mark.parametrize("form", _FORMS)
def test_definitions_are_read_in_each_form(form, tmp_path):
    name, text, field, data = _FORMS[form]
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        schema = writer.register_schema(name, "ros2idl" if form == "idl" else "ros2msg", text)
        channel = writer.register_channel("/b", "cdr", schema)
        writer.add_message(channel, 1, b"\0\1\0\0" + data, 1)
        writer.finish()
    ((_, message, _),) = RosImport().read(path)
    assert field(message) == 40000


def test_two_types_of_one_name_are_not_mixed_up(tmp_path):
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        for number, text in enumerate((b"int32 x\n", b"float32 x\n")):
            schema = writer.register_schema("own_msgs/msg/Item", "ros2msg", text)
            channel = writer.register_channel(f"/{number}", "cdr", schema)
            writer.add_message(channel, number, b"\0\1\0\0\1\0\0\0", number)
        writer.finish()
    reading = RosImport()
    assert [one.topic for one in reading.read(path)] == ["/0"]
    (row,) = reading.report.to_lines()
    assert_says(row, "1 messages", "/1", "own_msgs/Item", "came before")
