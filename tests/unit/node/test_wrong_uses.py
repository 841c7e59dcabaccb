"""Wrong uses of the Python API, as newcomers type them: one line says what was expected."""

import math
from pathlib import Path

import pytest
from fixtures.driver import Driver
from fixtures.says import assert_says, raises_saying

import lcmtools
import lcmtools.types.std_msgs
from lcmtools import Node, Parameter
from lcmtools.errors import LcmtoolsError
from lcmtools.types.geometry_msgs import PoseWithCovariance, Twist
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import Int32, String, UInt8
from lcmtools.types.std_srvs import SetBool, Trigger

MISTAKES = Path(__file__).with_name("mistakes.txt")


class RosString:
    """A class as rclpy has them."""

    __module__ = "std_msgs.msg"


RosString.__name__ = RosString.__qualname__ = "String"

_MISSING_TYPES = [
    (lambda n: n.create_publisher("/a/cmd_vel", 10), "create_publisher(Twist, '/a/cmd_vel')"),
    (lambda n: n.create_publisher("cmd_vel"), "create_publisher(Twist, 'cmd_vel')"),
    (
        lambda n: n.create_subscription("/laser", n.turn),
        "create_subscription(Twist, '/laser', callback)",
    ),
    (
        lambda n: n.create_subscription("/scan", n.turn, 10),
        "create_subscription(Twist, '/scan', callback)",
    ),
    (
        lambda n: n.create_subscription("laser", 10, n.turn),
        "create_subscription(Twist, 'laser', callback)",
    ),
    (lambda n: n.create_service("/reset", n.tick), "create_service(Trigger, '/reset', callback)"),
    (lambda n: n.create_client("/reset"), "create_client(Trigger, '/reset')"),
]
"""Calls as in texts whose types are lost, and how they are written."""

_LINES = [one for one in MISTAKES.read_text().splitlines() if one and one[0] != "#"]


@pytest.mark.parametrize(("call", "line"), [*zip(_LINES[::2], _LINES[1::2], strict=True)])
def test_a_mistake(begin, call, line):
    begin()
    with pytest.raises(LcmtoolsError) as raised:
        eval(call, globals(), {"n": Driver()})  # noqa: S307 - the table is ours
    assert str(raised.value) == line.strip()


@pytest.mark.parametrize(("call", "right"), _MISSING_TYPES)
def test_a_missing_type(begin, call, right):
    begin()
    with pytest.raises(LcmtoolsError) as raised:
        call(Driver())
    name, topic = right.partition("(")[0], right.split("'")[1]
    kind = right.partition("(")[2].partition(",")[0]
    shows = "service info" if kind == "Trigger" else "info"
    assert str(raised.value) == (
        f"{name}: the type is missing before '{topic}'; write {right} if it is {kind}; "
        f"lcmtools {shows} {topic} shows it"
    )


@pytest.mark.parametrize("callback", [print, [].append, lambda *_: None, str])
def test_what_can_be_called_with_a_message_is_a_callback(begin, callback):
    begin()
    Node("a").create_subscription(String, "chatter", callback)


@pytest.mark.parametrize(
    ("period", "line"),
    [
        ("0.1", "create_timer: the period is a number of seconds, got '0.1'"),
        (None, "create_timer: the period is a number of seconds, got None"),
        (print, "create_timer takes the period first; write create_timer(0.1, self.tick)"),
        (0, "a timer's period must be positive and finite, got 0 s"),
        (math.nan, "a timer's period must be positive and finite, got nan s"),
    ],
)
def test_a_wrong_period(begin, period, line):
    begin()
    with pytest.raises(LcmtoolsError) as raised:
        Node("a").create_timer(period, print)
    assert str(raised.value) == line


def test_a_period_that_is_meant_in_milliseconds_is_a_warning(begin, capsys):
    begin()
    node = Node("a")
    node.create_timer(60.0, print)
    assert capsys.readouterr().err == ""
    node.create_timer(500, print)
    assert_says(capsys.readouterr().err, "create_timer: ", "500 s", "500 ms", "0.5\n")


def _filled(message, **values):
    for path, value in values.items():
        *parents, name = path.split("__")
        part = message
        for parent in parents:
            part = getattr(part, parent)
        setattr(part, name, value)
    return message


@pytest.mark.parametrize(
    ("kind", "message", "line"),
    [
        (String, String, ("expected std_msgs/String, got the class std_msgs/String; "
         "write message = String(), and fill it: message.data = ...")),
        (String, {"data": "a"}, ("expected std_msgs/String, got a mapping; "
         "write message = String(), and fill it: message.data = ...")),
        (String, "a", ("expected std_msgs/String, got 'a'; "
         "write message = String(); message.data = 'a'")),
        (Twist, 0.5, "expected geometry_msgs/Twist, got 0.5"),
        (Twist, None, "expected geometry_msgs/Twist, got None"),
        (String, Int32(), "expected std_msgs/String, got std_msgs/Int32"),
        (Twist, _filled(Twist(), linear__x="0.5"),
         "geometry_msgs/Twist: linear.x: expected a number, got '0.5'"),
        (Twist, _filled(Twist(), linear__x=None),
         "geometry_msgs/Twist: linear.x: expected a number, got nothing"),
        (Twist, _filled(Twist(), linear=None),
         "geometry_msgs/Twist: linear: expected geometry_msgs/Vector3, got nothing"),
        (Int32, _filled(Int32(), data=0.5), "std_msgs/Int32: data: expected an integer, got 0.5"),
        (UInt8, _filled(UInt8(), data=256),
         "std_msgs/UInt8: data: 256 does not fit uint8 (0..255)"),
        (String, _filled(String(), data=5), "std_msgs/String: data: expected text, got 5"),
        (PoseWithCovariance, _filled(PoseWithCovariance(), covariance=[0.0] * 35),
         "geometry_msgs/PoseWithCovariance: covariance: expected 36 numbers, got 35"),
        (LaserScan, _filled(LaserScan(), ranges=[1.0, "a"]),
         "sensor_msgs/LaserScan: ranges[1]: expected a number, got 'a'"),
        (LaserScan, _filled(LaserScan(), ranges=1.0),
         "sensor_msgs/LaserScan: ranges: expected a list of numbers, got 1.0"),
    ],
)  # fmt: skip
def test_a_wrong_message_or_value(begin, kind, message, line):
    begin()
    publisher = Node("a").create_publisher(kind, "x")
    with pytest.raises(LcmtoolsError) as raised:
        publisher.publish(message)
    assert str(raised.value) == f"/x: {line}"


@pytest.mark.parametrize(
    ("request_", "line"),
    [
        (None, "/light: expected SetBool.Request, got None"),
        (True, ("/light: expected SetBool.Request, got True; "
         "write message = SetBool.Request(); message.data = True")),
        (SetBool, "/light: expected SetBool.Request, got the class SetBool"),
    ],
)  # fmt: skip
def test_a_wrong_request(begin, request_, line):
    begin()
    client = Node("a").create_client(SetBool, "light")
    with pytest.raises(LcmtoolsError) as raised:
        client.call(request_)
    assert str(raised.value) == line


class Forgetful(Node):
    """A node that does not initialise Node."""

    def __init__(self):
        self.speed = 1.0


@pytest.mark.parametrize(
    "use",
    [
        lambda n: n.create_publisher(String, "chatter"),
        lambda n: n.declare_parameter("gain", 1.0),
        lambda n: n.get_logger(),
        lambda n: n.name,
        lambda n: n.destroy_node(),
        lcmtools.spin,
        lcmtools.spin_once,
    ],
    ids=["publisher", "parameter", "logger", "name", "destroy", "spin", "spin_once"],
)
def test_a_forgotten_super_init(begin, use):
    begin()
    node = Forgetful()
    with pytest.raises(LcmtoolsError) as raised:
        use(node)
    assert_says(str(raised.value), "Forgetful.__init__", "Node", "super().__init__('forgetful')")


def test_to_spin_in_a_callback_is_an_error_of_the_callback(begin):
    context = begin()
    node = Node("a")

    node.create_timer(0.001, lambda: lcmtools.spin(node))
    node.create_timer(0.01, context.stop)
    lcmtools.spin(node)
    (error,) = node.describe().errors
    assert_says(error.message, "lcmtools.spin(/a)", "already", "; ", "once")
    lcmtools.spin(node)  # after the end it returns at once


def test_after_the_end_of_a_node_its_use_is_an_error(begin):
    begin()
    node = Node("a")
    publisher, other = node.create_publisher(String, "x"), node.create_publisher(String, "y")
    node.destroy_publisher(other)
    with raises_saying(LcmtoolsError, "publisher of /y", "destroyed"):
        other.publish(String())
    publisher.publish(String())
    node.destroy_node()
    with raises_saying(LcmtoolsError, "publisher of /x", "destroyed"):
        publisher.publish(String())
    for use in (
        lambda: node.create_publisher(String, "z"),
        lambda: node.create_timer(1.0, print),
        lambda: node.create_client(Trigger, "z"),
        lambda: lcmtools.spin(node),
    ):
        with pytest.raises(LcmtoolsError, match="the node /a was destroyed"):
            use()
    node.get_logger().info("the log works on")


def test_names_of_ros_lead_to_those_of_lcmtools(begin):
    begin()
    with raises_saying(LcmtoolsError, "'init_node'", "write lcmtools.init"):
        lcmtools.init_node("a")
    with raises_saying(LcmtoolsError, "'Rate'", "write rate = node.create_rate(10)"):
        from lcmtools import Rate  # noqa: F401
    with raises_saying(AttributeError, "'get_name'", "write node.name"):
        Node("a").get_name()
    assert not hasattr(lcmtools, "no_such_name")
    assert not hasattr(Node("b"), "no_such_name")


def test_a_property_that_lacks_an_attribute_names_that_one(begin):
    class Robot(Node):
        @property
        def error(self):
            return self.desired - self.measurd

    begin()
    robot = Robot("a")
    robot.desired = 1.0
    with pytest.raises(AttributeError, match="'Robot' object has no attribute 'measurd'"):
        robot.error  # noqa: B018 - it raises


def test_a_client_of_a_destroyed_node_does_not_wait(begin):
    begin()
    node = Node("a")
    client = node.create_client(Trigger, "reset")
    node.destroy_node()
    with raises_saying(LcmtoolsError, "client of /reset", "destroyed"):
        client.call(Trigger.Request())


def test_a_service_that_returns_nothing_says_so(begin, serve):
    begin()
    node = Node("a")
    node.create_service(Trigger, "reset", lambda _request, _response: None)
    serve(node)
    client = Node("b").create_client(Trigger, "reset")
    with raises_saying(LcmtoolsError, "None", "; ", "return response"):
        client.call(Trigger.Request())


def test_a_type_error_inside_of_a_call_stays_one(begin):
    begin()
    node = Node("a")
    node.add_on_set_parameters_callback(lambda _: len(5))
    node.declare_parameter("gain", 1.0)
    with pytest.raises(TypeError, match="has no len"):
        node.set_parameters([Parameter("gain", 2.0)])
