"""The tables of lcm-gen's classes, read."""

from lcmtools.messages.fields import Field, fields, is_time, stamp, visible_fields
from lcmtools.messages.registry import message_class
from lcmtools.types.geometry_msgs import PoseStamped, Twist
from lcmtools.types.std_msgs import Header


def test_a_nested_message_is_a_field_of_its_type():
    twist, vector = message_class("geometry_msgs/Twist"), message_class("geometry_msgs/Vector3")
    linear, _ = fields(twist)
    assert linear == Field(
        "linear", "geometry_msgs/Vector3", vector, (), is_length=False, attribute="linear"
    )


def test_length_fields_are_there_but_not_visible():
    joint_state = message_class("sensor_msgs/JointState")
    lengths = [field.name for field in fields(joint_state) if field.is_length]
    assert lengths == ["name_length", "position_length", "velocity_length", "effort_length"]
    assert [field.name for field in visible_fields(joint_state)] == [
        "header",
        "name",
        "position",
        "velocity",
        "effort",
    ]


def test_sizes_are_numbers_or_names_of_length_fields(odd):
    found = {field.name: field for field in fields(odd.Shapes)}
    assert found["grid"].dimensions == ("rows", "columns")
    assert found["numbers"].dimensions == ("rows", 3)
    assert found["grid"].is_bytes
    assert not found["numbers"].is_bytes
    assert found["rows"].is_length


def test_a_type_may_hold_itself(odd):
    assert visible_fields(odd.Tree)[1].message_class is odd.Tree


def test_times_are_known_by_their_fields():
    assert is_time(message_class("std_msgs/Duration"))
    assert is_time(message_class("builtin_interfaces/Time"))
    assert not is_time(message_class("std_msgs/Header"))


def test_a_stamp_is_nanoseconds_since_1970():
    message = PoseStamped()
    message.header.stamp.sec, message.header.stamp.nsec = 1_795_244_479, 5
    assert stamp(message) == 1_795_244_479_000_000_005


def test_a_message_without_a_header_has_no_stamp():
    assert stamp(Twist()) is None
    assert stamp(Header()) is None
