"""Wrong arguments of the Python API: one line says what was expected."""

import math

import pytest
from fixtures.driver import Driver
from fixtures.says import assert_says

import lcmtools
import lcmtools.types.std_msgs
from lcmtools import Node, Parameter
from lcmtools.errors import LcmtoolsError
from lcmtools.types.geometry_msgs import PoseWithCovariance, Twist
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import Int32, String, UInt8
from lcmtools.types.std_srvs import SetBool, Trigger


class RosString:
    """A class as rclpy has them."""

    __module__ = "std_msgs.msg"


RosString.__name__ = RosString.__qualname__ = "String"

_CALLED = "give the function without parentheses: self.tick, not self.tick()"
_IMPORT = "write from lcmtools.types.std_msgs import String"

_TYPES_AND_TOPICS = [
    (
        lambda n: n.create_publisher("chatter", String),
        "create_publisher takes the type first; write create_publisher(String, 'chatter')",
    ),
    (
        lambda n: n.create_subscription("chatter", String, n.turn),
        (
            "create_subscription takes the type first; "
            "write create_subscription(String, 'chatter', callback)"
        ),
    ),
    (
        lambda n: n.create_client("reset", Trigger),
        "create_client takes the type first; write create_client(Trigger, 'reset')",
    ),
    (
        lambda n: n.create_publisher("news", "std_msgs/String"),
        "create_publisher takes the type first; write create_publisher(String, 'news')",
    ),
    (
        lambda n: n.create_publisher("std_msgs/String", 10),
        "create_publisher: the type is a class, not the text 'std_msgs/String'; " + _IMPORT,
    ),
    (
        lambda n: n.create_publisher("std_msgs/String", "chatter"),
        "create_publisher: the type is a class, not the text 'std_msgs/String'; " + _IMPORT,
    ),
    (
        lambda n: n.create_publisher("std_msgs/Strin", "chatter"),
        "unknown type 'std_msgs/Strin'; did you mean std_msgs/String?",
    ),
    (
        lambda n: n.create_service("std_srvs/Trigger", "reset", n.tick),
        (
            "create_service: the type is a class, not the text 'std_srvs/Trigger'; "
            "write from lcmtools.types.std_srvs import Trigger"
        ),
    ),
    (
        lambda n: n.create_publisher(String(), "chatter"),
        "create_publisher: the type is the class String, not a message; write String",
    ),
    (
        lambda n: n.create_publisher(lcmtools.types.std_msgs, "chatter"),
        "create_publisher: the type is a message class, "
        "got the module lcmtools.types.std_msgs; " + _IMPORT,
    ),
    (
        lambda n: n.create_publisher(RosString, "chatter"),
        "create_publisher: the class String is not a message type of LCM; " + _IMPORT,
    ),
    (
        lambda n: n.create_publisher(dict, "chatter"),
        "create_publisher: the class dict is not a message type of LCM",
    ),
    (
        lambda n: n.create_publisher(Trigger, "chatter"),
        "create_publisher: Trigger is a service, not a message; see create_service",
    ),
    (
        lambda n: n.create_service(String, "reset", n.tick),
        "create_service: std_msgs/String is a message, not a service",
    ),
    (
        lambda n: n.create_client(Trigger.Request, "reset"),
        (
            "create_client: std_srvs/Trigger_Request is a message, not a service; "
            "write from lcmtools.types.std_srvs import Trigger"
        ),
    ),
    (
        lambda n: n.create_publisher(String, None),
        "create_publisher: the topic is a text, got None",
    ),
    (
        lambda n: n.create_publisher(String, ""),
        "create_publisher: the topic is empty",
    ),
    (
        lambda n: n.create_subscription(String, n.turn, "chatter"),
        (
            "create_subscription: the topic is a text, got the function turn; "
            "the callback comes after it"
        ),
    ),
    (
        lambda n: n.create_subscription((), "chatter", n.turn),
        "create_subscription: there is no type",
    ),
    (
        lambda n: n.create_publisher(String, "chatter", "10"),
        "create_publisher: the depth is a number of messages, such as 10; got '10'",
    ),
]

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

_CALLBACKS = [
    (
        lambda n: n.create_timer(0.1, n.tick()),
        "create_timer: the callback is None, perhaps the result of a call; " + _CALLED,
    ),
    (
        lambda n: n.create_timer(0.1, n.later()),
        "create_timer: the callback is a coroutine, perhaps the result of a call; " + _CALLED,
    ),
    (
        lambda n: n.create_timer(0.1, n.later),
        "create_timer: the callback later is async; write def later, not async",
    ),
    (
        lambda n: n.create_timer(0.1, 5),
        "create_timer: the callback is 5, not a function",
    ),
    (
        lambda n: n.create_timer(0.1, n.turn),
        (
            "create_timer: the callback turn(message) is called as turn(); "
            "write def turn(self) in a class"
        ),
    ),
    (
        lambda n: n.create_timer(0.1, Driver.tick),
        (
            "create_timer: the callback tick(self) is called as tick(); "
            "give the method of an object: self.tick"
        ),
    ),
    (
        lambda n: n.create_subscription(String, "chatter", n.tick),
        (
            "create_subscription: the callback tick() is called as tick(message); "
            "write def tick(self, message) in a class"
        ),
    ),
    (
        lambda n: n.create_service(Trigger, "reset", n.turn),
        (
            "create_service: the callback turn(message) is called as turn(request, response); "
            "write def turn(self, request, response) in a class"
        ),
    ),
    (
        lambda n: n.add_on_set_parameters_callback(n.tick),
        (
            "add_on_set_parameters_callback: the callback tick() is called as "
            "tick(parameters); "
            "write def tick(self, parameters) in a class"
        ),
    ),
]

_NAMES_AND_PARAMETERS = [
    (lambda n: n.declare_parameter(5, 5), "declare_parameter: the name is a text, got 5"),
    (
        lambda n: n.set_parameters(Parameter("gain", 2.0)),
        (
            "parameters are set by a list of Parameter, got a Parameter; "
            "write set_parameters([lcmtools.Parameter('name', value)])"
        ),
    ),
    (
        lambda n: n.set_parameters_atomically([("gain", 2.0)]),
        (
            "parameters are set by a list of Parameter, got a list; "
            "write set_parameters([lcmtools.Parameter('name', value)])"
        ),
    ),
    (lambda _: Node(None), "Node: the name is a text, got None"),
]


@pytest.mark.parametrize(
    ("call", "line"), [*_TYPES_AND_TOPICS, *_CALLBACKS, *_NAMES_AND_PARAMETERS]
)
def test_a_wrong_argument(begin, call, line):
    begin()
    with pytest.raises(LcmtoolsError) as raised:
        call(Driver())
    assert str(raised.value) == line


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
