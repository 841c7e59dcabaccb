"""Each generated class can be imported, made, encoded and decoded."""

import importlib
import subprocess
import sys

from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES
from lcmtools.types.service import Service

PACKAGES = sorted({name.partition("/")[0] for name in FINGERPRINTS})

# What the labs, the tools and the ROS programs that are brought here look for.
EXPECTED_NAMES = {
    "air_lab0": "ControllerEvaluationStat",
    "builtin_interfaces": "Duration Time",
    "diagnostic_msgs": "DiagnosticArray DiagnosticStatus KeyValue",
    "gazebo_msgs": "ContactState ContactsState",
    "geometry_msgs": """
        Accel AccelStamped AccelWithCovariance AccelWithCovarianceStamped Inertia InertiaStamped
        Point Point32 PointStamped Polygon PolygonStamped Pose Pose2D PoseArray PoseStamped
        PoseWithCovariance PoseWithCovarianceStamped Quaternion QuaternionStamped Transform
        TransformStamped Twist TwistStamped TwistWithCovariance TwistWithCovarianceStamped
        Vector3 Vector3Stamped Wrench WrenchStamped""",
    "lcmtools_msgs": """
        Announcement Appendable CallbackError Endpoint FullLine NodeDetails Observed
        ObservedPublisher Parameter Parameters_Request Parameters_Response Probe RelayEnd RelayLink
        RelayReport RelayStep RemoteAnnouncement ServiceReply ServiceRequest Shutdown""",
    "nav_msgs": "GridCells MapMetaData OccupancyGrid Odometry Path",
    "rosgraph_msgs": "Clock Log TopicStatistics",
    "sensor_msgs": """
        BatteryState CameraInfo ChannelFloat32 CompressedImage FluidPressure Illuminance Image Imu
        JointState Joy JoyFeedback JoyFeedbackArray LaserEcho LaserScan MagneticField
        MultiDOFJointState MultiEchoLaserScan NavSatFix NavSatStatus PointCloud PointCloud2
        PointField Range RegionOfInterest RelativeHumidity Temperature TimeReference""",
    "sim_msgs": """
        Delete_Request Delete_Response GetState_Request GetState_Response
        SetPose_Request SetPose_Response SetRate_Request SetRate_Response
        Snapshot_Request Snapshot_Response Spawn_Request Spawn_Response
        Step_Request Step_Response
    """,
    "std_msgs": """
        Bool Byte ByteMultiArray Char ColorRGBA Duration Empty Float32 Float32MultiArray Float64
        Float64MultiArray Header Int16 Int16MultiArray Int32 Int32MultiArray Int64 Int64MultiArray
        Int8 Int8MultiArray MultiArrayDimension MultiArrayLayout String Time UInt16
        UInt16MultiArray UInt32 UInt32MultiArray UInt64 UInt64MultiArray UInt8 UInt8MultiArray""",
    "std_srvs": """
        Empty_Request Empty_Response SetBool_Request SetBool_Response Trigger_Request
        Trigger_Response""",
    "tf2_msgs": "TF2Error TFMessage",
    "trajectory_msgs": """
        JointTrajectory JointTrajectoryPoint MultiDOFJointTrajectory
        MultiDOFJointTrajectoryPoint""",
    "visualization_msgs": "Marker MarkerArray",
}


def class_of(name):
    package, _, struct = name.partition("/")
    return getattr(importlib.import_module(f"lcmtools.types.{package}"), struct)


def run_python(program):
    command = [sys.executable, "-c", program]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_packages_are_the_expected_ones():
    assert set(EXPECTED_NAMES) == set(PACKAGES)


def test_packages_hold_the_expected_types():
    names = [
        f"{package}/{name}" for package, text in EXPECTED_NAMES.items() for name in text.split()
    ]
    assert list(FINGERPRINTS) == names


def test_new_messages_survive_the_wire():
    for name, fingerprint in FINGERPRINTS.items():
        cls = class_of(name)
        payload = cls().encode()
        assert payload[:8] == fingerprint.to_bytes(8, "big"), name
        assert cls.decode(payload).encode() == payload, name


def test_tables_of_a_class_are_equally_long():
    for cls in map(class_of, FINGERPRINTS):
        assert len(cls.__slots__) == len(cls.__typenames__) == len(cls.__dimensions__), cls


def test_arrays_of_bytes_have_a_variable_length():
    # lcm-gen makes b"" of a fixed one, which encodes to a message too short to decode.
    for cls in map(class_of, FINGERPRINTS):
        for kind, dimensions in zip(cls.__typenames__, cls.__dimensions__, strict=True):
            if kind == "byte" and dimensions:
                assert all(isinstance(size, str) for size in dimensions), cls


def test_values_survive_the_wire():
    from lcmtools.types.sensor_msgs import JointState

    sent = JointState()
    sent.header.stamp.sec = 12
    sent.header.frame_id = "base_link"
    sent.name_length, sent.name = 2, ["left", "right"]
    sent.effort_length, sent.effort = 2, [0.5, -0.5]
    received = JointState.decode(sent.encode())
    assert received.header.stamp.sec == 12
    assert received.header.frame_id == "base_link"
    assert received.name == ["left", "right"]
    assert received.effort == (0.5, -0.5)


def test_services_are_pairs_of_a_request_and_a_response():
    requests = (name for name in FINGERPRINTS if name.endswith("_Request"))
    assert tuple(name.removesuffix("_Request") for name in requests) == SERVICES
    assert {"std_srvs/Empty", "std_srvs/SetBool", "std_srvs/Trigger"} <= set(SERVICES)


def test_service_pairs_its_request_with_its_response():
    for name in SERVICES:
        pair = class_of(name)
        assert issubclass(pair, Service), name
        assert pair.Request is class_of(f"{name}_Request")
        assert pair.Response is class_of(f"{name}_Response")


def test_importing_the_room_imports_no_type():
    program = """
import sys, lcmtools.types.fingerprints
print(sorted(name for name in sys.modules if name.startswith("lcmtools.types")))
"""
    assert run_python(program) == "['lcmtools.types', 'lcmtools.types.fingerprints']\n"


def test_importing_a_package_imports_only_what_it_needs():
    program = """
import sys, lcmtools.types.geometry_msgs
print(sorted({name.split(".")[2] for name in sys.modules if name.startswith("lcmtools.types.")}))
print("lcm" in sys.modules)
"""
    assert run_python(program) == "['geometry_msgs']\nFalse\n"


def test_comment_of_a_field_reaches_the_class():
    import inspect

    from lcmtools.types.geometry_msgs import Twist

    source = inspect.getsource(Twist)
    linear = source.index("self.linear = ")
    assert source.index("[m/s] linear velocity", linear) < source.index("self.angular = ", linear)
