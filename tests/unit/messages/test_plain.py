"""Messages as plain values and as JSON."""

import json
import math

import numpy as np
import pytest
from fixtures.says import assert_says

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.fill import fill
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.plain import cells, to_json, to_plain
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs


def test_a_message_becomes_dicts_lists_and_numbers():
    message = sensor_msgs.CompressedImage()
    message.format, message.data = "png", b"\x01\xff"
    assert to_plain(message) == {
        "header": {"seq": 0, "stamp": {"sec": 0, "nsec": 0}, "frame_id": ""},
        "format": "png",
        "data": [1, 255],
    }


def test_what_is_numpys_becomes_plain():
    message = sensor_msgs.LaserScan()
    message.range_max = np.float32(0.5)
    message.ranges = np.array([1, 2])
    message.intensities = [np.float64(3)]
    plain = to_plain(message)
    assert (plain["range_max"], plain["ranges"], plain["intensities"]) == (0.5, [1, 2], [3.0])
    assert {type(value) for value in plain["ranges"]} == {int}
    assert json.loads(to_json(message))["ranges"] == [1, 2]


def test_plain_values_keep_infinities_and_json_writes_them_as_text():
    message = sensor_msgs.LaserScan()
    message.ranges, message.range_max = [math.inf, -math.inf, 1.5], math.nan
    assert to_plain(message)["ranges"] == [math.inf, -math.inf, 1.5]
    loaded = json.loads(to_json(message))
    assert (loaded["ranges"], loaded["range_max"]) == (["inf", "-inf", 1.5], "nan")
    again = draft_from_values(sensor_msgs.LaserScan, [to_json(message)]).message
    assert again.ranges == message.ranges
    assert math.isnan(again.range_max)


def test_json_is_one_compact_line():
    message = std_msgs.String()
    message.data = 'é\n"'
    assert to_json(message) == '{"data":"é\\n\\""}'


@pytest.mark.parametrize(
    "text", ["\x7f", "\x85", "\u2028", "\ufeff", "\uffff", "😀", "\\ud83d", "\0"]
)
def test_json_is_yaml_too(text):
    message = std_msgs.String()
    message.data = f"a{text}b"
    line = to_json(message)
    assert json.loads(line)["data"] == message.data
    assert draft_from_values(std_msgs.String, [line]).message.data == message.data


def test_a_message_is_filled_from_numbers_and_booleans_too():
    message = geometry_msgs.Twist()
    fill(message, {"linear": {"x": 1.5, "y": 2}, "angular": [0, 0, -1]})
    assert (message.linear.x, message.linear.y, message.angular.z) == (1.5, 2.0, -1.0)
    flag = std_msgs.Bool()
    fill(flag, {"data": True})
    assert flag.data is True


def test_fields_that_are_not_named_stay():
    message = geometry_msgs.Twist()
    message.linear.y = 7.0
    fill(message, {"linear": {"x": 1}})
    fill(message, None)
    assert (message.linear.x, message.linear.y) == (1.0, 7.0)


def test_half_characters_are_no_text():
    for message in (std_msgs.String(), sensor_msgs.CompressedImage()):
        with pytest.raises(ValueMismatch) as caught:
            fill(message, {"data": "\ud800"})
        assert_says(str(caught.value), "data: expected text", "'\\ud800'")


def test_bytes_that_are_not_utf_8_are_text_as_json_and_yaml_have_them():
    for value in (b"D\xfcsseldorf", "D\udcfcsseldorf"):
        message = std_msgs.String()
        fill(message, {"data": value})
        assert encode(message)[-11:] == b"D\xfcsseldorf\0"


@pytest.mark.parametrize(
    ("value", "line"),
    [
        ({"linear": {"x": True, "y": None}}, "linear.y: expected a number, got nothing"),
        ({"linear": {"x": b"1"}}, "linear.x: expected a number, got binary data"),
        ({"linear": {"x": "\udcff"}}, "linear.x: expected a number, got '\\udcff'"),
        ({"linear": 5}, "linear: expected fields (x, y, z), got 5"),
    ],
)
def test_values_that_do_not_fit_are_refused(value, line):
    with pytest.raises(ValueMismatch) as caught:
        fill(geometry_msgs.Twist(), value)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("text", "number"),
    [
        *(("-nan", math.nan), ("NaN", math.nan), ("+.nan", math.nan)),
        *(("Infinity", math.inf), ("-Infinity", -math.inf), ("-.inf", -math.inf)),
    ],
)
def test_what_is_not_finite_is_taken_as_c_json_and_yaml_write_it(text, number):
    message = std_msgs.Float64()
    fill(message, {"data": text})
    assert str(message.data) == str(number)


@pytest.mark.parametrize(
    ("plain", "columns"),
    [
        (
            {"a": 1, "points": [{"x": 2.0}, {"x": 3.0}], "empty": [], "s": "t"},
            {"field.a": 1, "field.points0.x": 2.0, "field.points1.x": 3.0, "field.s": "t"},
        ),
        (5, {"field": 5}),
        ([0.5, 1.5], {"field0": 0.5, "field1": 1.5}),
        ([[1, 2], [3]], {"field0_0": 1, "field0_1": 2, "field1_0": 3}),
        ({"ok": True, "bad": [False]}, {"field.ok": 1, "field.bad0": 0}),
        ({"stamp": {"sec": 3, "nsec": 5}}, {"field.stamp": 3_000_000_005}),
        ({"stamp": {"sec": -1, "nanosec": 500_000_000}}, {"field.stamp": -500_000_000}),
        ({"sec": 1, "nsec": 2}, {"field": 1_000_000_002}),
        ({}, {}),
    ],
)
def test_columns_have_rostopics_names(plain, columns):
    assert cells(plain) == columns


def test_no_column_of_a_large_grid_hides_another_one():
    grid = {"m": [[row * 12 + column for column in range(12)] for row in range(12)]}
    assert [*cells(grid).values()] == [*range(144)]
    assert (cells(grid)["field.m1_11"], cells(grid)["field.m11_1"]) == (23, 133)
