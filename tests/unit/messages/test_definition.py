"""A type as text: its definition, and its prototype, which ``pub`` takes."""

import pytest

from lcmtools.messages.codec import encode
from lcmtools.messages.definition import definition, prototype
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.registry import message_class, type_names


def test_nested_types_are_expanded_and_lengths_hidden():
    assert definition(message_class("sensor_msgs/JointState")) == (
        "std_msgs/Header header\n"
        "  int32 seq\n"
        "  std_msgs/Time stamp\n"
        "    int32 sec\n"
        "    int32 nsec\n"
        "  string frame_id\n"
        "string[] name\n"
        "float64[] position\n"
        "float64[] velocity\n"
        "float64[] effort"
    )


def test_arrays_of_fixed_size_show_it():
    lines = definition(message_class("geometry_msgs/PoseWithCovariance")).splitlines()
    assert lines[-1] == "float64[36] covariance"


def test_constants_come_first():
    lines = definition(message_class("sensor_msgs/PointField")).splitlines()
    assert lines[0] == "uint8 INT8=1"
    assert lines[8:] == ["string name", "int32 offset", "uint8 datatype", "int32 count"]


def test_constants_have_the_smallest_type_that_holds_all(odd):
    assert definition(odd.Limits).splitlines()[:4] == [
        "int16 LOWEST=-200",
        "int16 ONE=1",
        "float64 HALF=0.5",
        "int8 small",
    ]


def test_arrays_of_several_dimensions_show_each(odd):
    assert definition(odd.Shapes).splitlines()[:4] == [
        "uint8[][] grid",
        "float32[][3] numbers",
        "uint8[4] key",
        "uint8[2][3] keys",
    ]


def test_a_type_that_holds_itself_is_expanded_once(odd):
    assert definition(odd.Tree) == "int16 value\nodd/Tree[] children"


def test_a_type_without_fields_has_an_empty_definition():
    assert definition(message_class("std_msgs/Empty")) == ""


def test_a_prototype_is_a_block_of_yaml_with_all_defaults():
    assert prototype(message_class("geometry_msgs/TwistStamped")) == (
        "header:\n"
        "  seq: 0\n"
        "  stamp:\n"
        "    sec: 0\n"
        "    nsec: 0\n"
        "  frame_id: ''\n"
        "twist:\n"
        "  linear:\n"
        "    x: 0.0\n"
        "    y: 0.0\n"
        "    z: 0.0\n"
        "  angular:\n"
        "    x: 0.0\n"
        "    y: 0.0\n"
        "    z: 0.0"
    )


def test_arrays_are_in_one_line_and_their_lengths_are_left_out():
    rows = prototype(message_class("sensor_msgs/Joy")).splitlines()
    assert rows[-2:] == ["axes: []", "buttons: []"]
    covariance = prototype(message_class("geometry_msgs/PoseWithCovariance")).splitlines()[-1]
    assert covariance == f"covariance: [{', '.join(['0.0'] * 36)}]"


def test_booleans_are_yamls():
    assert prototype(message_class("std_msgs/Bool")) == "data: false"


def test_a_type_without_fields_is_an_empty_mapping():
    assert prototype(message_class("std_msgs/Empty")) == "{}"


def test_pub_takes_every_prototype_as_the_default_message():
    for kind in map(message_class, type_names()):
        assert encode(draft_from_values(kind, [prototype(kind)]).message) == encode(kind()), kind


@pytest.mark.parametrize("name", ["Nothing", "Shapes", "Shared", "Tree", "Limits", "Many", "Flat"])
def test_pub_takes_prototypes_of_odd_types_too(name, odd):
    kind = getattr(odd, name)
    assert encode(draft_from_values(kind, [prototype(kind)]).message) == encode(kind())
