"""Types for pages, and forms that are filled in."""

import pytest

from lcmtools.errors import UnknownType, ValueMismatch
from lcmtools.gui.protocol import MalformedRequest
from lcmtools.gui.type_forms import describe, filled_in

NOTHING = None  # a type is the same on every source


def described(name):
    found = describe(NOTHING, type=name)
    assert isinstance(found, dict)
    return found


def message(kind, **values):
    return filled_in(kind, values).message


def test_a_type_has_its_comments_units_and_defaults():
    about = described("Odometry")
    assert about["type"] == "nav_msgs/Odometry"
    assert about["comment"].startswith("Estimate of a robot's pose")
    by_name = {field["name"]: field for field in about["fields"]}
    assert by_name["pose"]["unit"] == "m, rad"
    (linear, _) = by_name["twist"]["fields"][0]["fields"]
    x = linear["fields"][0]
    assert (x["name"], x["type"], x["default"]) == ("x", "float64", 0.0)
    assert by_name["header"]["fields"][1]["isTime"] is True


def test_an_array_is_one_field():
    (ranges,) = (
        one for one in described("sensor_msgs/LaserScan")["fields"] if one["name"] == "ranges"
    )
    assert (ranges["type"], ranges["isArray"], ranges["default"]) == ("float32[]", True, None)


def test_an_unknown_type_is_an_error():
    with pytest.raises(UnknownType):
        described("geometry_msgs/Twits")


def test_texts_are_read_by_the_type_of_their_field():
    found = message("geometry_msgs/Twist", linear={"x": "4e-1", "y": ""}, angular={"z": "-1"})
    assert (found.linear.x, found.linear.y, found.angular.z) == (0.4, 0.0, -1.0)
    assert message("std_msgs/String", data="").data == ""
    assert message("std_msgs/Bool", data=True).data is True


def test_an_array_is_yaml_and_an_empty_one_stays():
    found = message("sensor_msgs/JointState", name="[left, right]", velocity="[1, 2.5]", effort=" ")
    assert (list(found.name), list(found.velocity), list(found.effort)) == (
        ["left", "right"],
        [1.0, 2.5],
        [],
    )


def test_now_is_the_moment_of_sending():
    values = {"header": {"stamp": "now", "frame_id": "map"}}
    template = filled_in("geometry_msgs/PoseStamped", values)
    sent = template.at(5_000_000_007)
    assert (sent.header.stamp.sec, sent.header.frame_id) == (5, "map")


def test_a_value_that_does_not_fit_names_its_field():
    with pytest.raises(ValueMismatch, match=r"linear\.x.*fast"):
        message("geometry_msgs/Twist", linear={"x": "fast"})
    with pytest.raises(ValueMismatch, match="velocity"):
        message("sensor_msgs/JointState", velocity="[1, fast]")


@pytest.mark.parametrize("values", [None, 7, [], {"linear": [1, 2]}, {"linear": {"x": None}}])
def test_what_no_form_sends_is_rubbish(values):
    with pytest.raises(MalformedRequest):
        filled_in("geometry_msgs/Twist", values)
