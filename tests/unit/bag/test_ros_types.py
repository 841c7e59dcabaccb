"""Types and messages of LCM as those of ROS, and back."""

import pytest

from lcmtools.bag.ros_types import Conversion, RosTypes, ros_name
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import message_class, type_name, type_names
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.builtin_interfaces import Time
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import (
    CameraInfo,
    Image,
    JointState,
    LaserScan,
    PointCloud2,
    PointField,
)
from lcmtools.types.std_msgs import Empty, Header, UInt8, UInt64

_BOTH = pytest.mark.parametrize("version", [1, 2])


def _again(message, version, types=None):
    """A message after its way through ROS's bytes."""
    types = types or RosTypes(version)
    data = types.serialize(message)
    name = types.ros_type(type(message)).name
    read = types.store.deserialize_ros1 if version == 1 else types.store.deserialize_cdr
    return types.to_lcm(type(message), name, read(data, name))


def _scan():
    scan = LaserScan()
    scan.header.frame_id, scan.header.stamp.sec, scan.header.stamp.nsec = "laser", 17, 999_999_999
    scan.angle_min, scan.ranges = -1.5, [0.5, float("inf"), 2.25]
    return scan


def _camera():
    camera = CameraInfo()
    camera.width, camera.D, camera.K, camera.roi.do_rectify = 640, [0.1, 0.2], [1.0] * 9, True
    return camera


def _cloud():
    cloud = PointCloud2()
    cloud.fields, cloud.data = [PointField(), PointField()], bytes(range(256))
    cloud.fields[1].name, cloud.fields[1].datatype = "y", 7
    return cloud


def _joints():
    joints = JointState()
    joints.name, joints.position = ["a", "ä"], [0.1, -0.2]
    return joints


@_BOTH
@pytest.mark.parametrize("make", [_scan, _camera, _cloud, _joints, Odometry, Empty, Image])
def test_messages_are_the_same_after_their_way_through_ros(make, version):
    message = make()
    assert encode(_again(message, version)) == encode(message)


@_BOTH
def test_every_type_can_be_said(version):
    types = RosTypes(version)
    for name in type_names():
        message = message_class(name)()
        assert encode(_again(message, version, types)) == encode(message), name


def test_types_that_ros_has_are_its_own():
    known = RosTypes(1).ros_type(LaserScan)
    assert known.digest == "90c7ef2dc6895d81024acba2ac42f369"  # rosmsg md5 sensor_msgs/LaserScan
    assert RosTypes(2).ros_type(CameraInfo).definition.splitlines()[4] == "float64[] d"
    assert "uint32 seq" in known.definition
    assert "seq" not in RosTypes(2).ros_type(Header).definition


def test_other_types_are_described():
    described = RosTypes(2).ros_type(ControllerEvaluationStat)
    assert described.name == "air_lab0/msg/ControllerEvaluationStat"
    assert "float64" in described.definition


def test_whole_numbers_change_their_sign_and_no_bit():
    large = UInt64()
    large.data = -1
    types = RosTypes(1)
    made = types.to_ros(UInt64, types.ros_type(UInt64).name, large)
    assert made.data == 2**64 - 1
    assert _again(large, 1).data == -1
    small = UInt8()
    small.data = 255
    assert _again(small, 2).data == 255


def test_a_header_loses_its_number_in_ros_2_only():
    header = Header()
    header.seq, header.frame_id = 12, "map"
    assert encode(_again(header, 1)) == encode(header)
    assert _again(header, 2).seq == 0


def test_times_are_those_of_ros():
    types = RosTypes(2)
    assert types.ros_type(Time).name == "builtin_interfaces/msg/Time"
    assert "time stamp" in RosTypes(1).ros_type(Header).definition


def test_names():
    assert ros_name(Odometry) == "nav_msgs/msg/Odometry"


def test_a_type_with_other_fields_does_not_fit():
    types = RosTypes(1)
    types.ros_type(LaserScan)
    conversion = Conversion(types.store, 2)
    assert conversion.fits(LaserScan, "sensor_msgs/msg/LaserScan")
    assert not conversion.fits(Image, "sensor_msgs/msg/LaserScan")
    assert not conversion.fits(Image, "sensor_msgs/msg/None")


@_BOTH
def test_of_two_types_of_one_name_ros_has_the_first(version):
    types, first = RosTypes(version), ControllerEvaluationStat
    later = type(first.__name__, (UInt64,), {"__module__": first.__module__})
    types.serialize(first())
    for _ in range(2):
        with pytest.raises(DecodeError, match=f"another {type_name(first)} came before"):
            types.serialize(later())
