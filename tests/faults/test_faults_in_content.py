"""Faults within messages: numbers, rotations, covariances, stamps, types."""

from typing import Any

import pytest

NAN_IN_COVARIANCE = "m = ODOM; m.pose.covariance[7] = math.nan"
ODOM = "Odometry(); m.pose.pose.orientation.w = 1.0; m.header.stamp = now"
POSE = "PoseStamped(); m.pose.orientation.w = 1.0; m.header.stamp = now"
GOOD = f"m = {ODOM}; SEND"


def _sends(world: Any, statements: str) -> Any:
    made = statements.replace("ODOM", ODOM).replace("POSE", POSE)
    stamp = "now = Time(); now.sec = int(time.time()); "
    return world.sends(stamp + made.replace("SEND", "bus.publish('/it', m.encode())"), 0.03)


@pytest.mark.parametrize(
    ("statements", "rule", "what"),
    [
        ("m = Twist(); m.angular.z = math.nan; SEND", "not-finite", "angular.z is nan"),
        ("m = Twist(); m.linear.x = -math.inf; SEND", "not-finite", "linear.x is -inf"),
        (f"{NAN_IN_COVARIANCE}; SEND", "not-finite", "pose.covariance[7] is nan"),
        ("m = Odometry(); m.header.stamp = now; SEND", "quaternions", "pose.pose.orientation"),
        ("m = POSE; m.pose.orientation.z = 1.0; SEND", "quaternions", "the length 1.41"),
        ("m = ODOM; m.pose.covariance[1] = 1.0; SEND", "covariances", "[6] and [1] are 0 and 1"),
        ("m = ODOM; m.twist.covariance[0] = -0.5; SEND", "covariances", "a variance, is -0.5"),
        ("m = POSE; now.sec += 100; SEND", "stamps", "in the future"),
        ("m = POSE; now.sec -= 100; SEND", "stamps", "s old"),
        ("m = POSE; now.sec = int(time.monotonic()) + 50; SEND", "stamps", "since a start"),
        ("m = ODOM; bus.publish('/it', m.encode()[:-5])", "undecodable", "nav_msgs/Odometry"),
    ],
)
def test_odd_contents(world: Any, statements: str, rule: str, what: str) -> None:
    sender = _sends(world, statements)
    world.finds(rule, "/it from ", f"(pid {sender.pid})", what, wait="0.3s")
    world.end(sender)
    _sends(world, GOOD)
    world.is_silent(wait="0.3s")


TWO = "struct {name}\n{{\n{fields}\n}}\n"


def test_another_type_than_a_node_expects(world: Any) -> None:
    world.node("listener")
    pub = ("pub", "-r", "10", "/chatter", "std_msgs/Int32", "3", "__name:=wrong")
    sender = world.tool(*pub)
    found = world.finds(
        "type-mismatch", "/wrong publishes std_msgs/Int32", "/listener expects std_msgs/String"
    )
    assert found.severity == "error"
    world.end(sender)
    world.node("talker")
    world.is_silent()


def test_a_type_of_the_same_fields(world: Any) -> None:
    """Point and Vector3 are the same on the wire, so this works; it is a slip all the same."""
    pub = ("pub", "-r", "10", "/at", "geometry_msgs/Point", "{x: 1}", "__name:=a")
    sender = world.tool(*pub)
    hears = (
        "import lcmtools\nfrom lcmtools.types.geometry_msgs import Vector3\nlcmtools.init()\n"
        "node = lcmtools.Node('ear')\n"
        "node.create_subscription(Vector3, '/at', lambda _: None, 10)\nlcmtools.spin(node)\n"
    )
    listener = world.script(hears)
    world.until(lambda: listener.pid in world.pids())
    found = world.finds("type-mismatch", "/a publishes geometry_msgs/Point", "/ear expects")
    assert found.severity == "note"
    world.end(sender)
    world.tool(*(word.replace("Point", "Vector3") for word in pub))
    world.is_silent()


def test_a_c_program_with_another_fingerprint(world: Any) -> None:
    world.node("listener")
    sender = world.c("sends", "/chatter", "2e7c07d7cdf7e027", "56", "20")
    world.finds("type-mismatch", sender.pid, "geometry_msgs/Twist", "std_msgs/String")
    world.end(sender)
    world.node("talker")
    world.is_silent()


@pytest.mark.parametrize(
    ("fields", "difference"),
    [
        ("double x; double y;", "without the field theta"),
        ("double x; double y; float theta;", "theta is float32, not float64"),
        ("double x; double y; double yaw;", "theta is called yaw"),
    ],
)
def test_an_old_definition_of_a_message(world: Any, fields: str, difference: str) -> None:
    fingerprint = world.fingerprint(f"package old; struct Pose2D {{ {fields} }}")
    hears = (
        "import lcmtools\nfrom lcmtools.types.geometry_msgs import Pose2D\nlcmtools.init()\n"
        "node = lcmtools.Node('ear')\n"
        "node.create_subscription(Pose2D, '/at', lambda _: None, 10)\nlcmtools.spin(node)\n"
    )
    listener = world.script(hears)
    world.until(lambda: listener.pid in world.pids())
    sender = world.c("sends", "/at", fingerprint, "32", "20")
    world.finds("type-mismatch", sender.pid, "/ear", "geometry_msgs/Pose2D", difference)
    world.end(sender)
    world.sends("bus.publish('/at', Pose2D().encode())")
    world.is_silent()


def test_an_old_definition_that_no_node_listens_to(world: Any) -> None:
    fingerprint = world.fingerprint("package old; struct Twist2 { double linear; double z; }")
    old = world.fingerprint("package old; struct Pose2D { double x; double y; int64_t theta; }")
    sender = world.c("sends", "/at", old, "32", "20")
    world.finds("unknown-type", sender.pid, "like geometry_msgs/Pose2D, but theta is int64")
    world.end(sender)
    world.c("sends", "/at", fingerprint, "32", "20")  # a type of one's own is nobody's fault
    world.is_silent()
