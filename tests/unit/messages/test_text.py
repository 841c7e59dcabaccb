"""The look of a message in a terminal."""

import math

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.messages.codec import decode, encode
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.text import format_message, quoted
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs
from lcmtools.types.builtin_interfaces import Time
from lcmtools.types.tf2_msgs import TFMessage


def test_nested_messages_are_indented():
    message = geometry_msgs.Twist()
    message.linear.x, message.angular.z = 1e-07, -0.0
    assert format_message(message) == (
        "linear: \n  x: 1e-07\n  y: 0.0\n  z: 0.0\nangular: \n  x: 0.0\n  y: 0.0\n  z: -0.0"
    )


def test_arrays_of_numbers_stand_in_a_line_and_lengths_are_hidden():
    message = sensor_msgs.JointState()
    message.header.stamp.sec, message.header.stamp.nsec = 1700000000, 5
    message.header.frame_id = "base_link"
    message.name = ["left_wheel", "no", "1", 'a "b"', ""]
    message.position = [0.5, math.inf, -math.inf, math.nan]
    assert format_message(message) == (
        "header: \n"
        "  seq: 0\n"
        "  stamp: \n"
        "    sec: 1700000000\n"
        "    nsec:         5\n"
        '  frame_id: "base_link"\n'
        "name: \n"
        "  - left_wheel\n"
        '  - "no"\n'
        '  - "1"\n'
        '  - "a \\"b\\""\n'
        "  - ''\n"
        "position: [0.5, inf, -inf, nan]\n"
        "velocity: []\n"
        "effort: []"
    )


def test_messages_in_arrays_are_items():
    message = TFMessage()
    assert format_message(message) == "transforms: []"
    message.transforms = [geometry_msgs.TransformStamped(), geometry_msgs.TransformStamped()]
    lines = format_message(message).splitlines()
    assert lines[:5] == [
        "transforms: ",
        "  - ",
        "    header: ",
        "      seq: 0",
        "      stamp: ",
    ]
    assert lines.count("  - ") == 2


@pytest.mark.parametrize(
    ("message", "field", "value", "text"),
    [
        (std_msgs.Bool(), "data", True, "data: True"),
        (std_msgs.String(), "data", "", "data: ''"),
        (std_msgs.String(), "data", "on", 'data: "on"'),
        (
            std_msgs.String(),
            "data",
            "é\n\t\"'\\😀\x85",
            'data: "é\\n\\t\\"\'\\\\😀\\N"',
        ),
        (std_msgs.UInt8(), "data", 65, "data: 65"),
        (Time(), "nanosec", 123456789, "sec: 0\nnanosec: 123456789"),
        (Time(), "nanosec", 5, "sec: 0\nnanosec:         5"),
        (sensor_msgs.CompressedImage(), "data", b"A\xff", "data: [65, 255]"),
    ],
)
def test_values_look_as_in_rostopic_echo(message, field, value, text):
    setattr(message, field, value)
    assert format_message(message).endswith(text)


def test_a_message_without_fields_is_an_empty_line():
    assert format_message(std_msgs.Empty()) == ""


def test_a_float_of_32_bits_shows_the_number_that_it_is():
    message = std_msgs.Float32()
    message.data = 0.1
    decoded = decode(std_msgs.Float32, encode(message))
    assert format_message(decoded) == "data: 0.10000000149011612"


def test_arrays_of_arrays_and_empty_messages(odd):
    message = odd.Shapes()
    message.words = [["a", "b c"], ["", "d"]]
    assert format_message(message) == (
        "grid: []\n"
        "numbers: []\n"
        "key: [0, 0, 0, 0]\n"
        "keys: [[0, 0, 0], [0, 0, 0]]\n"
        "flags: [False, False]\n"
        "words: \n"
        "  - \n"
        "    - a\n"
        '    - "b c"\n'
        "  - \n"
        "    - ''\n"
        "    - d\n"
        "pairs: \n"
        "  - \n"
        "    - \n"
        "    - \n"
        "  - \n"
        "    - \n"
        "    - \n"
        "nothing: "
    )
    assert encode(draft_from_values(odd.Shapes, [format_message(message)]).message) == encode(
        message
    )


@given(st.text(min_size=1))
def test_strings_are_quoted_so_that_a_terminal_can_show_them(text):
    assert quoted(text).isprintable()
    assert yaml.safe_load(quoted(text)) == text


@given(st.text(st.characters(codec="ascii"), min_size=1))
def test_strings_in_ascii_are_quoted_as_the_yaml_library_does(text):
    assert quoted(text) == yaml.dump(text, default_style='"', width=math.inf).rstrip("\n")


@pytest.mark.parametrize(
    "text", ["y", "Null", "true", "-", "~", "a b", "1.0", "é", "/a/b.c-d", "_"]
)
def test_words_in_arrays_mean_the_same_to_any_yaml_parser(text):
    message = sensor_msgs.JointState()
    message.name = [text]
    assert yaml.safe_load(format_message(message))["name"] == [text]


def test_text_that_is_not_utf_8_is_binary_with_a_comment_for_people():
    message = std_msgs.String()
    message.data = "D\udcfc #"
    text = format_message(message)
    assert text == "data: !!binary \"RPwgIw==\" # b'D\\xfc #'"
    assert yaml.safe_load(text) == {"data": b"D\xfc #"}
