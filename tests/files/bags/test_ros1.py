"""Bags of ROS 1 that were not closed, are damaged, or have strange topics."""

from pathlib import Path
from typing import Any

import pytest
from fixtures.ros_bags import SECOND, Topic, own_types, write_bag
from fixtures.says import assert_says
from rosbags.rosbag1 import Writer
from rosbags.rosbag1.reader import Reader
from rosbags.typesys.store import Typestore

from lcmtools.bag.ros_import import RosImport
from lcmtools.bag.ros_reading import bag_messages

_COUNT = 6


def _write(path: Path, compression: str = "none", store: Typestore | None = None) -> None:
    """Write numbers, in chunks of two."""
    store = store or own_types(1)
    with Writer(path) as writer:
        if compression != "none":
            writer.set_compression(Writer.CompressionFormat[compression])
        writer.chunk_threshold = 30
        kind = "std_msgs/msg/Int32"
        connection = writer.add_connection("/n", kind, typestore=store)
        for number in range(_COUNT):
            data = store.serialize_ros1(store.types[kind](data=number), kind)
            writer.write(connection, number * SECOND, data)


def _chunks(path: Path) -> int:
    with Reader(path) as reader:
        return len(reader.chunk_infos)


def test_cut_off_anywhere_it_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    _write(path)
    assert _chunks(path) > 1
    whole, before = path.read_bytes(), 0
    for size in range(4110, len(whole)):  # after the head
        path.write_bytes(whole[:size])
        damage: list[str] = []
        count = len(list(bag_messages(path, damage.append)))
        assert count >= before
        assert_says(damage[0], str(path), "without its index")
        before = count
    assert before == _COUNT


def test_a_bag_that_was_not_closed_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    _write(path)
    whole = path.read_bytes()
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    path.write_bytes(whole[:place] + bytes(8) + whole[place + 8 :])
    reading = RosImport()
    found: list[Any] = [one.message for one in reading.read(path)]
    assert [one.data for one in found] == [*range(_COUNT)]
    (row,) = reading.report.rows()
    assert_says(row, "a.bag", "not indexed")


@pytest.mark.parametrize(
    ("definition", "said"),
    [
        (b"uint333 x", "no definition of own_msgs/uint333"),
        (b"Strange", "cannot be read"),
        (b"string  x", "are no own_msgs/Item"),
    ],
)
def test_a_strange_definition_costs_only_its_topic(
    definition: bytes, said: str, tmp_path: Path
) -> None:
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
    (row,) = reading.report.rows()
    assert_says(row, "1 messages", "/item", said)
