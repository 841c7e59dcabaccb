"""to_dict and from_dict: the values of echo --json and pub, for programs."""

import math

import numpy as np
import pytest

import lcmtools
from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import message_class
from lcmtools.types.geometry_msgs import Pose2D, PoseArray, Twist, Vector3
from lcmtools.types.nav_msgs import OccupancyGrid
from lcmtools.types.sensor_msgs import CameraInfo, Image, Imu, JointState, LaserScan
from lcmtools.types.std_msgs import Empty, String


def test_dicts_are_nested_and_have_no_length_fields():
    message = JointState(name=["left"], position=np.array([0.5]), effort=(1,), name_length=1)
    stamp = {"sec": 0, "nsec": 0}
    assert lcmtools.to_dict(message) == {
        "header": {"seq": 0, "stamp": stamp, "frame_id": ""},
        "name": ["left"],
        "position": [0.5],
        "velocity": [],
        "effort": [1],
    }
    assert lcmtools.to_dict(Image(data=b"\x01\x02"))["data"] == [1, 2]
    assert lcmtools.to_dict(Empty()) == {}
    ranges = lcmtools.to_dict(LaserScan(ranges=[math.inf]))["ranges"]
    assert ranges == [math.inf]


def test_arrays_of_numbers_become_those_of_numpy():
    scan = decode(LaserScan, encode(LaserScan(ranges=[1, 2.5])))
    values = lcmtools.to_dict(scan, arrays=np.asarray)
    assert values["ranges"].dtype == np.float32
    assert np.shares_memory(values["ranges"], np.asarray(scan.ranges))
    assert lcmtools.from_dict(LaserScan, values) == scan
    image = lcmtools.to_dict(Image(data=b"ab"), arrays=np.asarray)
    assert (image["data"].dtype, image["data"].tolist()) == (np.uint8, [97, 98])
    assert lcmtools.to_dict(JointState(name=["a"]), arrays=np.asarray)["name"] == ["a"]
    camera = lcmtools.to_dict(CameraInfo(), arrays=np.asarray)
    assert camera["K"].shape == (9,)


def test_arrays_of_several_dimensions_and_of_messages(odd):
    shapes = odd.Shapes()
    shapes.flags = [True, False]
    shapes.keys = [b"abc", b"def"]
    values = lcmtools.to_dict(shapes, arrays=np.asarray)
    assert values["keys"].tolist() == [[97, 98, 99], [100, 101, 102]]
    assert values["pairs"] == [[{}, {}], [{}, {}]]
    assert encode(lcmtools.from_dict(odd.Shapes, values)) == encode(shapes)
    poses = lcmtools.to_dict(PoseArray(poses=[message_class("geometry_msgs/Pose")()]))
    assert poses["poses"][0]["position"] == {"x": 0, "y": 0, "z": 0}


@pytest.mark.parametrize(
    ("cls", "values", "message"),
    [
        (Twist, {}, Twist()),
        (Twist, {"linear": {"x": 1}}, Twist(linear=Vector3(x=1.0))),
        (Twist, {"linear": [1, 2, 3]}, Twist(linear=Vector3(1, 2, 3))),
        (Twist, {"linear": np.array([1, 2, 3])}, Twist(linear=Vector3(1, 2, 3))),
        (Twist, {"linear": {"x": np.float32(0.5)}}, Twist(linear=Vector3(x=0.5))),
        (String, {"data": "now"}, String(data="now")),
        (Pose2D, {"x": "0x10", "y": ".5"}, Pose2D(x=16.0, y=0.5)),
        (OccupancyGrid, {"data": np.zeros(2, np.int8)}, OccupancyGrid(data=[0, 0])),
        (Image, {"data": "hi"}, Image(data=b"hi")),
        (Image, {"data": bytearray(b"hi")}, Image(data=b"hi")),
        (Image, {"data": [104, 105]}, Image(data=b"hi")),
    ],
)
def test_a_dict_may_have_what_pub_takes(cls, values, message):
    assert lcmtools.from_dict(cls, values) == message


def test_length_fields_are_set():
    made = lcmtools.from_dict(JointState, {"name": ["a", "b"]})
    assert (made.name_length, JointState.decode(made.encode()).name) == (2, ["a", "b"])


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (
            lambda: lcmtools.from_dict(Twist, {"liner": {}}),
            ValueMismatch,
            "geometry_msgs/Twist has no field 'liner' (fields: linear, angular); did you mean",
        ),
        (
            lambda: lcmtools.from_dict(Imu, {"header": "auto"}),
            ValueMismatch,
            "'now' and 'auto' mean the time at which a message is sent; give the time",
        ),
        (
            lambda: lcmtools.from_dict(Twist, [1, 2]),
            UsageError,
            "from_dict: expected a dict of geometry_msgs/Twist's fields, got a list",
        ),
        (
            lambda: lcmtools.from_dict("geometry_msgs/Twist", {}),
            UsageError,
            "from_dict: expected a message class, got 'geometry_msgs/Twist'; write",
        ),
        (
            lambda: lcmtools.to_dict(Twist),
            UsageError,
            "to_dict: expected a message, got a type",
        ),
        (
            lambda: lcmtools.to_dict(Twist(linear=3)),
            ValueMismatch,
            "linear: expected geometry_msgs/Vector3, got 3",
        ),
    ],
)
def test_mistakes_are_named(call, error, said):
    with pytest.raises(error) as raised:
        call()
    assert said in str(raised.value)
