"""Bags of ROS 1 that were not closed, are damaged, or have strange topics."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fixtures.command import Result
from fixtures.ros_bags import SECOND, Topic, own_types, read_bag, write_bag
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


def test_a_time_in_a_type_of_its_own_is_the_time(
    tmp_path: Path, cli: Callable[..., Result]
) -> None:
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
    found: dict[str, Any] = {one.topic: one.message for one in RosImport().read(path)}
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
