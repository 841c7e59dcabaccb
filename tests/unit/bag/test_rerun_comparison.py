"""The comparison of a rerun with its recording: matching, and differences of fields."""

import math

import pytest

from lcmtools.bag.rerunning.comparison import (
    Clocks,
    Compared,
    Tolerance,
    compare,
    differences,
    part_of,
)
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fill import fill
from lcmtools.messages.registry import message_class
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import Float64

_MS = 1_000_000
_NOW = 1_700_000_000_000_000_000


_EXACT = Tolerance(0.0, 0.0)


def made(kind, value):
    message = message_class(kind)()
    fill(message, value)
    return message


def found(kind, was, now, tolerance=_EXACT, later=0):
    """Return what differs; the second message is ``later`` [ns] than the first."""
    clocks = Clocks((_NOW, _NOW + later), (made(kind, was), made(kind, now)))
    both = differences(made(kind, was), made(kind, now), tolerance, clocks)
    return [each for each in both if not each.is_allowed]


@pytest.mark.parametrize(
    ("kind", "was", "now", "tolerance", "fields"),
    [
        ("std_msgs/Float64", 1.0, 1.0, _EXACT, []),
        ("std_msgs/Float64", 1.0, 1.001, _EXACT, ["data"]),
        ("std_msgs/Float64", 1.0, 1.001, Tolerance(0.002, 0.0), []),
        ("std_msgs/Float64", 1.0, 1.003, Tolerance(0.002, 0.0), ["data"]),
        ("std_msgs/Float64", 1000.0, 1001.0, Tolerance(0.0, 0.002), []),
        ("std_msgs/Float64", 0.5, 0.500001, Tolerance(), ["data"]),
        ("std_msgs/Float64", 0.0, 1e-10, Tolerance(), []),
        ("std_msgs/Float64", 1e9, 1e9 + 0.5, Tolerance(), []),
        ("std_msgs/Float64", 1e9, 1e9 + 5.0, Tolerance(), ["data"]),
        ("std_msgs/Float64", math.nan, math.nan, _EXACT, []),
        ("std_msgs/Float64", math.nan, 0.0, Tolerance(10.0, 10.0), ["data"]),
        ("std_msgs/Float64", math.inf, math.inf, _EXACT, []),
        ("std_msgs/Float64", math.inf, -math.inf, Tolerance(10.0, 0.0), ["data"]),
        ("std_msgs/String", "a", "b", Tolerance(9.0, 9.0), ["data"]),
        ("std_msgs/Bool", True, False, Tolerance(9.0, 9.0), ["data"]),
        ("geometry_msgs/Pose2D", {"theta": 3.14}, {"theta": -3.14}, Tolerance(0.01, 0.0), []),
        ("geometry_msgs/Pose2D", {"theta": 3.14}, {"theta": -3.1}, Tolerance(0.01), ["theta"]),
        ("geometry_msgs/Pose2D", {"x": math.pi}, {"x": -math.pi}, Tolerance(0.01, 0.0), ["x"]),
        ("geometry_msgs/Quaternion", [0.1, 0, 0, 0.9], [-0.1, 0, 0, -0.9], _EXACT, []),
        ("geometry_msgs/Quaternion", [0.1, 0, 0, 0.9], [0.1, 0, 0, -0.9], _EXACT, ["x"]),
        ("geometry_msgs/Quaternion", [0.1, 0, 0, 0.9], [0.11, 0, 0, 0.9], Tolerance(0.02), []),
        ("sensor_msgs/JointState", {"effort": [1, 2]}, {"effort": [1, 3]}, _EXACT, ["effort[1]"]),
        ("sensor_msgs/JointState", {"effort": [1]}, {"effort": []}, _EXACT, ["effort (length)"]),
        ("sensor_msgs/JointState", {"name": ["a"]}, {"name": ["b"]}, _EXACT, ["name[0]"]),
        (
            "tf2_msgs/TFMessage",
            {"transforms": [{"child_frame_id": "a"}]},
            {"transforms": [{"child_frame_id": "b"}]},
            _EXACT,
            ["transforms[0].child_frame_id"],
        ),
    ],
)
def test_fields_are_compared_by_their_meaning(kind, was, now, tolerance, fields):
    assert [one.field for one in found(kind, was, now, tolerance)][:1] == fields


@pytest.mark.parametrize(
    ("term", "fields"),
    [
        ({}, ["linear.x", "linear.y"]),
        ({"linear.x": "0.2"}, ["linear.y"]),
        ({"linear": "6%"}, []),
        ({"linear": "ignore"}, []),
        ({"linear.y": "ignore", "linear": "1%"}, ["linear.x"]),
        ({"angular": "ignore"}, ["linear.x", "linear.y"]),
    ],
)
def test_a_field_and_what_is_below_it_have_their_own_tolerance(term, fields):
    values = {"linear": [1.0, 2.0, 3.0]}, {"linear": [1.05, 2.1, 3.0]}
    differing = found("geometry_msgs/Twist", *values, Tolerance(0.0, 0.0, fields=term))
    assert [one.field for one in differing] == fields


@pytest.mark.parametrize(
    ("was", "now", "later", "is_equal"),
    [
        (_NOW, _NOW, 10**9, True),  # copied from an input
        (_NOW, _NOW + 5 * 10**9, 5 * 10**9, True),  # the time at which it was published
        (_NOW, _NOW + 5 * 10**9, 10**9, False),
        (_NOW, _NOW + 50 * _MS, 0, True),  # within the tolerance of times
    ],
)
def test_a_stamp_is_compared_as_such_or_by_its_age(was, now, later, *, is_equal):
    stamps = ({"stamp": one} for one in (was, now))
    assert (found("std_msgs/Header", *stamps, later=later) == []) == is_equal


def doubles(*pairs):
    """Return messages, each of a time [s] and a number."""
    return [Compared(round(time * 1e9), encode(Float64(data=data))) for time, data in pairs]


def read(_topic, payload):
    return decode(Float64, payload)


def compared(was, now, **more):
    return compare("/x", (was, now), read, Tolerance(), **more)


_TEN = [(n / 10, float(n)) for n in range(10)]


@pytest.mark.parametrize(
    ("now", "missing", "extra", "differing"),
    [
        (_TEN, [], [], 0),
        (_TEN[:4] + _TEN[5:], [4], [], 0),
        (_TEN[1:], [0], [], 0),
        (_TEN[:7], [7, 8, 9], [], 0),
        ([*_TEN[:4], (0.35, 77.0), *_TEN[4:]], [], [3.5], 0),
        ([(time, -data) for time, data in _TEN], [], [], 9),
    ],
)
def test_messages_are_matched_by_order_and_time(now, missing, extra, differing):
    result = compared(doubles(*_TEN), doubles(*now))
    assert [round(time / 1e8, 3) for time in result.missing] == missing
    assert [round(time / 1e8, 3) for time in result.extra] == extra
    assert (result.differing, result.is_equal) == (
        differing,
        not (missing or extra or differing),
    )


def test_messages_are_matched_by_stamp_where_they_have_one():
    def stamped(second):
        stamp = made("sensor_msgs/JointState", {"header": {"stamp": {"sec": second}}})
        return Compared(second, encode(stamp))

    was, now = ([stamped(n) for n in some] for some in ((1, 2, 3, 3), (1, 3, 3, 4)))
    result = compare("/x", (was, now), lambda _, data: decode(JointState, data), Tolerance())
    assert (result.matched, result.missing, result.extra) == (3, [2], [4])
    by_order = Tolerance(is_by_order=True)
    result = compare("/x", (was, now), lambda _, data: decode(JointState, data), by_order)
    assert (result.matched, result.missing) == (4, [])


def test_a_message_is_late_against_the_others_of_its_topic():
    now = doubles(*((time + 0.5 + (time == 0.4), data) for time, data in _TEN))
    assert [by for _, by in compared(doubles(*_TEN), now).late] == [pytest.approx(1.0)]
    assert compared(doubles(*_TEN), now, judges_delay=False).is_equal


def test_the_phase_of_a_timer_may_cost_a_message_at_an_end():
    now = [one._replace(is_by_timer=True) for one in doubles(*_TEN[1:])]
    assert compared(doubles(*_TEN), now).is_equal
    assert not compared(doubles(*_TEN), now[:4] + now[5:]).is_equal


def test_messages_that_cannot_be_decoded_are_compared_by_their_bytes():
    def refuse(_topic, _payload):
        raise DecodeError("unknown type, fingerprint 0x1")

    was, now = [Compared(1, b"a")], [Compared(1, b"b")]
    assert compare("/x", (was, was), refuse, Tolerance()).is_equal
    assert compare("/x", (was, now), refuse, Tolerance()).trouble.startswith("unknown type")


def test_two_runs_part_where_bytes_or_times_differ():
    runs = doubles(*_TEN)
    assert part_of(runs, doubles(*_TEN)) is None
    assert part_of(runs, runs[:5]) == part_of(runs[:5], runs) == 5
    assert part_of(runs, [*runs[:3], runs[3]._replace(time=1), *runs[4:]]) == 3
