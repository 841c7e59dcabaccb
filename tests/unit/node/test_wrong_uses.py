"""Wrong uses of the Python API, as newcomers type them: one line says what was expected."""

import pytest
from fixtures.driver import Driver
from fixtures.says import assert_says, raises_saying

import lcmtools
import lcmtools.types.std_msgs
from lcmtools import Node, Parameter
from lcmtools.errors import LcmtoolsError
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger


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


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (
            lambda _: lcmtools.spin(),
            "lcmtools.spin() has no node to run; write lcmtools.spin(node)",
        ),
        (
            lambda _: lcmtools.spin(Driver),
            "lcmtools.spin needs a node, got the class Driver; write lcmtools.spin(Driver())",
        ),
        (
            lambda n: lcmtools.spin([n, n]),
            "lcmtools.spin needs a node, got a list; write lcmtools.spin(node, other_node)",
        ),
        (
            lambda _: lcmtools.spin_once(None),
            "lcmtools.spin_once needs a node, got None; write lcmtools.spin_once(node)",
        ),
        (
            lambda _: lcmtools.init("talker"),
            (
                "lcmtools.init takes the command line as a list of words, got 'talker'; "
                "write lcmtools.init() and lcmtools.Node('talker')"
            ),
        ),
        (
            lambda n: n.create_publisher(Twist, "cmd_vel", queue_size=10),
            (
                "create_publisher got an unexpected keyword argument 'queue_size'; "
                "write create_publisher(message_type, topic, depth=10, plain_channel=False)"
            ),
        ),
        (
            lambda n: n.create_timer(period=0.1, callback=n.tick),
            (
                "create_timer got an unexpected keyword argument 'period'; "
                "write create_timer(seconds, callback)"
            ),
        ),
        (
            lambda n: n.create_service(Trigger, "reset"),
            (
                "create_service missing 1 required positional argument: 'callback'; "
                "write create_service(service_type, name, callback)"
            ),
        ),
        (
            lambda n: n.create_publisher(Twist, "cmd_vel").publish(linear=1.0),
            "publish got an unexpected keyword argument 'linear'; write publish(message)",
        ),
        (
            lambda n: n.create_publisher(Twist, "cmd_vel").publish(1.0, 2.0),
            "publish got too many arguments; write publish(message)",
        ),
        (
            lambda n: n.create_client(Trigger, "reset").call(),
            (
                "call missing 1 required positional argument: 'request'; "
                "write call(request, timeout=3.0)"
            ),
        ),
        (
            lambda n: lcmtools.spin(node=n),
            "spin got an unexpected keyword argument 'node'; write spin(node, ...)",
        ),
        (
            lambda _: Parameter("gain"),
            (
                "Parameter missing 1 required positional argument: 'value'; "
                "write Parameter(name, value)"
            ),
        ),
        (
            lambda _: Parameter("gain", Parameter, 2.0),
            "Parameter got too many arguments; write Parameter(name, value)",
        ),
        (
            lambda _: Parameter(2.0, "gain"),
            "Parameter: the name is a text, got 2.0",
        ),
        (
            lambda _: lcmtools.message_class(),
            (
                "message_class missing 1 required positional argument: 'name'; "
                "write message_class(name, number=None)"
            ),
        ),
        (
            lambda _: lcmtools.message_class(7),
            (
                "message_class: a type's name is a text, got 7; "
                "write lcmtools.message_class('std_msgs/String')"
            ),
        ),
        (
            lambda n: n.get_logger().info("speed %f", 1.0),
            "info got too many arguments; write info(text, once=False, throttle=0.0)",
        ),
        (
            lambda _: Node(),
            (
                "Node missing 1 required positional argument: 'name'; "
                "write Node(name, namespace='', tool=False, context=None)"
            ),
        ),
        (
            lambda n: lcmtools.spin_once(n, timeout_sec=0.1),
            (
                "spin_once got an unexpected keyword argument 'timeout_sec'; "
                "write spin_once(node, timeout=0.0)"
            ),
        ),
    ],
)
def test_a_wrong_call(begin, call, line):
    begin()
    with pytest.raises(LcmtoolsError) as raised:
        call(Driver())
    assert str(raised.value) == line


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
