"""The wire format of the ROS types: it must stay what other LCM programs use.

The table was taken from the types that the dimos-lcm package generates and not from our own
.lcm files, so that a field that is renamed, moved or retyped by accident is noticed here.
"""

import importlib

from lcmtools.types.fingerprints import FINGERPRINTS

WIRE_FORMAT = {
    "diagnostic_msgs/DiagnosticArray": 0x1636697C5123AF68,
    "diagnostic_msgs/DiagnosticStatus": 0xD9DC607027AAD370,
    "diagnostic_msgs/KeyValue": 0x2EAE802BAA5DDBBD,
    "geometry_msgs/Accel": 0x2E7C07D7CDF7E027,
    "geometry_msgs/Point": 0xAE7E5FBA5EECA11E,
    "geometry_msgs/PointStamped": 0x9CD764738EA629AF,
    "geometry_msgs/Pose": 0x245634AE2AB17B76,
    "geometry_msgs/Pose2D": 0xE923820E98208B26,
    "geometry_msgs/PoseArray": 0x3755F9405735978E,
    "geometry_msgs/PoseStamped": 0x6A82696458C279A0,
    "geometry_msgs/PoseWithCovariance": 0xCE6428B127D11B5A,
    "geometry_msgs/PoseWithCovarianceStamped": 0xBE9E516A5301B969,
    "geometry_msgs/Quaternion": 0x363BDD3BF9180A2B,
    "geometry_msgs/Transform": 0xEE5FF42647BF3F91,
    "geometry_msgs/TransformStamped": 0x299FF424B83A3514,
    "geometry_msgs/Twist": 0x2E7C07D7CDF7E027,
    "geometry_msgs/TwistStamped": 0x9CD2BCBE6CB2A7C0,
    "geometry_msgs/TwistWithCovariance": 0xB439635A59217509,
    "geometry_msgs/Vector3": 0xAE7E5FBA5EECA11E,
    "geometry_msgs/Wrench": 0xCCFB0646CEBC17C4,
    "geometry_msgs/WrenchStamped": 0xD31BB4C714D07137,
    "nav_msgs/MapMetaData": 0x25ACE38661E74534,
    "nav_msgs/OccupancyGrid": 0xE7DFD179CDFC3B65,
    "nav_msgs/Odometry": 0x94E17F94648CF0E4,
    "nav_msgs/Path": 0xC3AE62ACB35793E2,
    "sensor_msgs/BatteryState": 0x7E3961FD10438489,
    "sensor_msgs/CameraInfo": 0xAFB501B00707A02A,
    "sensor_msgs/CompressedImage": 0xB8D011C10412B9A1,
    "sensor_msgs/Image": 0x535CFACE1F4F5717,
    "sensor_msgs/Imu": 0x31AB205C8DD57AA8,
    "sensor_msgs/JointState": 0xCCEFA8A492B967E3,
    "sensor_msgs/Joy": 0xA0F07ABC86C1684C,
    "sensor_msgs/LaserScan": 0x8DE5754E00F25F00,
    "sensor_msgs/PointCloud2": 0xF5EB3DA1C2853175,
    "sensor_msgs/PointField": 0xE05C1C07E0850BAE,
    "sensor_msgs/Range": 0xB5A86BBEA09886C3,
    "sensor_msgs/RegionOfInterest": 0x73150D3A0B307E1C,
    "std_msgs/Bool": 0x1EBEF06A50950E3E,
    "std_msgs/ColorRGBA": 0x6E32801F8DC60234,
    "std_msgs/Duration": 0xBC3A494751D96C91,
    "std_msgs/Empty": 0x000000002468ACF0,
    "std_msgs/Float32": 0x0ADC26B8F0546DD3,
    "std_msgs/Float64": 0x21DD4103A9A16215,
    "std_msgs/Float64MultiArray": 0x3127CC3ECF7E8B83,
    "std_msgs/Header": 0x2FDB11453BE64AF7,
    "std_msgs/Int32": 0x2CBCF9F7EA91023E,
    "std_msgs/Int64": 0x2CBCF9FDEE91023E,
    "std_msgs/String": 0x21BF37099B9D5E15,
    "std_msgs/Time": 0xBC3A494751D96C91,
    "std_msgs/UInt32": 0x2CBCF9F7EA91023E,
    "std_msgs/UInt64": 0x2CBCF9FDEE91023E,
    "tf2_msgs/TFMessage": 0xC2B8A1C33A8923EC,
    "trajectory_msgs/JointTrajectory": 0xAE3A209832C6D386,
    "trajectory_msgs/JointTrajectoryPoint": 0x36A44BEBDF05DE46,
    "visualization_msgs/Marker": 0x7496E78E9BB40AEB,
}


def test_types_have_the_fingerprints_of_the_wire_format():
    assert {name: FINGERPRINTS[name] for name in WIRE_FORMAT} == WIRE_FORMAT


def test_table_holds_what_the_class_itself_says():
    for name, fingerprint in FINGERPRINTS.items():
        package, _, struct = name.partition("/")
        cls = getattr(importlib.import_module(f"lcmtools.types.{package}"), struct)
        assert cls().get_hash() == fingerprint, name


def test_table_is_sorted_and_unsigned():
    assert list(FINGERPRINTS) == sorted(FINGERPRINTS)
    assert all(0 < number < 2**64 for number in FINGERPRINTS.values())


def test_types_with_equal_fields_share_a_fingerprint():
    assert FINGERPRINTS["geometry_msgs/Point"] == FINGERPRINTS["geometry_msgs/Vector3"]
    assert FINGERPRINTS["geometry_msgs/Twist"] == FINGERPRINTS["geometry_msgs/Accel"]


def test_ros_1_and_ros_2_times_are_told_apart():
    assert FINGERPRINTS["std_msgs/Time"] != FINGERPRINTS["builtin_interfaces/Time"]
