"""Folders of ROS 2: what their metadata says otherwise, what they lack, what they have besides."""

import re
import sqlite3
from contextlib import closing

import pytest
from fixtures.ros_bags import SECOND, Topic, own_types, read_bag, version_of, write_bag
from fixtures.says import assert_says, raises_saying
from mcap.writer import Writer
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from lcmtools.bag.ros_import import RosImport
from lcmtools.errors import InvalidFile
from lcmtools.observe.reading.log_file import LogFile

_BOTH = pytest.mark.parametrize("storage", ["db3", "mcap"])
_WORDS = Topic("/words", "std_msgs/msg/String", [{"data": f"{n}"} for n in range(3)])


def _folder(path, *more, compression="none", **definitions):
    write_bag(path, own_types(2, **definitions), _WORDS, *more, compression=compression)
    return path


def _storage(folder):
    (file,) = (one for one in folder.iterdir() if one.name != "metadata.yaml")
    return file


def _change(folder, *statements):
    """Change a folder's database."""
    with closing(sqlite3.connect(_storage(folder))) as base:
        for statement in statements:
            base.execute(statement)
        base.commit()


def _read(path):
    reading = RosImport()
    return reading, [(one.topic, one.message) for one in reading.read(path)]


def _assert_words(path):
    reading, found = _read(path)
    words = [message.data for topic, message in found if topic == "/words"]
    assert words == ["0", "1", "2"]
    return reading


_QOS = """
      offered_qos_profiles:
        - history: keep_last
          depth: 7
          reliability: strange
"""


def _other_qos(metadata):
    return re.sub(r"\n *offered_qos_profiles:.*(?:\n +- .*(?:\n {8,}.*)*)?\n", _QOS, metadata)


_METADATA = {
    "another QoS": _other_qos,
    "another version": lambda text: re.sub("version: 9", "version: 77", text),
    "another type": lambda text: text.replace("std_msgs/msg/String", "std_msgs/msg/Int32"),
    "no topics": lambda text: text.partition("topics_with_message_count")[0],
    "a folder before the file": lambda text: re.sub(r"- (\w+\.(db3|mcap))", r"- x/\1", text),
    "no YAML": lambda _: "{{{",
    "nothing": lambda _: "",
}


@_BOTH
@pytest.mark.parametrize("change", _METADATA)
def test_metadata_that_differs_from_the_files_does_no_harm(change, storage, tmp_path):
    folder = _folder(tmp_path / storage)
    metadata = folder / "metadata.yaml"
    before = metadata.read_text()
    metadata.write_text(_METADATA[change](before))
    assert metadata.read_text() != before
    assert _assert_words(folder).report.to_lines() == []


@_BOTH
@pytest.mark.parametrize("compression", ["none", "file", "message"])
def test_a_folder_without_metadata_is_read(compression, storage, tmp_path):
    folder = _folder(tmp_path / storage, compression=compression)
    assert len(read_bag(folder)) == 3
    assert _assert_words(folder).report.to_lines() == []
    (folder / "metadata.yaml").unlink()
    assert _assert_words(folder).report.to_lines() == []


def test_files_are_read_in_the_order_of_their_numbers(tmp_path):
    folder = tmp_path / "many"
    folder.mkdir()
    for number in (0, 1, 2, 10):
        topic = Topic("/n", "std_msgs/msg/Int32", [{"data": number}])
        write_bag(tmp_path / f"{number}_db3", own_types(2), topic)
        _storage(tmp_path / f"{number}_db3").rename(folder / f"many_{number}.db3")
    assert [message.data for _, message in _read(folder)[1]] == [0, 1, 2, 10]


def test_a_missing_or_damaged_file_costs_only_itself(tmp_path):
    folder = _folder(tmp_path / "db3")
    metadata = folder / "metadata.yaml"
    (folder / "b.db3").write_bytes(b"SQLite format 3\0" + b"x" * 200)
    (folder / "c.db3").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
    name = _storage_name(metadata)
    listed = "".join(f"\n  - {one}" for one in ("a.db3", "b.db3", "c.db3", name))
    metadata.write_text(re.sub(rf"\n *- {name}", listed, metadata.read_text(), count=1))
    rows = _assert_words(folder).report.to_lines()
    assert len(rows) == 3
    assert_says(rows[0], "a.db3", "missing")
    assert_says(rows[1], "b.db3", "damaged")
    assert_says(rows[2], "c.db3", "Git LFS")


def _storage_name(metadata):
    found = re.search(r"- (\S+\.db3)", metadata.read_text())
    assert found
    return found[1]


_ITEM = Topic("/item", "own_msgs/msg/Item", [{"x": 1}, {"x": 2}])
_TOPIC = "UPDATE topics SET {} WHERE type LIKE 'own%'"
_DEFINITION = "UPDATE message_definitions SET {} WHERE topic_type LIKE 'own%'"
_SRV = "encoded_message_definition = 'int64 a\n---\nint64 b\n'"
_STRANGE = {
    "an own type without a definition": (
        "own_msgs/msg/Item",
        ("DELETE FROM message_definitions WHERE topic_type LIKE 'own%'",),
    ),
    "a type that the recorder did not find": (
        "own_msgs/msg/Item",
        (_DEFINITION.format("encoding = 'unknown', encoded_message_definition = ''"),),
    ),
    "a service event": (
        "/add/_service_event has the type own_msgs/srv/Add_Event",
        (
            _DEFINITION.format(f"topic_type = 'own_msgs/srv/Add_Event', {_SRV}"),
            _TOPIC.format("type = 'own_msgs/srv/Add_Event', name = '/add/_service_event'"),
        ),
    ),
    "another format": ("my_format", (_TOPIC.format("serialization_format = 'my_format'"),)),
    "another encoding of the definition": (
        "flatbuffer",
        (_DEFINITION.format("encoding = 'flatbuffer'"),),
    ),
    "a definition of other fields": (
        "/item",
        (_DEFINITION.format("encoded_message_definition = 'float64[9] x'"),),
    ),
    "a topic that is not listed": ("does not name", ("DELETE FROM topics WHERE type LIKE 'own%'",)),
}


@pytest.mark.parametrize("name", _STRANGE)
def test_a_strange_topic_costs_only_itself(name, tmp_path):
    said, statements = _STRANGE[name]
    folder = _folder(tmp_path / "db3", _ITEM, Item="int32 x")
    _change(folder, *statements)
    (row,) = _assert_words(folder).report.to_lines()
    assert_says(row, "2 messages are left out", said)


_BEFORE_IRON = (
    "DROP TABLE message_definitions",
    "DROP TABLE schema",
    "ALTER TABLE topics DROP COLUMN type_description_hash",
)


def test_a_bag_of_before_iron_has_types_of_ros_but_no_definitions(tmp_path):
    folder = _folder(tmp_path / "db3", _ITEM, Item="int32 x")
    _change(folder, *_BEFORE_IRON)
    (row,) = _assert_words(folder).report.to_lines()
    assert_says(row, "/item", "own_msgs/msg/Item", "no definition")


@pytest.mark.parametrize("distribution", ["ROS2_FOXY", "ROS2_HUMBLE", "ROS2_JAZZY"])
def test_without_definitions_types_are_those_of_the_distribution(distribution, tmp_path):
    store = get_typestore(Stores[distribution])
    types = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](1, 2), "sonar")
    newer = {"variance": 0.5} if distribution == "ROS2_JAZZY" else {}
    values = {"radiation_type": 1, "field_of_view": 0.25, "min_range": 1.0, "max_range": 8.0}
    ranges = {"header": header, **values, "range": 3.5, **newer}
    folder = tmp_path / "db3"
    write_bag(folder, store, Topic("/sonar", "sensor_msgs/msg/Range", [ranges]))
    _change(folder, *_BEFORE_IRON)
    reading, ((_, message),) = _read(folder)
    assert reading.report.to_lines() == []
    assert {name: getattr(message, name) for name in values} == values
    assert message.range == 3.5


def test_nothing_replaces_a_good_log(tmp_path, cli):
    good, log = _folder(tmp_path / "db3"), tmp_path / "a.lcmlog"
    cli("bag", "import", str(good), str(log)).ok()
    before = log.read_bytes()
    empty, pointer, other = tmp_path / "empty", tmp_path / "a.bag", tmp_path / "none"
    write_bag(empty, own_types(2), _WORDS._replace(messages=[]))
    pointer.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    other.mkdir()
    for path, said in ((empty, "no messages"), (pointer, "git lfs pull"), (other, ".mcap")):
        result = cli("bag", "import", str(path), str(log), "--force")
        assert (result.code, result.out) == (2, "")
        assert_says(result.err, "bag import", str(path), said)
        assert log.read_bytes() == before


def test_topics_are_chosen(tmp_path, cli):
    folder, log = _folder(tmp_path / "db3", _ITEM, Item="int32 x"), str(tmp_path / "a.lcmlog")
    for words, count in (
        (("-t", "/words"), 3),
        (("-x", "/words"), 2),
        (("-t", "/*", "-x", "/i*"), 3),
        ((), 5),
    ):
        out = cli("bag", "import", str(folder), log, "--force", *words).ok()
        assert_says(out, f"{count} messages")
    result = cli("bag", "import", str(folder), log, "--force", "-t", "/nothing")
    assert result.code == 1
    assert_says(result.err, "no topic /nothing", "/item, /words")


def test_a_topic_that_is_not_chosen_is_not_complained_of(tmp_path, cli):
    folder, log = _folder(tmp_path / "db3", _ITEM, Item="int32 x"), str(tmp_path / "a.lcmlog")
    _change(folder, "DELETE FROM message_definitions WHERE topic_type LIKE 'own%'")
    assert cli("bag", "import", str(folder), log).code == 1
    assert cli("bag", "import", str(folder), log, "--force", "-x", "/item").ok()


def test_part_of_a_bag_is_named_as_that(tmp_path):
    folder = _folder(tmp_path / "db3")
    for file in folder.iterdir():
        with raises_saying(InvalidFile, "part of a ROS 2 bag", str(folder)):
            list(RosImport().read(file))


_TRANSIENT_LOCAL = Qos(
    QosHistory.KEEP_LAST,
    1,
    QosReliability.RELIABLE,
    QosDurability.TRANSIENT_LOCAL,
    *[QosTime(0, 0)] * 2,
    QosLiveliness.AUTOMATIC,
    QosTime(0, 0),
    avoid_ros_namespace_conventions=False,
)


def _write_latched(path):
    """Write a map that is latched, and scans that are not."""
    text = {"data": b"\0\1\0\0\2\0\0\0a\0"} if path.suffix != ".bag" else {"data": b"\1\0\0\0a"}
    if path.suffix == ".mcap":
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start("ros2")
            schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
            qos = {"offered_qos_profiles": "- history: 1\n  durability: transient_local"}
            for topic, about in (("/map", qos), ("/scan", {})):
                channel = writer.register_channel(topic, "cdr", schema, about)
                for time in range(1 if about else 5):
                    writer.add_message(channel, time * SECOND, text["data"], time * SECOND)
            writer.finish()
        return
    store = own_types(version_of(path))
    latched = (
        {"latching": 1} if path.suffix == ".bag" else {"offered_qos_profiles": [_TRANSIENT_LOCAL]}
    )
    make = Writer1(path) if path.suffix == ".bag" else Writer2(path, version=9)
    with make as writer:
        for topic, about in (("/map", latched), ("/scan", {})):
            one = writer.add_connection(topic, "std_msgs/msg/String", typestore=store, **about)
            for time in range(1 if about else 5):
                writer.write(one, time * SECOND, text["data"])


@pytest.mark.parametrize("target", ["a.bag", "cut.bag", "db3", "a.mcap"])
def test_what_a_bag_says_was_latched_comes_before_a_part(target, tmp_path, cli):
    path, log, part = tmp_path / target, tmp_path / "a.lcmlog", tmp_path / "part.lcmlog"
    _write_latched(path)
    if target == "cut.bag":  # without its index
        path.write_bytes(path.read_bytes()[:-100])
    assert cli("bag", "import", str(path), str(log)).code == (target == "cut.bag")
    cut = cli("bag", "cut", str(log), str(part), "-s", "2s")
    assert (cut.code, cut.err) == (0, "")
    with LogFile(part) as made:
        assert next(made.packets()).channel == "/map"
