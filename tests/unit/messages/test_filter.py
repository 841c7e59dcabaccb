"""Filter expressions: their value, their errors, and that they reach nothing else."""

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.filter import LONGEST, Filter
from lcmtools.types.diagnostic_msgs import DiagnosticArray, DiagnosticStatus
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import String
from lcmtools.types.tf2_msgs import TFMessage

with pytest.raises(ValueError) as _caught:  # noqa: PT011 - its text is Python's, and changes
    math.sqrt(-1)
NO_ROOT = str(_caught.value)
ODOMETRY_FIELDS = "(fields: header, child_frame_id, pose, twist)"


@pytest.fixture
def odometry():
    message = Odometry()
    message.child_frame_id = "base_link"
    message.pose.pose.position.x = 3.0
    message.pose.pose.position.y = 4.0
    message.pose.covariance = [float(number) for number in range(36)]
    return message


@pytest.mark.parametrize(
    "text",
    [
        "m.child_frame_id == 'base_link'",
        "child_frame_id == 'base_link'",
        "'link' in m.child_frame_id and 'odom' not in child_frame_id",
        "1 < m.pose.pose.position.x <= 3",
        "not 3 < pose.pose.position.x < 4",
        "hypot(pose.pose.position.x, pose.pose.position.y) == 5",
        "pose.pose.position.x ** 2 + pose.pose.position.y ** 2 == 25",
        "sqrt(abs(-16)) == 4 and round(2.26, 1) == 2.3",
        "cos(pi) == -1 and atan2(0, 1) == sin(0)",
        "isnan(1) or isinf(1) or isfinite(1)",
        "pose.covariance[35] == 35 and pose.covariance[-1] == 35",
        "pose.covariance[0:6:2] == [0, 2, 4]",
        "len(pose.covariance) == 36 and max(pose.covariance) == 35 and min(3, 2) == 2",
        "sum(pose.covariance[:4]) == 6 and any(pose.covariance) and not all(pose.covariance)",
        "7 // 2 == 3 and 7 % 2 == 1 and 7 / 2 == 3.5 and 2 - 3 * 4 == -10",
        "m.child_frame_id in ['base_link', 'base_footprint']",
        "m.child_frame_id[0] == 'b' and m.child_frame_id[-4:] == 'link'",
        "header.stamp.sec == 0 and True",
        "header.stamp.secs == m.header.stamp.nsecs",
        "  m.pose.pose.position.z == 0",
        "False or 'text'",
    ],
)
def test_conditions_that_the_message_meets(text, odometry):
    assert Filter(text).matches(odometry)


@pytest.mark.parametrize(
    "text",
    ["m.child_frame_id == 'odom'", "pose.pose.position.x > 3", "0", "''", "not m.child_frame_id"],
)
def test_conditions_that_the_message_does_not_meet(text, odometry):
    assert not Filter(text).matches(odometry)


def test_and_and_or_end_as_early_as_pythons(odometry):
    assert not Filter("len(child_frame_id) > 99 and -m.child_frame_id").matches(odometry)
    assert Filter("len(child_frame_id) < 99 or -m.child_frame_id").matches(odometry)


@pytest.mark.parametrize(
    ("text", "is_met"),
    [
        ("ranges[2] > 1", False),
        ("ranges[-3] > 1", False),
        ("not ranges[2] > 1", False),
        ("ranges[2] > 1 or range_max == 0", True),
        ("range_max == 0 or ranges[2] > 1", True),
        ("ranges[2] > 1 and range_max == 0", False),
        ("not (ranges[2] > 1 and range_max == 1)", True),
        ("ranges[len(ranges)] > 1", False),
        ("header.frame_id[0] == 'o'", False),
        ("max(intensities) > 0", False),
        ("1 / range_max > 0", False),
        ("sqrt(range_max - 1) >= 0", False),
        ("ranges[1] > 1", True),
    ],
)
def test_a_condition_that_has_no_value_in_a_message_is_not_met(text, is_met):
    scan = LaserScan()
    scan.ranges = [1.0, 2.0]
    assert Filter(text).matches(scan) is is_met


def test_an_index_that_no_message_of_the_type_has_is_named_before_there_is_one():
    with pytest.raises(ValueMismatch, match=r"pose.covariance\[99\]"):
        Filter("pose.covariance[99] > 0").check(Odometry)


def test_conditions_go_into_arrays_of_messages():
    message = TFMessage()
    message.transforms = [TransformStamped()]
    message.transforms[0].header.frame_id = "odom"
    assert Filter("m.transforms[0].header.frame_id == 'odom'").matches(message)
    with pytest.raises(ValueMismatch, match="has no field 'nope'"):
        Filter("transforms[0].nope").check(TFMessage)


def test_a_types_constants_are_names_like_its_fields():
    status = DiagnosticArray()
    status.status = [DiagnosticStatus(), DiagnosticStatus()]
    status.status[1].level = DiagnosticStatus.WARN
    assert Filter("m.level == m.WARN and level != ERROR").matches(status.status[1])
    assert Filter("status[1].level == status[0].WARN").matches(status)
    assert not Filter("m.level == m.WARN").matches(status.status[0])
    with pytest.raises(ValueMismatch, match="has no field 'WARN'"):
        Filter("m.status.WARN").check(DiagnosticArray)
    with pytest.raises(ValueMismatch, match=r"'m.WARN.real' is not a field"):
        Filter("m.WARN.real").check(DiagnosticStatus)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("m.nope > 1", f"m.nope: nav_msgs/Odometry has no field 'nope' {ODOMETRY_FIELDS}"),
        ("nope > 1", f"nope: nav_msgs/Odometry has no field 'nope' {ODOMETRY_FIELDS}"),
        (
            "m.twst",
            f"m.twst: nav_msgs/Odometry has no field 'twst' {ODOMETRY_FIELDS}; did you mean twist?",
        ),
        ("m.encode", f"m.encode: nav_msgs/Odometry has no field 'encode' {ODOMETRY_FIELDS}"),
        ("m.child_frame_id.upper", "m.child_frame_id is a string, which has no field 'upper'"),
        (
            "m.pose[0]",
            (
                "m.pose is not an array but a geometry_msgs/PoseWithCovariance"
                " (fields: pose, covariance)"
            ),
        ),
        ("(1).real", "filter: '(1).real' is not a field of the message"),
        ("max(1, 2).real", "filter: 'max(1, 2).real' is not a field of the message"),
    ],
)
def test_unknown_fields_are_found_without_a_message(text, error):
    condition = Filter(text)
    with pytest.raises(ValueMismatch) as caught:
        condition.check(Odometry)
    assert str(caught.value) == error
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("1 / 0", "filter: '1 / 0': division by zero"),
        ("sqrt(-1)", f"filter: 'sqrt(-1)': {NO_ROOT}"),
        ("'a' * 100", "filter: ''a' * 100': a number is needed, not text"),
        ("[0] * 100", "filter: '[0] * 100': a number is needed, not an array"),
        ("-m", "filter: '-m': a number is needed, not a message"),
        ("9 ** 9 ** 9", "filter: '9 ** 9 ** 9': math range error"),
        (
            "18446744073709551615 * 2",
            "filter: '18446744073709551615 * 2': the number is larger than 64 bits",
        ),
        (
            "round(1, -999999999)",
            "filter: 'round(1, -999999999)': the digits are a whole number from 0 to 15",
        ),
    ],
)
def test_what_cannot_be_worked_out_names_the_place(text, error, odometry):
    with pytest.raises(ValueMismatch) as caught:
        Filter(text).matches(odometry)
    assert str(caught.value) == error


ALLOWED = "; fields, numbers, text, comparisons, arithmetic, and, or, not, in are"
EXAMPLE = "; write for example m.data > 0 and m.name == 'x' (==, and, or, not)"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", f"filter: the expression is empty{EXAMPLE}"),
        ("x = 1", f"filter: cannot read '= 1'{EXAMPLE}"),
        ("m.x && 1", f"filter: cannot read '& 1'{EXAMPLE}"),
        ("m.__class__", f"filter: 'm.__class__' is not allowed{ALLOWED}"),
        ("lambda: 1", f"filter: 'lambda: 1' is not allowed{ALLOWED}"),
        ("[a for a in m]", f"filter: '[a for a in m]' is not allowed{ALLOWED}"),
        ("1 if 1 else 2", f"filter: '1 if 1 else 2' is not allowed{ALLOWED}"),
        ("f'{m}'", "filter: 'f'{m}'' is not allowed" + ALLOWED),
        ("m & 1", "filter: 'm & 1' is not allowed; write and, or, not"),
        ("m is 1", "filter: 'm is 1' is not allowed; write == or !="),
        ("1 << 9", f"filter: '1 << 9' is not allowed{ALLOWED}"),
        ("1j", "filter: '1j' is not allowed; numbers of 64 bits, text, True and False are"),
        ("len()", "filter: wrong arguments in 'len()'; write len(VALUE)"),
        ("sum([1], [2])", "filter: wrong arguments in 'sum([1], [2])'; write sum(VALUE)"),
        ("max(1, key=len)", "filter: wrong arguments in 'max(1, key=len)'; write max(VALUE)"),
        ("1\n+ 1", "filter: the expression has a character that cannot be printed"),
        ("1" * (LONGEST + 1), "filter: the expression is longer than 500 characters"),
        ("not " * 60 + "1", "filter: the expression is nested more than 40 levels deep"),
    ],
)
def test_what_is_not_allowed_is_said_in_one_line(text, error):
    with pytest.raises(UsageError) as caught:
        Filter(text)
    assert str(caught.value) == error
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("call", ["open('x')", "m.encode()", "eval('1')", "(len)(1)(2)"])
def test_only_the_listed_functions_are_called(call):
    with pytest.raises(UsageError, match="no such function in") as caught:
        Filter(call)
    assert "functions: abs, acos, all" in str(caught.value)


ATOMS = ["m", "data", "m.data", "__class__", "m.__class__", "encode", "1", "1e9", "'a'", "[1,2]"]
PARTS = [*ATOMS, ".", "(", ")", "[", "]", ":", ",", "+", "-", "*", "**", "/", "%", "<", "==", "in"]
PARTS += ["not ", " and ", " or ", "len", "max", "round", "abs", "sum", "data[", "@", "lambda:"]


@given(st.one_of(st.text(max_size=40), st.lists(st.sampled_from(PARTS), max_size=9).map("".join)))
def test_no_expression_raises_anything_but_a_usage_error_in_one_line(text):
    message = String()
    message.data = "abc"
    error = None
    try:
        assert Filter(text).matches(message) in (True, False)
    except UsageError as raised:
        error = raised
    assert str(error).isprintable()


@given(
    st.sampled_from(["m", "data", "m.data", "(1)", "'a'", "[m]", "[m][0]", "max(m, m)", "len"]),
    st.sampled_from([name for cls in (String, str, int, tuple) for name in dir(cls)]),
)
def test_no_expression_reaches_an_attribute_that_is_no_field(owner, name):
    if name == "data" and owner == "m":
        return
    with pytest.raises(UsageError):
        Filter(f"{owner}.{name}").matches(String())


@pytest.mark.parametrize(
    "text", ["9**9**9**9", "9" * 400, "(" * 499, "-" * 499 + "1", "1" + "*9" * 30, "round(1, -9e9)"]
)
def test_no_expression_takes_long(text):
    start = time.process_time()
    with pytest.raises(UsageError):
        Filter(text).matches(String())
    assert time.process_time() - start < 1
