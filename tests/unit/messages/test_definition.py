"""The look of a type's definition."""

from types import ModuleType

from lcmtools.messages.definition import definition
from lcmtools.messages.registry import message_class


def test_nested_types_are_expanded_and_lengths_hidden() -> None:
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


def test_arrays_of_fixed_size_show_it() -> None:
    lines = definition(message_class("geometry_msgs/PoseWithCovariance")).splitlines()
    assert lines[-1] == "float64[36] covariance"


def test_constants_come_first() -> None:
    lines = definition(message_class("sensor_msgs/PointField")).splitlines()
    assert lines[0] == "uint8 INT8=1"
    assert lines[8:] == ["string name", "int32 offset", "uint8 datatype", "int32 count"]


def test_constants_have_the_smallest_type_that_holds_all(odd: ModuleType) -> None:
    assert definition(odd.Limits).splitlines()[:4] == [
        "int16 LOWEST=-200",
        "int16 ONE=1",
        "float64 HALF=0.5",
        "int8 small",
    ]


def test_arrays_of_several_dimensions_show_each(odd: ModuleType) -> None:
    assert definition(odd.Shapes).splitlines()[:4] == [
        "uint8[][] grid",
        "float32[][3] numbers",
        "uint8[4] key",
        "uint8[2][3] keys",
    ]


def test_a_type_that_holds_itself_is_expanded_once(odd: ModuleType) -> None:
    assert definition(odd.Tree) == "int16 value\nodd/Tree[] children"


def test_a_type_without_fields_has_an_empty_definition() -> None:
    assert definition(message_class("std_msgs/Empty")) == ""
