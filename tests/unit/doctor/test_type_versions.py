"""Versions of a type: the fields that differ, and another version by its fingerprint."""

import pytest

from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint, message_class, type_names
from lcmtools.messages.type_versions import Version, fingerprint_of, other_version
from lcmtools.types.geometry_msgs import Pose2D

X, Y, THETA = fields(Pose2D)


def test_fingerprints_are_computed_as_lcm_gen_does():
    for name in type_names():
        cls = message_class(name)
        assert fingerprint_of(fields(cls)) == fingerprint(cls), name


@pytest.mark.parametrize(
    ("parts", "difference"),
    [
        ([X, Y], "without the field theta"),
        ([X, Y, THETA._replace(type="float32")], "theta is float32, not float64"),
        ([X, Y, THETA._replace(type="int64")], "theta is int64, not float64"),
        ([Y, X, THETA], "x and y exchanged"),
        ([X, Y, THETA, X._replace(name="id", type="int32")], "with id (int32) at the end"),
        ([X._replace(name="utime", type="int64"), X, Y, THETA], "with utime (int64) before"),
    ],
)
def test_an_edit_of_the_expected_type_is_recognised(parts, difference):
    number = fingerprint_of(parts)
    named = Version("geometry_msgs/Pose2D", difference)
    assert other_version(number, ["geometry_msgs/Pose2D"]) == named
    assert other_version(number, ["geometry_msgs/Twist"]) is None
    assert other_version(number, []) is None


def test_a_sender_whose_numbers_begin_with_the_lowest_byte_is_recognised():
    number = int.from_bytes(fingerprint(Pose2D).to_bytes(8, "big"), "little")
    found = other_version(number, ["geometry_msgs/Pose2D"])
    assert found is not None
    assert found.difference.startswith("its bytes are reversed")
