"""Unknown types that are nearly known ones."""

import pytest

from lcmtools.messages.fields import fields
from lcmtools.messages.near_types import NearType, fingerprint_of, nearest_type
from lcmtools.messages.registry import fingerprint, message_class, type_names
from lcmtools.types.geometry_msgs import Pose2D
from lcmtools.types.nav_msgs import Odometry

X, Y, THETA = fields(Pose2D)


def test_fingerprints_are_computed_as_lcm_gen_does() -> None:
    for name in type_names():
        cls = message_class(name)
        assert fingerprint_of(fields(cls)) == fingerprint(cls), name


def test_a_field_less_is_recognised_without_any_expectation() -> None:
    parts = [part for part in fields(Odometry) if part.name != "child_frame_id"]
    expected = NearType("nav_msgs/Odometry", "without the field child_frame_id")
    assert nearest_type(fingerprint_of(parts)) == expected
    assert nearest_type(0x1234567812345678) is None


@pytest.mark.parametrize(
    ("parts", "difference"),
    [
        ([X, Y], "without the field theta"),
        ([X, Y, THETA._replace(type="float32")], "theta is float32, not float64"),
        ([X, Y, THETA._replace(type="int64")], "theta is int64, not float64"),
        ([Y, X, THETA], "x and y exchanged"),
        ([THETA, X, Y], "its fields in the order theta, x, y"),
        ([part._replace(type="float32") for part in (X, Y, THETA)], "every float64 is float32"),
        ([X, Y, THETA, X._replace(name="id", type="int32")], "with id (int32) at the end"),
        ([X._replace(name="utime", type="int64"), X, Y, THETA], "with utime (int64) before"),
    ],
)
def test_an_edit_of_the_expected_type_is_recognised(parts: list[object], difference: str) -> None:
    number = fingerprint_of(parts)  # type: ignore[arg-type]
    assert nearest_type(number, ["geometry_msgs/Pose2D"]) == NearType(
        "geometry_msgs/Pose2D", difference
    )


def test_a_sender_whose_numbers_begin_with_the_lowest_byte_is_recognised() -> None:
    number = int.from_bytes(fingerprint(Odometry).to_bytes(8, "big"), "little")
    found = nearest_type(number)
    assert found is not None
    assert (found.name, found.difference[:22]) == ("nav_msgs/Odometry", "its bytes are reversed")


def test_an_edit_within_a_field_is_recognised() -> None:
    """As lcm-gen makes it of Twist where Vector3 has floats (tried with lcm-gen 1.5.3)."""
    assert nearest_type(0xC52A118464E2BC0F, ["geometry_msgs/Twist"]) == NearType(
        "geometry_msgs/Twist", "in geometry_msgs/Vector3 every float64 is float32"
    )
