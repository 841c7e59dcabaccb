"""Field paths: what they select, and what is said of those that select nothing."""

from contextlib import suppress

import pytest
from fixtures.says import assert_says, raises_saying
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.path import (
    Path,
    parse_path,
    select,
    splits,
    target,
)
from lcmtools.types.geometry_msgs import Pose, TransformStamped
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.tf2_msgs import TFMessage

EXAMPLES = "; write [0], [-1], [0:5] or [::2]"


@pytest.fixture
def scan():
    message = LaserScan()
    message.ranges = [0.0, 1.0, 2.0, 3.0, 4.0]
    return message


@pytest.fixture
def transforms():
    message = TFMessage()
    message.transforms = [TransformStamped() for _ in range(3)]
    for index, transform in enumerate(message.transforms):
        transform.header.frame_id = f"frame_{index}"
        transform.transform.translation.x = float(index)
    return message


@pytest.mark.parametrize(
    "text",
    [
        "pose.pose.position.x",
        "/pose.pose.position.x",
        "/pose/pose/position/x",
        "pose/pose/position/x/",
        ".pose.pose.position/x",
    ],
)
def test_dots_and_slashes_mean_the_same(text):
    message = Odometry()
    message.pose.pose.position.x = 2.5
    assert select(message, parse_path(text)).value == 2.5
    assert str(parse_path(text)) == "pose.pose.position.x"


@pytest.mark.parametrize(
    ("text", "width"),
    [
        *(("ranges[0:5]", 5), ("ranges[2:8:3]", 2), ("ranges[:3]", 3), ("ranges[3:1]", 0)),
        *(("ranges", 0), ("ranges[1]", 0), ("ranges[:]", 0), ("ranges[:-1]", 0)),
        *(("ranges[-3:2]", 0), ("ranges[5:0:-1]", 0), ("ranges[0:1000000000]", 0)),
    ],
)
def test_a_slice_with_bounds_has_a_width(text, width):
    assert parse_path(text).width == width


@pytest.mark.parametrize("text", ["", "/"])
def test_an_empty_path_is_the_whole_message(text):
    message = Odometry()
    assert parse_path(text) == Path()
    assert select(message, parse_path(text)).value is message


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("ranges[0]", 0.0),
        ("ranges[-1]", 4.0),
        ("/ranges[1:3]", [1.0, 2.0]),
        ("ranges[:]", [0.0, 1.0, 2.0, 3.0, 4.0]),
        ("ranges[-2:]", [3.0, 4.0]),
        ("ranges[::2]", [0.0, 2.0, 4.0]),
        ("ranges[::-2]", [4.0, 2.0, 0.0]),
        ("ranges[ 1 : 2 ]", [1.0]),
        ("ranges[9:]", []),
        ("ranges[1:4][0]", 1.0),
    ],
)
def test_indices_and_slices_are_pythons(text, value, scan):
    assert select(scan, parse_path(text)).value == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("transforms[1].header.frame_id", "frame_1"),
        ("transforms[-1]/transform/translation/x", 2.0),
        ("transforms[0:2].header.frame_id", ["frame_0", "frame_1"]),
        ("transforms[:].transform.translation.x", [0.0, 1.0, 2.0]),
    ],
)
def test_paths_go_into_arrays_of_messages(text, value, transforms):
    assert select(transforms, parse_path(text)).value == value


def test_the_target_of_a_path_is_known_without_a_message():
    found = target(TFMessage, parse_path("transforms[0:2].header.frame_id"))
    assert (found.type, found.depth) == ("string", 1)
    assert target(Pose, parse_path("position")).type == "geometry_msgs/Point"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("linear[0", f"field path 'linear[0': '[0' has no closing ']'{EXAMPLES}"),
        ("a[]", f"field path 'a[]': the index in '[]' is missing{EXAMPLES}"),
        ("a[b]", f"field path 'a[b]': 'b' is not a whole number{EXAMPLES}"),
        ("a[1:b]", f"field path 'a[1:b]': 'b' is not a whole number{EXAMPLES}"),
        ("a[1.5]", f"field path 'a[1.5]': '1.5' is not a whole number{EXAMPLES}"),
        (
            "a[1:2:3:4]",
            f"field path 'a[1:2:3:4]': '[1:2:3:4]' has more than start, stop and step{EXAMPLES}",
        ),
        ("a[::0]", f"field path 'a[::0]': the step in '[::0]' is 0{EXAMPLES}"),
        ("a..b", "field path 'a..b': expected a field's name at '..b'"),
        ("a.", "field path 'a.': expected a field's name at '.'"),
        ("a]", "field path 'a]': expected a field's name at ']'"),
        ("a[0]b", "field path 'a[0]b': expected a field's name at 'b'"),
    ],
)
def test_what_is_no_path_is_said_in_one_line(text, error):
    with pytest.raises(UsageError) as caught:
        parse_path(text)
    assert str(caught.value) == error


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("nope", "nope: geometry_msgs/Pose has no field 'nope' (fields: position, orientation)"),
        (
            "positon.x",
            "positon: geometry_msgs/Pose has no field 'positon' (fields: position, orientation)",
        ),
        (
            "position.w",
            "position.w: geometry_msgs/Point has no field 'w' (fields: x, y, z)",
        ),
        ("position[0]", "position is not an array but a geometry_msgs/Point (fields: x, y, z)"),
        ("position.x[0]", "position.x is not an array but a float64"),
        ("position.x.y", "position.x is a float64, which has no field 'y'"),
        ("[0]", "the message is not an array but a geometry_msgs/Pose"),
    ],
)
def test_what_a_type_does_not_have_is_said_with_what_it_has(text, error):
    with pytest.raises(ValueMismatch) as caught:
        select(Pose(), parse_path(text))
    assert str(caught.value).startswith(error)
    assert caught.value.exit_code == 2


def test_an_index_outside_of_an_array_is_an_error(scan):
    with pytest.raises(ValueMismatch) as caught:
        select(scan, parse_path("ranges[9]"))
    assert_says(str(caught.value), "ranges[9]: ", "5 elements", "[9]")


def test_an_index_outside_of_an_array_of_fixed_size_is_found_without_a_message():
    with pytest.raises(ValueMismatch) as caught:
        target(Odometry, parse_path("pose.covariance[36]"))
    assert_says(str(caught.value), "pose.covariance[36]: ", "36 elements")


def test_a_name_after_an_array_asks_for_an_index():
    with pytest.raises(ValueMismatch) as caught:
        target(TFMessage, parse_path("transforms.header"))
    parts = ("transforms", "array of geometry_msgs/TransformStamped", "'header'", "; ", "[0]")
    assert_says(str(caught.value), *parts)


def test_a_length_field_is_selected_like_any_other(scan):
    scan.ranges_length = 3
    assert select(scan, parse_path("ranges_length")).value == 3


@given(st.text(alphabet="/.[]:ab01-", max_size=20))
def test_every_split_gives_the_argument_again(argument):
    assert all(topic + path == argument for topic, path in splits(argument))


@given(st.text(alphabet="/.[]:-0123456789ab_ranges ", max_size=30))
def test_no_path_raises_anything_but_a_usage_error(text):
    message = LaserScan()
    message.ranges = [1.0, 2.0]
    with suppress(UsageError):
        select(message, parse_path(text))


@pytest.mark.parametrize("name", ["sec", "secs", "nsec", "nsecs", "nanosec"])
def test_a_times_fields_have_the_names_of_both_ros(name, scan):
    scan.header.stamp.sec, scan.header.stamp.nsec = 3, 5
    path = parse_path(f"header.stamp.{name}")
    assert select(scan, path).value == (3 if "n" not in name else 5)
    assert target(LaserScan, path).type == "int32"
    assert str(path) == f"header.stamp.{name}"


def test_only_a_time_has_them(scan):
    with raises_saying(ValueMismatch, "header.secs: ", "std_msgs/Header", "no field 'secs'"):
        select(scan, parse_path("header.secs"))


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("position", "did you mean pose.pose.position?"),
        ("twist.angular", "did you mean twist.twist.angular?"),
        ("x", "did you mean pose.pose.position.x?"),
        ("pose.pose.posiiton", "did you mean position?"),
        ("nothing_like_it", ""),
    ],
)
def test_a_field_that_is_further_inside_is_found(path, hint):
    with pytest.raises(ValueMismatch) as error:
        target(Odometry, parse_path(path))
    assert error.value.hint == hint
