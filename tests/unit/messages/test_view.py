"""Parts of messages as text, lines and columns; arrays and strings that are only named."""

import pytest

from lcmtools.formats.strict_json import write_json
from lcmtools.messages.path import parse_path, select
from lcmtools.messages.plain import (
    NOTHING,
    View,
    cells,
    plain_value,
)
from lcmtools.messages.text import FREE, Writer, format_message
from lcmtools.types.geometry_msgs import TransformStamped, Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker


def shown(message, path="", view=NOTHING):
    found = select(message, parse_path(path))
    return plain_value(found.value, found.target, view)


@pytest.fixture
def joints():
    message = JointState()
    message.header.stamp.nsec = 5
    message.name = ["left wheel", "right"]
    message.position = [1.0, float("inf")]
    return message


def test_strings_times_and_arrays_of_messages_look_the_same_too(joints):
    marker = Marker()
    marker.points = [type(marker.pose.position)() for _ in range(2)]
    transforms = TFMessage()
    transforms.transforms = [TransformStamped() for _ in range(2)]
    for message in (joints, marker, transforms):
        assert FREE.block(shown(message)) == format_message(message)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("position", "[1.0, inf]"),
        ("name", '- "left wheel"\n- right'),
        ("name[0]", '"left wheel"'),
        ("velocity", "[]"),
        ("header.stamp", "sec: 0\nnsec:         5"),
    ],
)
def test_parts_look_as_in_rostopic_echo(path, text, joints):
    assert FREE.block(shown(joints, path)) == text


def test_hidden_arrays_and_strings_are_named(joints):
    plain = shown(joints, view=View(hides_arrays=True, hides_strings=True))
    assert isinstance(plain, dict)
    assert plain["name"] == "<array type: string, length: 2>"
    assert plain["position"] == "<array type: float64, length: 2>"
    names = shown(joints, "name", View(hides_strings=True))
    assert names == ["<string length: 10>", "<string length: 5>"]
    assert FREE.block(plain["velocity"]) == '"<array type: float64, length: 0>"'


def test_flow_style_is_one_line(joints):
    assert FREE.flow(shown(joints, "header.stamp")) == "{sec: 0, nsec: 5}"
    assert FREE.flow(shown(joints, "name")) == '["left wheel", "right"]'


def test_longer_arrays_and_strings_are_cut(joints):
    joints.position = [1.0, 2.0, 3.0]
    view = View(longest=2)
    assert FREE.block(shown(joints, "position", view)) == "[1.0, 2.0, ...]"
    assert FREE.block(shown(joints, "name", view)) == "- le...\n- ri..."
    assert FREE.block(shown(joints, "name[1:]", view)) == "- ri..."
    assert write_json(shown(joints, "position", view)) == '[1.0,2.0,"..."]'
    assert FREE.block(shown(joints, "position", View(longest=3))) == "[1.0, 2.0, 3.0]"
    few = View(most_elements=1, ellipsis="... {} more")
    assert FREE.block(shown(joints, "position", few)) == "[1.0, ... 2 more]"
    two = View(longest=2, most_elements=1, ellipsis="... {} more")
    assert FREE.block(shown(joints, "position", two)) == "[1.0, 2.0, ...]"
    assert shown(joints, "position", View(longest=3, most_elements=1)) == [1.0, 2.0, 3.0]
    joints.name = ["a", "b", "c"]
    assert FREE.block(shown(joints, "name", view)) == "- a\n- b\n- ..."
    assert FREE.flow(shown(joints, "name", view)) == '["a", "b", ...]'


def test_a_table_has_no_columns_for_what_is_hidden_and_no_dots(joints):
    table = View(hides_arrays=True, hides_strings=True, is_table=True)
    assert cells(shown(joints, view=table)) == {"field.header.seq": 0, "field.header.stamp": 5}
    joints.position = [1.0, 2.0, 3.0]
    cut = View(longest=2, is_table=True)
    assert cells(shown(joints, "position", cut)) == {"field0": 1.0, "field1": 2.0}
    assert cells(shown(joints, "name[0]", cut)) == {"field": "le"}


def test_times_are_relative_and_lengths_of_time_are_not(joints):
    view = View(origin=2_000_000_000)
    assert FREE.block(shown(joints, "header.stamp", view)) == "sec: -2\nnsec:         5"
    marker = Marker()
    marker.lifetime.sec = 7
    assert FREE.flow(shown(marker, "lifetime", view)) == "{sec: 7, nsec: 0}"
    assert FREE.flow(shown(marker, "header.stamp", view)) == "{sec: -2, nsec: 0}"
    assert FREE.flow(shown(marker, "header.stamp.sec", view)) == "0"


def test_numbers_of_a_fixed_width_are_rostopics(joints):
    joints.position = [3.14159265, -2.5, 12345.678, 0.0, float("inf"), float("nan")]
    writer = Writer(5)
    assert writer.block(shown(joints, "position")) == ("[3.141, -2.50, 12345, 0.000, inf, nan]")
    assert writer.block(shown(joints, "header.stamp")) == "sec:     0\nnsec:     5"
    assert writer.flow([True, 1, "a"]) == '[True,     1, "a"]'
    assert writer.block(123456789) == "123456789"


@pytest.mark.parametrize(
    ("view", "changed"),
    [
        (NOTHING, set()),
        (View(most_elements=36, ellipsis="{} more"), {JointState, TFMessage}),
        (View(most_elements=35), {JointState, TFMessage, Odometry}),
        (View(most_elements=36, hides_arrays=True), {JointState, TFMessage, Odometry, Twist}),
        (View(longest=5), {JointState, TFMessage, Odometry, Twist}),
    ],
)
def test_a_view_that_shortens_arrays_leaves_types_without_longer_ones(view, changed):
    assert {cls for cls in (Twist, Odometry, JointState, TFMessage) if view.changes(cls)} == changed
