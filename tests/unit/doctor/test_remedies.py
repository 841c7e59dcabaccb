"""The flag that connects what is not connected."""

import pytest
from fixtures.judging import STEP, judge
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.renaming import NearNames, are_near
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness, Traffic
from lcmtools.wire.packet import Sender

TWIST = (0x2E7C07D7CDF7E027,)


def node(name, role, topic, command=""):
    end = Endpoint(topic, role, ("geometry_msgs/Twist",), TWIST)
    return Node(name, name, "here", 1, command=command, endpoints=(end,))


def remedies(*nodes, traffic=()):
    evidence = Evidence("udpm://", graph=Graph(nodes, tuple(traffic)))
    found = {finding.rule: finding for finding in judge(evidence)}
    return found["unconnected-subscriptions"].remedies


PAIRS = {
    "a listener in the wrong namespace is moved": (
        ("/robot/pilot", "/robot/cmd_vel"),
        ("/driver", "/cmd_vel"),
        "/robot/cmd_vel is published: start /driver with __ns:=/robot",
    ),
    "a publisher is moved where the listener's topic is fixed": (
        ("/pioneer0/teleop", "/pioneer0/cmd_vel"),
        ("/gazebo", "/RosAria/cmd_vel"),
        "/pioneer0/teleop publishes /pioneer0/cmd_vel: start /pioneer0/teleop with __ns:=/RosAria",
    ),
    "where neither can be moved, the publisher is remapped": (
        ("/pilot", "/fixed/cmd_vel"),
        ("/gazebo", "/RosAria/cmd_vel"),
        "/pilot publishes /fixed/cmd_vel: start /pilot with /fixed/cmd_vel:=/RosAria/cmd_vel",
    ),
    "a name with a slip is remapped": (
        ("/pilot", "/cmd_vel"),
        ("/driver", "/cmdvel"),
        "/cmd_vel is published: start /driver with cmdvel:=/cmd_vel",
    ),
    "a remap with a slip is written again": (
        ("/pilot", "/robot/cmd_vel"),
        ("/driver", "/robot/cmd_ve", "lcmtools run driver speed:=/robot/cmd_ve"),
        (
            "/robot/cmd_vel is published: start /driver with speed:=/robot/cmd_vel"
            " in place of speed:=/robot/cmd_ve"
        ),
    ),
    "a remap the wrong way round is turned": (
        ("/pilot", "/speed", "lcmtools run pilot cmd_vel:=speed"),
        ("/gazebo", "/cmd_vel"),
        (
            "/speed of the same type has no subscriber: start /pilot with speed:=cmd_vel"
            " in place of cmd_vel:=speed"
        ),
    ),
    "a remap with a slip that only repeats the name is left out": (
        ("/pilot", "/cmd_vel"),
        ("/driver", "/cmd_vell", "run driver cmd_vel:=/cmd_vell"),
        "/cmd_vel is published: start /driver without cmd_vel:=/cmd_vell",
    ),
    "a remap that leads away from what is published is taken back": (
        ("/robot/wheels", "/robot/odometry"),
        ("/robot/filter", "/robot/speed", "run filter __ns:=/robot odometry:=speed"),
        "/robot/odometry is published: start /robot/filter without odometry:=speed",
    ),
    "a command is told the near topic": (
        ("/_pub", "/Husky0/cmd_vel"),
        ("/gazebo", "/husky0/cmd_vel"),
        "/_pub publishes /Husky0/cmd_vel: let it publish on '/husky0/cmd_vel'",
    ),
    "a command is told the topic's namespace": (
        ("/_pub", "/cmd_vel"),
        ("/gazebo", "/husky0/cmd_vel"),
        "/_pub publishes /cmd_vel: let it publish on '/husky0/cmd_vel'",
    ),
    "a command in a mistyped namespace is told the near topic": (
        ("/_pub", "/husky/desired_velocity"),
        ("/husky0/controller", "/husky0/desired_velocity"),
        "/_pub publishes /husky/desired_velocity: let it publish on '/husky0/desired_velocity'",
    ),
    "a command is not told to publish something else": (
        ("/_pub", "/husky0/wish"),
        ("/gazebo", "/husky0/cmd_vel"),
        "start a publisher of /husky0/cmd_vel; to see what is published: lcmtools list -v",
    ),
}


@pytest.mark.parametrize("sentence", PAIRS)
def test_a_publisher_and_a_subscriber_are_connected(sentence):
    (name, *publishes), (listener, *subscribes), remedy = PAIRS[sentence]
    publisher = node(name, Role.PUBLISHER, *publishes)._replace(tool=name.startswith("/_"))
    assert remedies(publisher, node(listener, Role.SUBSCRIBER, *subscribes)) == (remedy,)


def test_many_topics_that_may_be_meant_are_not_all_told_to_each_of_many_subscriptions():
    outputs = [node(f"/out{i}", Role.PUBLISHER, f"/speed{i}") for i in range(100)]
    inputs = [node(f"/in{i}", Role.SUBSCRIBER, f"/wish{i}") for i in range(3)]
    found = judge(Evidence("udpm://", graph=Graph((*outputs, *inputs))))
    assert len(found[0].remedies) == 3 * 20


def test_a_command_that_listens_to_all_topics_changes_no_remedy():
    sensor = node("/robot/wheels", Role.PUBLISHER, "/robot/odometry")
    output = Endpoint("/wheel_cmd", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    driver = node("/driver", Role.SUBSCRIBER, "/odometry")
    driver = driver._replace(endpoints=(*driver.endpoints, output))
    watching = tuple(
        Endpoint(topic, Role.SUBSCRIBER) for topic in ("/robot/odometry", "/wheel_cmd")
    )
    spy = Node("/_spy", "spy", "here", 2, tool=True, endpoints=watching)
    evidence = Evidence("udpm://", graph=Graph((sensor, driver, spy)))
    found = {finding.rule: finding for finding in judge(evidence)}
    assert found["unconnected-subscriptions"].remedies == (
        "/robot/odometry is published: start /driver with __ns:=/robot",
    )


@pytest.mark.parametrize(
    ("one", "other", "near"),
    [
        ("/husky0/velocty_comand", "/husky0/velocity_command", True),
        ("/husky0/velocty_comand", "/husky0/velocity_cmd", True),
        ("/husky0/velocity_command", "/husky0/velocity_cmd", True),
        ("/husky0/odomerty", "/husky0/odometry", True),
        ("/huksy0/odometry", "/husky0/odometry", True),
        ("/husky/odometry", "/husky0/odometry", True),
        ("/desired_velocity", "/measured_velocity", False),
        ("/left_camera", "/right_camera", False),
        ("/imu_data", "/image_data", False),
        ("/front_laser", "/rear_laser", False),
        ("/chatter", "/chater", True),
        ("/chatter", "/chattre", True),
        ("/chatter", "/chatters", True),
        ("/chatter", "chatter", True),
        ("/Chatter", "/chatter", True),
        ("/cmd_vel", "/cmdvel", True),
        ("/husky0/odom", "/husky1/odom", False),
        ("/odometry", "/odometry", False),
        ("/a", "/b", False),
        ("/left", "/right", False),
        ("/imu", "/image", False),
    ],
)
def test_names_that_are_near(one, other, near):
    assert are_near(one, other) is near
    assert are_near(other, one) is near


_WORDS = ("odom", "odometry", "velocity", "velocty", "cmd", "command", "Command", "left", "a", "b")
_NAMES = st.lists(st.sampled_from(_WORDS), min_size=1, max_size=3)
_TOPICS = st.builds(lambda *parts: "/".join(["", *map("_".join, parts)]), _NAMES, _NAMES)


@given(_TOPICS, st.lists(_TOPICS, max_size=12))
def test_the_index_finds_every_near_name(name, names):
    near = {other for other in names if are_near(other, name)}
    assert set(NearNames(names).of(name)) == near


@pytest.mark.parametrize("channel", ["//cmd_vel", "/cmd_vel/"])
def test_a_plain_program_is_told_a_slash_that_no_remap_gives(channel):
    sent = Traffic(channel, Sender("10.0.0.1", 4000), TWIST, 10, 10, 1, 2)
    stream = Stream(channel, sent.sender, "pilot (pid 9)", (0, 1))
    graph = Graph((node("/driver", Role.SUBSCRIBER, "/cmd_vel"),), traffic=(sent,))
    found = {f.rule: f for f in judge(Evidence("udpm://", graph=graph, streams=(stream,)))}
    (remedy,) = found["unconnected-subscriptions"].remedies
    assert remedy.endswith("published, by pilot (pid 9): let it publish on '/cmd_vel'")


def test_remaps_that_were_swapped_are_swapped_back():
    laser = Endpoint("/robot/scan", Role.PUBLISHER, ("sensor_msgs/LaserScan",), (7,))
    robot = node("/robot", Role.SUBSCRIBER, "/robot/cmd_vel")
    robot = robot._replace(endpoints=(*robot.endpoints, laser))
    pilot = node(
        "/pilot", Role.PUBLISHER, "/robot/scan", "pilot in:=/robot/cmd_vel out:=/robot/scan"
    )
    scan = laser._replace(topic="/robot/cmd_vel", role=Role.SUBSCRIBER)
    reason = "/robot/scan of the same type has no subscriber"
    assert remedies(robot, pilot._replace(endpoints=(*pilot.endpoints, scan))) == (
        f"{reason}: start /pilot with out:=/robot/cmd_vel in place of out:=/robot/scan",
        f"{reason}: start /pilot with in:=/robot/scan in place of in:=/robot/cmd_vel",
    )


def test_what_a_remedy_connects_is_no_unconnected_publication():
    graph = Graph(
        (
            node("/robot/pilot", Role.PUBLISHER, "/robot/cmd_vel"),
            node("/driver", Role.SUBSCRIBER, "/cmd_vel"),
        )
    )
    rules = [finding.rule for finding in judge(Evidence("udpm://", graph=graph))]
    assert "unconnected-publications" not in rules


def simulator(name, *ends):
    clock = Endpoint("/clock", Role.PUBLISHER, ("rosgraph_msgs/Clock",), (1,))
    return Node(name, name + ends[0].topic, "here", 1, endpoints=(clock, STEP, *ends))


def test_others_go_by_the_names_of_a_simulator():
    odometry = Endpoint("/robot/odometry", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    morse = simulator("/morse", odometry)
    assert remedies(morse, node("/robot/filter", Role.SUBSCRIBER, "/robot/odom")) == (
        "/robot/odometry is of the same type: start /robot/filter with odom:=odometry",
    )


@pytest.mark.parametrize(
    ("topic", "remedy"),
    [
        ("/robot/odometri", "start /robot/filter with odometri:=/robot/odometry"),
        ("/robt/odometry", "start /robot/filter with /robt/odometry:=/robot/odometry"),
    ],
)
def test_a_mistyped_name_is_corrected_in_the_program_and_not_in_the_simulator(topic, remedy):
    odometry = Endpoint("/robot/odometry", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    (said,) = remedies(simulator("/morse", odometry), node("/robot/filter", Role.SUBSCRIBER, topic))
    assert said.endswith(remedy)


@pytest.mark.parametrize(
    ("others", "severity"),
    [
        ((), Severity.NOTE),
        ((node("/mine", Role.PUBLISHER, "/speed"),), Severity.WARNING),
        ((node("/mine", Role.SUBSCRIBER, "/image"),), Severity.WARNING),
    ],
)
def test_a_robot_that_waits_for_its_first_command_is_no_warning(others, severity):
    command = Endpoint("/robot/command", Role.SUBSCRIBER, ("geometry_msgs/Twist",), TWIST)
    evidence = Evidence("udpm://", graph=Graph((simulator("/morse", command), *others)))
    found = {finding.rule: finding.severity for finding in judge(evidence)}
    assert found["unconnected-subscriptions"] is severity


def test_a_simulator_is_not_connected_with_another_one():
    speed = Endpoint("/robot/speed", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    command = Endpoint("/robot/command", Role.SUBSCRIBER, ("geometry_msgs/Twist",), TWIST)
    assert remedies(simulator("/morse", speed), simulator("/morse", command)) == (
        "start a publisher of /robot/command; to see what is published: lcmtools list -v",
    )


@pytest.mark.parametrize(
    ("channel", "remedy"),
    [
        ("/cmd_vel", "'/cmd_vel' is published, by sender: let it publish on '/husky0/cmd_vel'"),
        (
            "cmd_vel",
            (
                "'cmd_vel' is published, by sender: in /gazebo, subscribe to"
                " 'cmd_vel' with plain_channel=True, in C++ to plain_channel('cmd_vel')"
            ),
        ),
        (
            "/husky0/cmdvel",
            (
                "/husky0/cmdvel is published, by sender: let it publish on '/husky0/cmd_vel',"
                " or start /gazebo with /husky0/cmd_vel:=/husky0/cmdvel"
            ),
        ),
    ],
)
def test_a_program_that_is_no_node_is_told_where_to_publish(channel, remedy):
    sender = Sender("127.0.0.1", 4000)
    traffic = Traffic(channel, sender, TWIST, 5, 50, 1, 2)
    ear = node("/gazebo", Role.SUBSCRIBER, "/husky0/cmd_vel")
    streams = (Stream(channel, sender, "sender", (1, 2)),)
    evidence = Evidence("udpm://", graph=Graph((ear,), (traffic,)), streams=streams)
    found = {finding.rule: finding for finding in judge(evidence)}
    assert found["unconnected-subscriptions"].remedies == (remedy,)


def said_of(*nodes, **evidence):
    found = Evidence("udpm://", graph=Graph(nodes), **evidence)
    return {finding.rule: finding for finding in judge(found)}


def test_a_plain_program_in_a_namespace_moves_the_node_there():
    sender = Sender("127.0.0.1", 4000)
    traffic = (Traffic("/robot/cmd_vel", sender, TWIST, 5, 50, 1, 2),)
    driver = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    (found,) = judge(Evidence("udpm://", graph=Graph((driver,), traffic)))
    assert found.remedies == (
        "/robot/cmd_vel is published, by 127.0.0.1:4000: start /driver with __ns:=/robot",
    )
    (remedy,) = found.finding.remedies
    assert (remedy.kind, str(remedy.parts["node"]), remedy.parts["namespace"]) == (
        "namespace",
        "/driver",
        "/robot",
    )


@pytest.mark.parametrize("slip", ["/cmdvel", "/Cmd_vel"])
def test_a_publisher_whose_remap_has_a_slip_is_named(slip):
    publisher = node("/pilot", Role.PUBLISHER, slip, f"lcmtools run pilot cmd_vel:={slip}")
    subscriber = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    assert remedies(publisher, subscriber) == (
        f"/pilot publishes {slip}: start /pilot without cmd_vel:={slip}",
    )


@pytest.mark.parametrize("channel", ["/cmd_vel ", "cmd vel"])
def test_a_plain_program_on_a_channel_that_no_node_can_have(channel):
    traffic = (Traffic(channel, Sender("127.0.0.1", 4000), TWIST, 5, 50, 1, 2),)
    driver = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    found = {one.rule: one for one in judge(Evidence("udpm://", graph=Graph((driver,), traffic)))}
    (remedy,) = found["unconnected-subscriptions"].remedies
    assert remedy.startswith(f"'{channel}' is published, by ")
    assert remedy.endswith(": let it publish on '/cmd_vel'")


@pytest.mark.parametrize(("channel", "topic"), [("POSE", "/POSE"), ("arm/POSE", "/arm/POSE")])
def test_a_node_is_told_how_to_receive_from_a_plain_channel(channel, topic):
    sent = Traffic(channel, Sender("10.0.0.1", 4000), TWIST, 10, 10, 1, 2)
    viewer = node("/viewer", Role.SUBSCRIBER, topic)
    written = (
        f"in /viewer, subscribe to '{channel}' with plain_channel=True,"
        f" in C++ to plain_channel('{channel}')"
    )
    assert remedies(viewer, traffic=(sent,)) == (
        f"'{channel}' is published, by 10.0.0.1:4000: {written}",
    )
    pilot = node("/pilot", Role.PUBLISHER, channel)
    assert remedies(viewer, pilot) == (f"'{channel}' is published: {written}",)


@pytest.mark.parametrize(
    ("command", "is_told"),
    [
        ("python3 /bin/lcmtools run listener", False),
        ("/bin/lcmtools run --domain 1 image_view", False),
        ("lcmtools run mine", True),
        ("lcmtools run simple_controller", True),
        ("python listener", True),
    ],
)
def test_only_a_node_of_users_is_told_how_to_receive_from_a_plain_channel(command, is_told):
    sent = Traffic("POSE", Sender("10.0.0.1", 4000), TWIST, 10, 10, 1, 2)
    viewer = node("/viewer", Role.SUBSCRIBER, "/POSE")._replace(command=command)
    (remedy,) = remedies(viewer, traffic=(sent,))
    assert ("plain_channel" in remedy, "let it publish on '/POSE'" in remedy) == (
        is_told,
        not is_told,
    )


def test_a_simulator_is_not_told_to_receive_from_a_plain_channel():
    sent = Traffic("cmd_vel", Sender("10.0.0.1", 4000), TWIST, 10, 10, 1, 2)
    command = Endpoint("/cmd_vel", Role.SUBSCRIBER, ("geometry_msgs/Twist",), TWIST)
    (remedy,) = remedies(simulator("/morse", command), traffic=(sent,))
    assert remedy.endswith(": let it publish on '/cmd_vel'")


def test_another_type_in_another_namespace_is_named_with_both_types():
    counter = Endpoint("/robot/cmd_vel", Role.PUBLISHER, ("std_msgs/Int32",), (5,))
    publisher = Node("/a", "a", "here", 1, endpoints=(counter,))
    assert remedies(publisher, node("/driver", Role.SUBSCRIBER, "/cmd_vel")) == (
        (
            "/a publishes /robot/cmd_vel, but as std_msgs/Int32, and /driver expects"
            " geometry_msgs/Twist"
        ),
    )


def test_a_slash_at_the_start_that_leaves_the_namespace_is_removed():
    robot = node("/morse", Role.PUBLISHER, "/husky0/odometry")
    controller = node("/husky0/controller", Role.SUBSCRIBER, "/odometry")
    assert remedies(robot, controller) == (
        (
            "/husky0/odometry is published: let /husky0/controller use 'odometry' in place of"
            " '/odometry': the slash at its start keeps it out of the namespace /husky0"
        ),
    )
    output = node("/husky0/controller", Role.PUBLISHER, "/velocity_cmd")
    assert remedies(output, node("/morse", Role.SUBSCRIBER, "/husky0/velocity_cmd")) == (
        (
            "/husky0/controller publishes /velocity_cmd: let /husky0/controller use 'velocity_cmd'"
            " in place of '/velocity_cmd': the slash at its start keeps it out of the namespace"
            " /husky0"
        ),
    )
    command = "run controller __ns:=/husky0 controlled_velocity:=velocity_cmd"
    output = node("/husky0/controller", Role.PUBLISHER, "/controlled_velocity", command)
    assert remedies(output, node("/morse", Role.SUBSCRIBER, "/husky0/velocity_cmd")) == (
        (
            "/husky0/controller publishes /controlled_velocity: let /husky0/controller use"
            " 'controlled_velocity' in place of '/controlled_velocity': the slash at its start"
            " keeps controlled_velocity:=velocity_cmd from being applied"
        ),
    )
    mapped = controller._replace(command="run controller __ns:=/husky0 odometry:=/odometry")
    assert remedies(robot, mapped) == (
        "/husky0/odometry is published: start /husky0/controller without odometry:=/odometry",
    )


def test_a_node_with_another_topic_connected_is_in_the_right_namespace():
    robot = node("/husky0/robot", Role.PUBLISHER, "/husky0/odometry")
    pilot = node("/husky/pilot", Role.PUBLISHER, "/husky/desired_velocity")
    controller = node("/husky0/controller", Role.SUBSCRIBER, "/husky0/desired_velocity")
    odometry = controller.endpoints[0]._replace(topic="/husky0/odometry")
    controller = controller._replace(endpoints=(*controller.endpoints, odometry))
    assert said_of(robot, pilot, controller)["unconnected-subscriptions"].remedies == (
        "/husky/pilot publishes /husky/desired_velocity: start /husky/pilot with __ns:=/husky0",
    )


def test_of_several_namespaces_each_is_offered():
    robots = [node(f"/r{n}/wheels", Role.PUBLISHER, f"/r{n}/speed") for n in range(3)]
    found = said_of(*robots, node("/filter", Role.SUBSCRIBER, "/speed"))
    assert found["unconnected-subscriptions"].remedies == (
        "/r0/speed is published: start /filter with __ns:=/r0 (or __ns:=/r1, __ns:=/r2)",
    )


def test_a_second_publisher_with_a_slip_is_led_to_the_subscriber():
    other = node("/other", Role.PUBLISHER, "/speedd", "run other speed:=/speedd")
    pair = (node("/first", Role.PUBLISHER, "/speed"), node("/ear", Role.SUBSCRIBER, "/speed"))
    assert said_of(other, *pair)["unconnected-publications"].remedies == (
        "/ear subscribes to /speed: start /other without speed:=/speedd",
    )


def test_a_publication_whose_subscriber_was_killed_is_not_reported_twice():
    killed = node("/ear", Role.SUBSCRIBER, "/speed")._replace(stale=Staleness.ENDED)
    killed = killed._replace(endpoints=())
    talker = node("/talker", Role.PUBLISHER, "/speed")
    assert list(said_of(talker, killed, stale_subscribed=frozenset({"/speed"}))) == ["stale-nodes"]


def test_who_publishes_where_a_node_is_moved_to_is_left_alone():
    robot = node("/morse", Role.PUBLISHER, "/husky0/odometry")
    command = node("/_pub", Role.PUBLISHER, "/husky0/wish")._replace(tool=True)
    controller = node("/husky/controller", Role.SUBSCRIBER, "/husky/odometry")
    wish = controller.endpoints[0]._replace(topic="/husky/wish")
    controller = controller._replace(endpoints=(*controller.endpoints, wish))
    assert said_of(robot, command, controller)["unconnected-subscriptions"].remedies == (
        "/husky0/odometry is published: start /husky/controller with __ns:=/husky0",
    )
