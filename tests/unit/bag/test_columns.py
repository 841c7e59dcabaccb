"""Messages as columns, against the messages themselves."""

import numpy as np
import pytest
from fixtures.says import raises_saying

from lcmtools.bag.columns import Table, table
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import encode
from lcmtools.messages.path import parse_path, select
from lcmtools.types.geometry_msgs import TransformStamped, Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import Image, JointState, LaserScan
from lcmtools.types.std_msgs import Bool, Empty, String
from lcmtools.types.tf2_msgs import TFMessage


def _scan(number, beams=4, frame="laser"):
    scan = LaserScan()
    scan.header.frame_id, scan.header.stamp.sec = frame, number
    scan.ranges = [number + beam / 8 for beam in range(beams)]
    return scan


def _strings(*texts):
    messages = [String() for _ in texts]
    for message, text in zip(messages, texts, strict=True):
        message.data = text
    return messages


def _table(messages):
    return table(type(messages[0]), [encode(message) for message in messages])


def _assert_equal(messages):
    """Each value in each column is the message's own."""
    found = _table(messages)
    assert not found.malformed
    for name, column in found.columns.items():
        assert len(column) == len(messages)
        for row, message in zip(column, messages, strict=True):
            wanted = select(message, parse_path(name)).value
            assert np.array_equal(np.asarray(row), np.asarray(_plain(wanted))), name


def _plain(value):
    return list(value) if isinstance(value, bytes) else value


def test_numbers_of_nested_messages_are_columns_in_the_native_byte_order():
    twists = [Twist() for _ in range(5)]
    for number, twist in enumerate(twists):
        twist.linear.x, twist.angular.z = number / 3, -number
    found = _table(twists).columns
    assert found["linear.x"].tolist() == [number / 3 for number in range(5)]
    assert found["linear.x"].dtype == np.dtype("=f8")
    assert list(found) == [f"{a}.{b}" for a in ("linear", "angular") for b in "xyz"]
    _assert_equal(twists)


def test_arrays_have_an_axis_more():
    scans = [_scan(number) for number in range(6)]
    found = _table(scans).columns
    assert found["ranges"].shape == (6, 4)
    assert found["ranges"].dtype == np.dtype("=f4")
    assert found["intensities"].shape == (6, 0)
    assert found["header.frame_id"].tolist() == ["laser"] * 6
    _assert_equal(scans)


def test_messages_with_other_lengths_keep_their_place():
    scans = [_scan(number, beams, "ab" * beams) for number, beams in enumerate((3, 1, 3, 0, 2, 1))]
    found = _table(scans).columns
    assert [len(row) for row in found["ranges"]] == [3, 1, 3, 0, 2, 1]
    assert found["header.stamp.sec"].tolist() == list(range(6))
    assert found["header.frame_id"].tolist() == ["ab" * beams for beams in (3, 1, 3, 0, 2, 1)]
    _assert_equal(scans)


def test_messages_of_one_size_may_differ_in_their_lengths():
    long_name, many = JointState(), JointState()
    long_name.name, long_name.position = ["abcdefghi"], [1.0]
    many.name, many.position = ["a", "bcd"], [1.5]
    assert len(encode(long_name)) == len(encode(many))
    found = _table([long_name, many, long_name]).columns
    assert [list(row) for row in found["name"]] == [["abcdefghi"], ["a", "bcd"], ["abcdefghi"]]


def test_text_is_decoded():
    found = _table(_strings("", "abc", "äbc", "abd", "")).columns
    assert found["data"].tolist() == ["", "abc", "äbc", "abd", ""]


def test_bytes_and_booleans():
    image = Image()
    image.data = bytes(range(200))
    assert _table([image, image]).columns["data"].dtype == np.uint8
    flags = [Bool() for _ in range(3)]
    flags[1].data = True
    assert _table(flags).columns["data"].tolist() == [False, True, False]
    _assert_equal([image])


def test_arrays_of_messages_have_an_axis_more_for_each_field():
    messages = [TFMessage() for _ in range(4)]
    for number, message in enumerate(messages):
        message.transforms = [TransformStamped(), TransformStamped()]
        message.transforms[0].header.frame_id = "odom"
        message.transforms[1].header.frame_id = "base_link"
        message.transforms[1].transform.translation.x = float(number)
    found = _table(messages).columns
    assert found["transforms.header.frame_id"].tolist() == [["odom", "base_link"]] * 4
    assert found["transforms.transform.translation.x"].tolist() == [[0.0, n] for n in range(4)]


@pytest.mark.parametrize("cut", [0, 7, 8, 20, 40])
def test_what_cannot_be_decoded_is_named_and_left_out(cut):
    payloads = [encode(_scan(number)) for number in range(4)]
    payloads[2] = payloads[2][:cut]
    found = table(LaserScan, payloads)
    assert found.malformed == (2,)
    assert found.columns["header.stamp.sec"].tolist() == [0, 1, 3]


def test_a_length_that_cannot_be_is_malformed_and_costs_nothing():
    payload = bytearray(encode(_scan(1)))
    for length in (b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff"):
        payload[8:12] = length
        assert table(LaserScan, [bytes(payload)]).malformed == (0,)
    message = bytearray(encode(TFMessage()))
    message[8:12] = b"\x7f\xff\xff\xff"
    assert table(TFMessage, [bytes(message)]).malformed == (0,)


def test_no_message_has_columns_without_rows():
    found = table(Odometry, []).columns
    assert found["pose.pose.position.x"].shape == (0,)
    assert "header.frame_id" in found


def test_a_type_without_fields_has_no_columns():
    assert _table([Empty(), Empty()]) == Table({}, ())


def test_a_type_that_holds_itself_has_no_columns(odd):
    with raises_saying(DecodeError, "odd/Tree", "itself", "columns"):
        table(odd.Tree, [encode(odd.Tree())])
