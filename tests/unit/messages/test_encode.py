"""Messages to payloads: nothing cut or padded, and what does not fit named."""

import array

import numpy as np
import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import PayloadEncoder, decode, encode
from lcmtools.messages.coder import Coder
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs, trajectory_msgs
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.tf2_msgs import TFMessage


def joint_state():
    message = sensor_msgs.JointState()
    message.name = ["left", "right"]
    message.position = [1.0, 2.0]
    return message


def test_a_payload_is_what_lcm_gen_makes():
    message = geometry_msgs.Twist()
    message.linear.x, message.angular.z = 0.5, -0.0
    assert encode(message) == message.encode()


def test_length_fields_are_set_here_and_in_nested_messages():
    message = trajectory_msgs.JointTrajectory()
    message.points = [trajectory_msgs.JointTrajectoryPoint()]
    message.points[0].positions = [0.5]
    payload = encode(message)
    assert (message.points_length, message.points[0].positions_length) == (1, 1)
    decoded = trajectory_msgs.JointTrajectory.decode(payload)
    assert list(decoded.points[0].positions) == [0.5]


def test_encoding_changes_nothing_but_length_fields():
    message = joint_state()
    name, position, header = message.name, message.position, message.header
    encode(message)
    assert (message.name, message.position) == (["left", "right"], [1.0, 2.0])
    assert message.name is name
    assert message.position is position
    assert message.header is header


@pytest.mark.parametrize(
    "values",
    [
        [1, 2.5, -3],
        (1.0, 2.5, -3.0),
        np.array([1, 2.5, -3]),
        np.array([1, 2.5, -3], dtype=np.float32),
        array.array("d", [1, 2.5, -3]),
        memoryview(array.array("f", [1, 2.5, -3])),
    ],
    ids=["list", "tuple", "float64", "float32", "array", "memoryview"],
)
def test_numbers_may_come_in_any_kind_of_array(values):
    message = std_msgs.Float64MultiArray()
    message.data = values
    assert decode(std_msgs.Float64MultiArray, encode(message)).data == (1.0, 2.5, -3.0)


@pytest.mark.parametrize(
    "values",
    [
        b"\x01\x02\xff",
        bytearray(b"\x01\x02\xff"),
        memoryview(b"\x01\x02\xff"),
        [1, 2, 255],
        (1, 2, 255),
        np.array([1, 2, 255]),
        np.array([1, 2, 255], dtype=np.uint8),
        np.array([1, 9, 2, 9, 255, 9], dtype=np.uint8)[::2],
        array.array("H", [1, 2, 255]),
    ],
    ids=["bytes", "bytearray", "memoryview", "list", "tuple", "int64", "uint8", "strided", "array"],
)
def test_bytes_may_come_in_any_kind_of_array(values):
    message = sensor_msgs.Image()
    message.data = values
    assert decode(sensor_msgs.Image, encode(message)).data == b"\x01\x02\xff"


@pytest.mark.parametrize("value", [True, np.True_, 1])
def test_booleans_may_be_numpys_or_one(value):
    message = std_msgs.Bool()
    message.data = value
    assert decode(std_msgs.Bool, encode(message)).data is True


def test_numpys_numbers_may_be_fields():
    message = std_msgs.Header()
    message.seq = np.int64(5)
    assert decode(std_msgs.Header, encode(message)).seq == 5


def test_a_type_of_equal_fields_may_stand_for_another():
    message = geometry_msgs.Twist()
    message.linear = geometry_msgs.Point()
    message.linear.x = 2.0
    assert decode(geometry_msgs.Twist, encode(message)).linear.x == 2.0


def test_an_untouched_array_of_fixed_bytes_is_zeros(odd):
    message = decode(odd.Shapes, encode(odd.Shapes()))
    assert message.key == bytes(4)
    assert message.keys == [bytes(3), bytes(3)]


def test_rows_of_arrays_set_both_lengths(odd):
    message = odd.Shapes()
    message.grid, message.numbers = [b"ab", b"cd", b"ef"], [[1, 2, 3]] * 3
    payload = encode(message)
    assert (message.rows, message.columns) == (3, 2)
    assert odd.Shapes.decode(payload).grid == [b"ab", b"cd", b"ef"]


def test_an_inner_length_stays_when_there_is_no_row_to_tell_it(odd):
    message = odd.Flat()
    message.columns = 3
    assert decode(odd.Flat, encode(message)).columns == 3


def with_value(path, value, make):
    """A new message in which the field at a path has a value."""
    message = make()
    *owners, name = path.split(".")
    target = message
    for owner in owners:
        target = getattr(target, owner)
    setattr(target, name, value)
    return message


@pytest.mark.parametrize(
    ("make", "path", "value", "line"),
    [
        (geometry_msgs.Twist, "linear.x", "fast", "linear.x: expected a number, got 'fast'"),
        (geometry_msgs.Twist, "linear.x", None, "linear.x: expected a number, got nothing"),
        (
            geometry_msgs.Twist,
            "linear",
            geometry_msgs.Quaternion(),
            "linear: expected geometry_msgs/Vector3, got geometry_msgs/Quaternion",
        ),
        (
            Odometry,
            "pose.covariance",
            [0.0] * 37,
            "pose.covariance: expected 36 numbers, got 37",
        ),
        (
            sensor_msgs.LaserScan,
            "ranges",
            np.zeros((2, 2)),
            "ranges[0]: expected a number, got a list",
        ),
        (
            sensor_msgs.LaserScan,
            "ranges",
            [1.0, 2.0, "far"],
            "ranges[2]: expected a number, got 'far'",
        ),
        (sensor_msgs.LaserScan, "ranges", "far", "ranges: expected a list of numbers, got 'far'"),
        (sensor_msgs.LaserScan, "ranges", {1.0}, "ranges: expected a list of numbers, got a set"),
        (sensor_msgs.LaserScan, "range_max", 1e39, "range_max: 1e+39 does not fit float32"),
        (sensor_msgs.LaserScan, "ranges", [1e39], "ranges[0]: 1e+39 does not fit float32"),
        (std_msgs.Float64, "data", 10**400, "data: 1" + 35 * "0" + "...0 does not fit float64"),
        (
            sensor_msgs.JointState,
            "name",
            "left",
            "name: expected a list of strings, got 'left'",
        ),
        (sensor_msgs.JointState, "name", ["a", 5], "name[1]: expected text, got 5"),
        (
            TFMessage,
            "transforms",
            [geometry_msgs.TransformStamped(), geometry_msgs.Twist()],
            "transforms[1]: expected geometry_msgs/TransformStamped, got geometry_msgs/Twist",
        ),
        (std_msgs.Int32, "data", 5.0, "data: expected an integer, got 5.0"),
        (std_msgs.Int32, "data", np.zeros(2), "data: expected an integer, got a ndarray"),
        (std_msgs.Float64, "data", 1j, "data: expected a number, got a complex"),
        (std_msgs.UInt8, "data", -1, "data: -1 does not fit uint8 (0..255)"),
        (std_msgs.Bool, "data", "true", "data: expected true or false, got 'true'"),
        (std_msgs.Bool, "data", 2, "data: expected true or false, got 2"),
        (std_msgs.String, "data", b"hello", "data: expected text, got binary data"),
        (std_msgs.String, "data", std_msgs.String(), "data: expected text, got a String"),
        (
            std_msgs.String,
            "data",
            "\ud800",
            "data: expected text, got half a character in '\\ud800'",
        ),
        (sensor_msgs.Image, "data", [1, 256], "data[1]: 256 does not fit uint8 (0..255)"),
        (sensor_msgs.Image, "data", [1.5], "data[0]: expected an integer, got 1.5"),
        (sensor_msgs.Image, "data", np.array([-1]), "data[0]: -1 does not fit uint8 (0..255)"),
        (
            sensor_msgs.Image,
            "data",
            np.zeros((2, 2), np.uint8),
            "data[0]: expected an integer, got a list",
        ),
    ],
)
def test_a_wrong_value_is_named_with_its_path(make, path, value, line):
    message = with_value(path, value, make)
    for wrong in (encode, PayloadEncoder(type(make())).encode):
        with pytest.raises(ValueMismatch) as caught:
            wrong(message)
        assert str(caught.value) == line


def test_arrays_that_share_a_length_must_agree(odd):
    message = odd.Shared()
    message.left, message.right = [1.0, 2.0], ["a"]
    with pytest.raises(ValueMismatch) as caught:
        encode(message)
    assert_says(str(caught.value), "right: ", "1 elements", "left has 2")


def test_an_array_may_not_be_longer_than_its_length_field_can_say(odd):
    message = odd.Shared()
    message.left, message.right = [0.0] * 128, [""] * 128
    with pytest.raises(ValueMismatch) as caught:
        encode(message)
    assert_says(str(caught.value), "left: ", "128 elements", "int8", "127")


@pytest.mark.parametrize(
    ("field", "value", "line"),
    [
        ("grid", [b"ab", b"c"], "grid: its rows differ in length: 2 and 1"),
        ("numbers", [[1, 2]], "numbers[0]: expected 3 numbers, got 2"),
        ("keys", [b"abc"], "keys: expected 2 numbers, got 1"),
        ("keys", [b"abc", b"ab"], "keys[1]: expected 3 numbers, got 2"),
        ("key", b"abcde", "key: expected 4 numbers, got 5"),
        ("flags", [True], "flags: expected 2 booleans, got 1"),
        ("words", [["a", "b"], ["c"]], "words[1]: expected 2 strings, got 1"),
        ("words", [["a", "b"], "cd"], "words[1]: expected a list of strings, got 'cd'"),
        ("pairs", [[], []], "pairs[0]: expected 2 messages, got 0"),
    ],
)
def test_arrays_of_arrays_must_be_rectangular(odd, field, value, line):
    message = odd.Shapes()
    setattr(message, field, value)
    if field == "numbers":
        message.grid = [b"x"]
    with pytest.raises(ValueMismatch) as caught:
        encode(message)
    assert str(caught.value) == line


def test_a_message_that_contains_itself_is_refused(odd):
    message = odd.Tree()
    message.children = [message]
    for too_deep in (encode, PayloadEncoder(odd.Tree).encode):
        with pytest.raises(ValueMismatch, match="odd/Tree: contains itself"):
            too_deep(message)


def test_what_is_no_message_is_refused():
    with raises_saying(ValueMismatch, "str: expected a message", "'hello'"):
        encode("hello")


def test_functions_share_no_names_as_threads_may_compile_them_at_once():
    own = Coder(Odometry)
    functions = own.write, own.scan, own.read, own.read_available
    assert len({id(one.__globals__) for one in functions}) == len(functions)
