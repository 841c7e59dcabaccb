"""Bags of ROS 1 that were not closed, are damaged, or have strange topics."""

import pytest
from fixtures.ros_bags import SECOND, Topic, own_types, read_bag, write_bag
from fixtures.says import assert_says
from rosbags.rosbag1 import Writer
from rosbags.rosbag1.reader import Reader

from lcmtools.bag import ros_reading
from lcmtools.bag.ros_import import RosImport
from lcmtools.bag.ros_reading import bag_messages

_COUNT = 6


def _write(path, compression="none", store=None, numbers=range(_COUNT), threshold=30):
    """Write numbers at their times, in chunks of at least ``threshold`` bytes."""
    store = store or own_types(1)
    writer = Writer(path)
    if compression != "none":
        writer.set_compression(Writer.CompressionFormat[compression])
    writer.chunk_threshold = threshold
    with writer:
        kind = "std_msgs/msg/Int32"
        connection = writer.add_connection("/n", kind, typestore=store)
        for number in numbers:
            data = store.serialize_ros1(store.types[kind](data=number), kind)
            writer.write(connection, number * SECOND, data)


def _forget_index(path):
    """Let a bag be as before it was closed."""
    whole = path.read_bytes()
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    path.write_bytes(whole[:place] + bytes(8) + whole[place + 8 :])


def _chunks(path):
    with Reader(path) as reader:
        return len(reader.chunk_infos)


def test_cut_off_anywhere_it_is_read_as_far_as_it_goes(tmp_path):
    path = tmp_path / "a.bag"
    _write(path)
    assert _chunks(path) > 1
    whole, before = path.read_bytes(), 0
    for size in range(4110, len(whole)):  # after the head
        path.write_bytes(whole[:size])
        damage = []
        count = len(list(bag_messages(path, damage.append)))
        assert count >= before
        assert_says(damage[0], str(path), "without its index")
        before = count
    assert before == _COUNT


def test_a_bag_that_was_not_closed_is_read(tmp_path):
    path = tmp_path / "a.bag"
    _write(path)
    _forget_index(path)
    reading = RosImport()
    found = [one.message for one in reading.read(path)]
    assert [one.data for one in found] == [*range(_COUNT)]
    (row,) = reading.report.to_lines()
    assert_says(row, "a.bag", "not indexed")


@pytest.mark.parametrize("has_index", [True, False])
@pytest.mark.parametrize("compression", ["BZ2", "LZ4"])
def test_a_chunk_that_unpacks_to_too_much_is_refused_in_one_line(
    compression, *, has_index, tmp_path, monkeypatch
):
    path = tmp_path / "a.bag"
    _write(path, compression)
    if not has_index:
        _forget_index(path)
    assert len(list(bag_messages(path, str))) == _COUNT
    monkeypatch.setattr("lcmtools.bag.mcap_reading._MOST_OF_CHUNK", 40)
    damage = []
    assert list(bag_messages(path, damage.append)) == []
    assert_says(damage[-1], "a.bag is damaged", "its content has more than 40 bytes")
    assert len(damage) == (1 if has_index else 2)


@pytest.mark.parametrize(
    ("definition", "said"),
    [
        (b"uint333 x", "no definition of own_msgs/uint333"),
        (b"Strange", "cannot be read"),
        (b"string  x", "are no own_msgs/Item"),
    ],
)
def test_a_strange_definition_costs_only_its_topic(definition, said, tmp_path):
    path, store = tmp_path / "a.bag", own_types(1, Item="uint64 xx")
    words = Topic("/words", "std_msgs/msg/String", [{"data": "a"}] * 3)
    write_bag(path, store, words, Topic("/item", "own_msgs/msg/Item", [{"xx": 1}]))
    line = b"uint64 xx"
    assert path.read_bytes().count(line)
    path.write_bytes(
        path.read_bytes().replace(line, definition.ljust(len(line), b" ")[: len(line)])
    )
    reading = RosImport()
    assert [one.topic for one in reading.read(path)] == ["/words"] * 3
    (row,) = reading.report.to_lines()
    assert_says(row, "1 messages", "/item", said)


def test_a_time_in_a_type_of_its_own_is_the_time(tmp_path, cli):
    path, log, back = tmp_path / "a.bag", tmp_path / "a.lcmlog", tmp_path / "b.bag"
    store = own_types(1, Item="std_msgs/Time at\nstd_msgs/Duration[] some\ntime plain")
    types = store.types
    time = types["builtin_interfaces/msg/Time"](sec=5, nanosec=6)
    held = types["std_msgs/msg/Time"](time)
    some = types["std_msgs/msg/Duration"](types["builtin_interfaces/msg/Duration"](-7, 8))
    write_bag(
        path,
        store,
        Topic("/time", "std_msgs/msg/Time", [{"data": time}]),
        Topic("/item", "own_msgs/msg/Item", [{"at": held, "some": [some], "plain": time}]),
    )
    cli("bag", "import", str(path), str(log)).ok()
    found = {one.topic: one.message for one in RosImport().read(path)}
    assert (found["/time"].sec, found["/time"].nsec) == (5, 6)
    assert (found["/item"].at.sec, found["/item"].some[0].sec, found["/item"].plain.nsec) == (
        5,
        -7,
        6,
    )
    cli("bag", "export", str(log), str(back)).ok()
    assert read_bag(back) == read_bag(path)
    digests = []
    for one in (path, back):
        with Reader(one) as reader:
            digests.append([(each.topic, each.digest) for each in reader.connections])
    assert digests[0] == digests[1]


def test_chunks_whose_times_alternate_are_unpacked_once(tmp_path, monkeypatch):
    path, unpacked = tmp_path / "a.bag", []
    whole = ros_reading.decompressed_chunk

    def count(kind, data):
        unpacked.append(kind)
        return whole(kind, data)

    monkeypatch.setattr(ros_reading, "decompressed_chunk", count)
    _write(path, numbers=(0, 1, 3, 2, 4), threshold=70)
    assert [one.message.data for one in RosImport().read(path)] == [0, 1, 2, 3, 4]
    assert len(unpacked) == _chunks(path) == 3
