"""Messages are values: repr, ==, keyword arguments, copies and pickles, for every shipped type."""

import copy
import math
import pickle
import subprocess
import sys
from array import array

import numpy as np
import pytest

from lcmtools.message_value import MessageValue
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import message_class
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs
from lcmtools.types.geometry_msgs import Point, Pose2D, PoseArray, Quaternion, Twist, Vector3
from lcmtools.types.nav_msgs import OccupancyGrid
from lcmtools.types.sensor_msgs import CameraInfo, Image, JointState, LaserScan
from lcmtools.types.std_msgs import Empty, Float64, Header, String, Time

NAMES = {
    name: getattr(package, name)
    for package in (geometry_msgs, sensor_msgs, std_msgs)
    for name in vars(package)
}


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (Empty(), "Empty()"),
        (String(data="it's"), 'String(data="it\'s")'),
        (Vector3(x=1.0), "Vector3(x=1.0, y=0.0, z=0.0)"),
        (
            Twist(angular=Vector3(z=-0.5)),
            "Twist(linear=Vector3(x=0.0, y=0.0, z=0.0), angular=Vector3(x=0.0, y=0.0, z=-0.5))",
        ),
        (
            JointState(name=["left"], position=np.array([1.5])),
            (
                "JointState(header=Header(seq=0, stamp=Time(sec=0, nsec=0), frame_id=''),"
                " name=['left'], position=[1.5], velocity=[], effort=[])"
            ),
        ),
        (Float64(data=np.float64(0.5)), "Float64(data=0.5)"),
        (String(data="a" * 203), f"String(data='{'a' * 200}'... 3 more)"),
    ],
)
def test_repr_names_type_and_fields(message, text):
    assert repr(message) == text


@pytest.mark.parametrize(
    ("message", "part"),
    [
        (CameraInfo(K=range(9)), "K=range(0, 9)"),  # a wrong value is shown as it is
        (CameraInfo(K=[0.5] * 9), f"K=[{'0.5, ' * 8}... 1 more]"),
        (LaserScan(ranges=tuple(range(360))), "ranges=[0, 1, 2, 3, 4, 5, 6, 7, ... 352 more]"),
        (LaserScan(ranges=np.arange(360)), "ranges=[0, 1, 2, 3, 4, 5, 6, 7, ... 352 more]"),
        (LaserScan(ranges=array("f", [1.5])), "ranges=[1.5]"),
        (Image(data=b"abc"), "data=b'abc'"),
        (Image(data=bytes(900_000)), "data=<900000 bytes>"),
        (Image(data=np.zeros(900_000, np.uint8)), "data=[0, 0, 0, 0, 0, 0, 0, 0, ... 899992 more]"),
        (Image(data=memoryview(b"abc")), "data=[97, 98, 99]"),
    ],
)
def test_repr_cuts_long_arrays(message, part):
    assert part in repr(message)


def test_repr_of_a_short_message_makes_it_anew():
    for message in (
        PoseArray(header=Header(frame_id="map"), poses=[geometry_msgs.Pose()]),
        Quaternion(w=1.0),
        sensor_msgs.Joy(axes=[0.5], buttons=[1, 0]),
    ):
        assert eval(repr(message), dict(NAMES)) == message  # noqa: S307 - ours


def test_a_message_within_itself_has_a_repr():
    message = Twist()
    message.linear = message
    assert repr(message).startswith("Twist(linear=...")


def test_received_messages_equal_those_that_were_sent():
    scan = LaserScan(ranges=[1.5, math.inf], intensities=(2.0,))
    received = decode(LaserScan, encode(scan))
    assert received == LaserScan.decode(encode(scan)) == scan
    assert received.ranges_length == 2
    received.ranges[0] = 2.5
    assert received != scan


NUMBERS = [[1, 2, 3], (1, 2, 3), array("b", [1, 2, 3]), np.array([1, 2, 3], np.int8)]


@pytest.mark.parametrize("one", [*NUMBERS, np.array([1, 2, 3.0]), np.array([1, 2, 3], ">i4")])
@pytest.mark.parametrize("other", NUMBERS)
def test_arrays_are_equal_if_their_elements_are(one, other):
    assert OccupancyGrid(data=one) == OccupancyGrid(data=other)
    for changed in (one[:2], [1, 2, 4], [], [1, 2, 3, 4], None, "123", 5):
        assert OccupancyGrid(data=changed) != OccupancyGrid(data=other)
        assert OccupancyGrid(data=other) != OccupancyGrid(data=changed)


@pytest.mark.parametrize(
    "data", [b"ab", bytearray(b"ab"), memoryview(b"ab"), [97, 98], np.array([97, 98], np.uint8)]
)
def test_bytes_are_equal_in_any_form(data):
    assert Image(data=data) == Image(data=b"ab")
    assert Image(data=b"ab") == Image(data=data)
    assert Image(data=data) != Image(data=b"ac")
    assert Image(data=data) != Image()


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (Point(), Vector3()),  # the same on the wire
        (Point(), (0.0, 0.0, 0.0)),
        (Point(), None),
        (Point(x=1), Point(x=2)),
        (String(data="a"), String(data="b")),
        (Twist(linear=Vector3(x=1)), Twist()),
        (Twist(linear=None), Twist(linear=5)),
        (PoseArray(poses=[geometry_msgs.Pose()]), PoseArray()),
        (Pose2D(x=math.nan), Pose2D(x=float("nan"))),
    ],
)
def test_others_are_not_equal(one, other):
    assert one != other
    assert other != one


def test_nan_equals_itself_as_in_pythons_lists():
    message = Pose2D(x=math.nan)
    assert message == message  # noqa: PLR0124 - for its NaN
    assert message == copy.copy(message)
    assert [math.nan] == [math.nan]  # what is meant


def test_numbers_of_numpy_count_as_those_of_python():
    assert Time(sec=np.int32(3)) == Time(sec=3)
    assert Float64(data=np.float64(0.5)) == Float64(data=0.5)
    assert (Float64(data=np.float64(0.5)) == Float64(data=1)) is False


def test_a_message_has_no_hash():
    with pytest.raises(TypeError, match="unhashable type: 'Twist'"):
        hash(Twist())


def test_a_copy_shares_the_nested_messages_and_a_deep_copy_nothing():
    scan = decode(LaserScan, encode(LaserScan(ranges=[1, 2])))
    shallow, deep = copy.copy(scan), copy.deepcopy(scan)
    scan.header.frame_id, scan.ranges[0] = "laser", 5
    assert (shallow.header.frame_id, shallow.ranges[0]) == ("laser", 5)
    assert (deep.header.frame_id, deep.ranges[0]) == ("", 1)


def test_a_derived_class_is_pickled_by_its_own_name():
    message = Derived(data="a")
    again = pickle.loads(pickle.dumps(message))  # noqa: S301 - ours
    assert type(again) is Derived
    assert again == message
    assert again != String(data="a")


class Derived(String):
    """A class of a user's."""


def test_classes_of_lcm_gen_itself_compare_within_ours(odd):
    nothing, other = odd.Nothing(), odd.Nothing()
    assert nothing != other  # they are not changed
    one = Twist(linear=nothing, angular=[nothing])
    assert one == Twist(linear=other, angular=nothing) or one.angular != nothing
    assert Twist(linear=nothing) == Twist(linear=other)
    assert not isinstance(nothing, MessageValue)


def test_importing_types_stays_light():
    program = """
import sys
before = set(sys.modules)
import lcmtools.types.geometry_msgs
new = set(sys.modules) - before
print(*sorted(name for name in new if name.startswith("lcmtools.") and ".types" not in name))
print(*sorted({"inspect", "dataclasses", "ast", "numpy"} & new))
"""
    done = subprocess.run(
        [sys.executable, "-I", "-c", program], check=True, capture_output=True, text=True
    )
    assert done.stdout == "lcmtools.message_value\n\n"


def _check_protocol(cls):
    return cls(data="a")  # a type checker accepts fields of a class that it does not know


def test_a_class_that_is_found_by_name_takes_fields():
    assert _check_protocol(message_class("std_msgs/String")) == String(data="a")
