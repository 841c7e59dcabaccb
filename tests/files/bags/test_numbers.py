"""Unsigned numbers of ROS, which LCM lacks: right, or named as changed."""

import json

import numpy as np
import pytest
from fixtures.ros_bags import TARGETS, Topic, own_types, read_bag, version_of, write_bag
from fixtures.says import assert_says

from lcmtools.bag.ros_import import RosImport
from lcmtools.messages.codec import encode

_TARGETS = pytest.mark.parametrize("target", TARGETS)
_RIGHT = [
    ("uint8", 255),
    ("uint16", 40000),
    ("uint16", 65535),
    ("uint32", 2**31),
    ("uint32", 2**32 - 1),
    ("uint64", 2**63 - 1),
    ("int8", -128),
    ("int16", -32768),
    ("int32", -(2**31)),
    ("int64", -(2**63)),
    ("char", 200),
]


def _imported(path):
    reading = RosImport()
    return reading, [one.message for one in reading.read(path)]


@_TARGETS
def test_numbers_of_own_types_are_right(target, tmp_path):
    path, text, values = tmp_path / target, "", {}
    for number, (kind, value) in enumerate(_RIGHT):
        text += f"{kind} one{number}\n{kind}[] some{number}\n{kind}[2] two{number}\n"
        array = np.array([value, 1], "uint8" if kind == "char" else kind)
        values |= {f"one{number}": value, f"some{number}": array, f"two{number}": array}
    store = own_types(version_of(path), Item=text)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values]))
    reading, (message,) = _imported(path)
    for number, (_, value) in enumerate(_RIGHT):
        assert getattr(message, f"one{number}") == value
        assert list(getattr(message, f"some{number}")) == [value, 1]
        assert list(getattr(message, f"two{number}")) == [value, 1]
    assert reading.report.to_lines() == []


@_TARGETS
def test_a_uint64_above_the_largest_number_of_lcm_is_named(target, tmp_path):
    path, text = tmp_path / target, "uint64 one\nuint64[] some\nuint64[2] two\n"
    array = np.array([2**64 - 2, 1], "uint64")
    values = {"one": 2**64 - 2, "some": array, "two": array}
    store = own_types(version_of(path), Item=text)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values] * 3))
    reading, messages = _imported(path)
    assert [one.one for one in messages] == [-2] * 3
    assert not reading.report.is_complete
    for row, field in zip(reading.report.to_lines(), ("one", "some", "two"), strict=True):
        assert_says(row, "/item", field, "3 times", str(2**64 - 2))


def test_a_number_in_an_array_of_messages_is_named_with_its_path(tmp_path):
    path, store = tmp_path / "a.bag", own_types(1, Part="uint64 id", Item="own_msgs/Part[] parts")
    parts = [store.types["own_msgs/msg/Part"](id=number) for number in (1, 2**63, 2**63 + 1)]
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [{"parts": parts}]))
    reading, _ = _imported(path)
    (row,) = reading.report.changes()
    assert_says(row, "/item", "parts.id", "2 times", str(2**63))


def test_a_shipped_type_keeps_its_fingerprint_and_its_numbers_are_named(tmp_path, cli):
    path, log = tmp_path / "a.bag", tmp_path / "a.lcmlog"
    write_bag(path, own_types(1), Topic("/n", "std_msgs/msg/UInt32", [{"data": 2**32 - 1}]))
    result = cli("bag", "import", str(path), str(log), "--json")
    assert result.code == 1
    (row,) = json.loads(result.out)["changed"]
    assert_says(row, "/n", "data", "1 times", str(2**32 - 1))
    assert_says(result.err, row)
    assert cli("echo", "-b", str(log), "/n").out.startswith("data: -1\n")


def test_seconds_of_ros_1_are_unsigned(tmp_path):
    path, store = tmp_path / "a.bag", own_types(1, Item="time at")
    time = store.types["builtin_interfaces/msg/Time"](sec=-1, nanosec=5)  # its bits are 2^32 - 1
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [{"at": time}]))
    reading, _ = _imported(path)
    (row,) = reading.report.changes()
    assert_says(row, "/item", "at.sec", str(2**32 - 1))


def test_a_byte_is_unsigned_in_ros_2_and_signed_in_ros_1(tmp_path):
    for target, expected in (("a.bag", -56), ("db3", 200)):
        path = tmp_path / target
        store = own_types(version_of(path), Item="byte one")
        write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [{"one": -56}]))
        reading, (message,) = _imported(path)
        assert message.one == expected
        assert reading.report.is_complete


_MANY = """uint8 LIMIT=3
uint64 MOST=18446744073709551615
string TEXT=some text
std_msgs/Header header
uint16 adc
uint32[] counts
uint64 id
uint8[] data
string from
int32 encode
uint32 encoder_length
float32[] encoder
time at
own_msgs/Part[2] parts
"""


def _many(version):
    store = own_types(version, Part="uint16 def\nuint64[2] ids\n", Item=_MANY)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=7, nanosec=8)
    number = {"seq": 9} if version == 1 else {}
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="map", **number)
    ids = np.array([2**64 - 1, 2**63], "uint64")
    part = types["own_msgs/msg/Part"](def_=50000, ids=ids)
    values = {
        "header": header,
        "adc": 40000,
        "counts": np.array([2**32 - 1, 2**31, 0], "uint32"),
        "id": 2**64 - 1,
        "data": np.array([255, 0], "uint8"),
        "from_": "base",
        "encode": -3,
        "encoder_length": 2**32 - 1,
        "encoder": np.array([0.5, 1.5, 2.5], "float32"),
        "at": stamp,
        "parts": [part, part],
    }
    return store, values


@pytest.mark.parametrize("target", ["a.bag", "db3"])
def test_exported_again_messages_are_the_same_bit_for_bit(target, tmp_path, cli):
    path, log, back = tmp_path / target, str(tmp_path / "a.lcmlog"), tmp_path / f"again_{target}"
    store, values = _many(version_of(path))
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values] * 2))
    assert cli("bag", "import", str(path), log).code == 1  # it names the 64 bits of id
    format_ = "ros1" if target == "a.bag" else "ros2"
    assert cli("bag", "export", log, str(back), "--format", format_).ok()
    assert read_bag(back) == read_bag(path)


def test_exported_again_a_type_is_the_same(tmp_path, cli):
    from rosbags.rosbag1 import Reader

    path, log, back = tmp_path / "a.bag", str(tmp_path / "a.lcmlog"), tmp_path / "b.bag"
    store, values = _many(1)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values]))
    cli("bag", "import", str(path), log)
    cli("bag", "export", log, str(back))
    digests = []
    for one in (path, back):
        with Reader(one) as reader:
            digests.append([each.digest for each in reader.connections])
    assert digests[0] == digests[1]


def test_an_mcap_file_that_is_exported_again_has_the_same_bytes(tmp_path, cli):
    from mcap.reader import make_reader

    path, log, back = tmp_path / "a.mcap", str(tmp_path / "a.lcmlog"), tmp_path / "b.mcap"
    store, values = _many(2)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values] * 2))
    cli("bag", "import", str(path), log)
    assert cli("bag", "export", log, str(back)).ok()
    found = []
    for one in (path, back):
        with one.open("rb") as file:
            found.append([(s.data, m.data) for s, _, m in make_reader(file).iter_messages()])
    assert found[0] == found[1]


def test_a_number_that_ros_cannot_hold_is_left_out(tmp_path, cli):
    import lcm

    from lcmtools.observe.reading.log_file import LogFile, index_path

    path, log, other = tmp_path / "a.bag", tmp_path / "a.lcmlog", tmp_path / "b.lcmlog"
    store = own_types(1, Item="uint32 one\nuint32[] some\n")
    fine = {"one": 1, "some": np.array([2], "uint32")}
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [fine] * 3))
    reading, messages = _imported(path)
    cli("bag", "import", str(path), str(log)).ok()
    messages[0].one, messages[1].some = 2**32, [-1]
    changed = lcm.EventLog(str(other), "w", overwrite=True)
    for number, message in enumerate(messages):
        changed.write_event(number, "/item", encode(message))
    changed.close()
    with LogFile(str(log)) as source:
        assert source.index.types.keys() == reading.types.keys()
    lines = index_path(log).read_text().splitlines(keepends=True)
    index_path(other).write_text(lines[0] + "".join(one for one in lines if '"type"' in one))
    result = cli("bag", "export", str(other), str(tmp_path / "b.bag"))
    assert (result.code, result.out) == (1, f"{tmp_path / 'b.bag'}: 1 message\n")
    assert_says(result.err, "/item", "one", str(2**32))
    assert_says(result.err, "/item", "some", "-1")


@pytest.mark.parametrize("level", [2, 200])
def test_a_byte_above_127_is_named_where_a_shipped_type_has_it_signed(tmp_path, level):
    path, store = tmp_path / "db3", own_types(2)
    bits = level - 256 * (level > 127)  # as the library writes it
    fields = {"level": bits, "name": "", "message": "", "hardware_id": "", "values": []}
    write_bag(path, store, Topic("/d", "diagnostic_msgs/msg/DiagnosticStatus", [fields]))
    reading, (message,) = _imported(path)
    assert message.level == bits
    assert [str(level) in row for row in reading.report.changes()] == [True] * (level > 127)
