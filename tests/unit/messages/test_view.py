"""Parts of messages as text, lines and columns; arrays and strings that are only named."""

import pytest

from lcmtools.messages.codec import decode, encode
from lcmtools.messages.path import Path, parse_path, select
from lcmtools.messages.plain import Plain, to_plain
from lcmtools.messages.registry import Message, message_class, type_names
from lcmtools.messages.text import format_message
from lcmtools.messages.view import Hidden, columns, format_flow, format_plain, plain_selection
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker

NOTHING = Hidden()


def shown(message: Message, path: str = "", hidden: Hidden = NOTHING) -> Plain:
    return plain_selection(select(message, parse_path(path)), hidden)


@pytest.fixture
def joints() -> JointState:
    message = JointState()
    message.header.stamp.nsec = 5
    message.name = ["left wheel", "right"]
    message.position = [1.0, float("inf")]
    return message


@pytest.mark.parametrize("name", type_names())
def test_a_whole_message_looks_the_same_as_plain_value_and_as_message(name: str) -> None:
    cls = message_class(name)
    message = decode(cls, encode(cls()))
    plain = plain_selection(select(message, Path()), NOTHING)
    assert plain == to_plain(message)
    assert format_plain(plain).splitlines() == format_message(message).splitlines()


def test_strings_times_and_arrays_of_messages_look_the_same_too(joints: JointState) -> None:
    marker = Marker()
    marker.points = [type(marker.pose.position)() for _ in range(2)]
    transforms = TFMessage()
    transforms.transforms = [message_class("geometry_msgs/TransformStamped")() for _ in range(2)]
    for message in (joints, marker, transforms):
        assert format_plain(shown(message)) == format_message(message)


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
def test_parts_look_as_in_rostopic_echo(path: str, text: str, joints: JointState) -> None:
    assert format_plain(shown(joints, path)) == text


def test_hidden_arrays_and_strings_are_named(joints: JointState) -> None:
    plain = shown(joints, hidden=Hidden(arrays=True, strings=True))
    assert isinstance(plain, dict)
    assert plain["name"] == "<array type: string, length: 2>"
    assert plain["position"] == "<array type: float64, length: 2>"
    names = shown(joints, "name", Hidden(strings=True))
    assert names == ["<string length: 10>", "<string length: 5>"]
    assert format_plain(plain["velocity"]) == '"<array type: float64, length: 0>"'


def test_flow_style_is_one_line(joints: JointState) -> None:
    assert format_flow(shown(joints, "header.stamp")) == "{sec: 0, nsec: 5}"
    assert format_flow(shown(joints, "name")) == '["left wheel", "right"]'


def test_columns_have_rostopics_names() -> None:
    plain: Plain = {"a": 1, "points": [{"x": 2.0}, {"x": 3.0}], "empty": [], "s": "t"}
    assert columns(plain) == {
        "field.a": 1,
        "field.points0.x": 2.0,
        "field.points1.x": 3.0,
        "field.s": "t",
    }
    assert columns(5) == {"field": 5}
