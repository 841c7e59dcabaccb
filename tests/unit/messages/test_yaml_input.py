"""Messages from what users type, and what is said when they type something else."""

import math

import pytest

from lcmtools.messages.codec import encode
from lcmtools.messages.documents import parse_values
from lcmtools.messages.message_template import draft_from_values, drafts_from_lines
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs
from lcmtools.types.builtin_interfaces import Time
from lcmtools.types.nav_msgs import Path


def twist(*texts):
    message = draft_from_values(geometry_msgs.Twist, texts).message
    return [getattr(vector, axis) for vector in (message.linear, message.angular) for axis in "xyz"]


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        ([], [0, 0, 0, 0, 0, 0]),
        (["{}"], [0, 0, 0, 0, 0, 0]),
        ([""], [0, 0, 0, 0, 0, 0]),
        (["linear: {x: 1}"], [1, 0, 0, 0, 0, 0]),
        (["{linear: {x: 1, y: 2}, angular: {z: 3}}"], [1, 2, 0, 0, 0, 3]),
        (["linear:\n  x: 1\nangular:\n  z: -3"], [1, 0, 0, 0, 0, -3]),
        (['{"linear":{"x":1e-3}}'], [0.001, 0, 0, 0, 0, 0]),
        (["[1, 2, 3]", "[4, 5, 6]"], [1, 2, 3, 4, 5, 6]),
        (["[[1, 2, 3], [4, 5, 6]]"], [1, 2, 3, 4, 5, 6]),
        (["[1, 2, 3]", "{z: 6}"], [1, 2, 3, 0, 0, 6]),
        (["linear: [1, 2, 3]"], [1, 2, 3, 0, 0, 0]),
        (["{linear: &a {x: 1}, angular: *a}"], [1, 0, 0, 1, 0, 0]),
        (["linear:\nangular: {x: 1}"], [0, 0, 0, 1, 0, 0]),
        (["linear: {x: 1}\n---\n"], [1, 0, 0, 0, 0, 0]),
        (["linear: {x: '1'}"], [1, 0, 0, 0, 0, 0]),
    ],
)
def test_fields_are_given_by_name_or_in_order(texts, expected):
    assert twist(*texts) == expected


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("5", 5.0),
        ("-5", -5.0),
        ("+5", 5.0),
        ("1e-3", 0.001),
        ("1E3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("007", 7.0),
        ("0x1F", 31.0),
        ("0b11", 3.0),
        ("-0.0", -0.0),
        ("inf", math.inf),
        (".inf", math.inf),
        ("-inf", -math.inf),
        ("-.Inf", -math.inf),
        ("+INF", math.inf),
        ("'1.5'", 1.5),
        ("!!float 1.5", 1.5),
    ],
)
def test_numbers_are_read_as_people_write_them(text, number):
    data = draft_from_values(std_msgs.Float64, [text]).message.data
    assert (data, math.copysign(1, data)) == (number, math.copysign(1, number))


@pytest.mark.parametrize("text", ["nan", ".nan", "NaN", ".NAN"])
def test_nan_is_a_number(text):
    assert math.isnan(draft_from_values(std_msgs.Float64, [text]).message.data)


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("5", 5),
        ("-128", -128),
        ("007", 7),
        ("0x1F", 31),
        ("-0x1f", -31),
        ("0o17", 15),
        ("0b101", 5),
        ("1e2", 100),
        ("5.0", 5),
        ("1.27e2", 127),
    ],
)
def test_integers_are_read_as_people_write_them(text, number):
    assert draft_from_values(std_msgs.Int8, [text]).message.data == number


@pytest.mark.parametrize("number", [-(1 << 63), (1 << 63) - 1, 123456789012345678])
def test_large_integers_lose_nothing(number):
    assert draft_from_values(std_msgs.Int64, [str(number)]).message.data == number


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *((text, True) for text in ("true", "True", "YES", "on", "1", "'true'")),
        *((text, False) for text in ("false", "no", "OFF", "0", '"0"')),
    ],
)
def test_booleans_are_read_as_people_write_them(text, value):
    assert draft_from_values(std_msgs.Bool, [text]).message.data is value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("hello", "hello"),
        ("hello world", "hello world"),
        ("data: hello", "hello"),
        ("{data: hello}", "hello"),
        ("[hello]", "hello"),
        ("on", "on"),
        ("007", "007"),
        ("1e-3", "1e-3"),
        ("2024-01-01", "2024-01-01"),
        ("12:30:45", "12:30:45"),
        ("data: 12:30", "12:30"),
        ("http://example.org", "http://example.org"),
        ("note:this", "note:this"),
        ("=", "="),
        ("data: ~", ""),
        ("data: null", ""),
        ("data:", ""),
        ("data: '~'", "~"),
        ('data: "null"', "null"),
        ("data: !!str null", "null"),
        ('data: ""', ""),
        ("data: é", "é"),
        ('data: "a\\tb\\u00e9"', "a\tbé"),
        ("data: |\n  a\n  b", "a\nb"),
        ("data: 'data:hello'", "data:hello"),
    ],
)
def test_text_stays_as_it_is_written(text, value):
    assert draft_from_values(std_msgs.String, [text]).message.data == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("data: [1, 2, 255]", b"\x01\x02\xff"),
        ("data: [0xff, 1e1]", b"\xff\x0a"),
        ("data: hé", "hé".encode()),
        ("data: !!binary aGVsbG8=", b"hello"),
        ("data: !!binary |\n  aGVs\n  bG8=", b"hello"),
        ("data: []", b""),
        ("data: ''", b""),
    ],
)
def test_bytes_are_numbers_text_or_base64(text, value):
    assert draft_from_values(sensor_msgs.CompressedImage, [text]).message.data == value


@pytest.mark.parametrize(
    "text",
    ["{sec: 1, nsec: 2}", "{secs: 1, nsecs: 2}", "{sec: 1, nanosec: 2}", "[1, 2]"],
)
def test_times_have_the_names_of_ros_1_and_ros_2(text):
    assert to_plain(draft_from_values(std_msgs.Time, [text]).message) == {"sec": 1, "nsec": 2}
    assert to_plain(draft_from_values(Time, [text]).message) == {"sec": 1, "nanosec": 2}


def test_arrays_of_messages_are_lists_of_mappings_or_lists():
    text = "poses: [{pose: {position: {x: 1}}}, [{frame_id: map}, [[2, 0, 0], [0, 0, 0, 1]]]]"
    first, second = draft_from_values(Path, [text]).message.poses
    assert first.pose.position.x == 1.0
    assert (second.header.frame_id, second.pose.position.x, second.pose.orientation.w) == (
        "map",
        2.0,
        1.0,
    )


def test_an_array_may_be_given_alone_where_it_is_the_only_field(odd):
    transforms = "[{child_frame_id: a}, {child_frame_id: b}]"
    message = draft_from_values(message_class("tf2_msgs/TFMessage"), [transforms]).message
    assert [t["child_frame_id"] for t in to_plain(message)["transforms"]] == ["a", "b"]
    assert len(draft_from_values(odd.Many, ["[{}, {}]"]).message.items) == 2
    for text in ("[[1, 2], [3, 4]]", "[[1, 2]]"):
        assert draft_from_values(odd.Flat, [text]).message.grid[0] == [1.0, 2.0]


def test_bytes_of_several_dimensions_may_be_text(odd):
    message = draft_from_values(
        odd.Shapes, ["{keys: [abc, [1, 2, 3]], key: [], grid: [a, b]}"]
    ).message
    assert message.keys == [b"abc", b"\x01\x02\x03"]
    assert message.key == bytes(4)
    assert message.grid == [b"a", b"b"]


def test_an_alias_may_be_a_field_name():
    assert parse_values(["[&x linear, {*x : 1}]"]) == ["linear", {"linear": "1"}]


def test_every_argument_is_parsed_on_its_own():
    assert parse_values(["[1, 2]", "a: b", "", "'~'"]) == [["1", "2"], {"a": "b"}, None, "~"]


def texts_in(text):
    drafts = drafts_from_lines(std_msgs.String, text.split("\n"))
    return [draft.message.data for draft in drafts if draft]


def test_every_document_of_a_text_is_a_message():
    assert texts_in("data: a\n---\n\n---\n{data: b}\n---\nc\n") == ["a", "b", "c"]


def test_lines_of_json_are_documents_too():
    text = '{"data":"{a}"}\n\n# a comment\n{"data":"b"}\r\n---\n{"data": "c"}\n'
    assert texts_in(text) == ["{a}", "b", "c"]


def test_no_message_comes_from_an_empty_text():
    assert texts_in("") == []


def test_a_pause_between_lines_is_handed_on():
    lines = ["data: a", None, "---", None, "data: b"]
    drafts = drafts_from_lines(std_msgs.String, lines)
    assert [draft and draft.message.data for draft in drafts] == [None, "a", None, "b"]


def test_a_value_that_fits_can_be_encoded():
    message = draft_from_values(sensor_msgs.JointState, ["{name: [a], position: [1]}"]).message
    assert encode(message)
    assert (message.name_length, message.position_length) == (1, 1)
