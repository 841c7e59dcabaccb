"""The flag that connects what is not connected."""

from dataclasses import replace

import pytest
from fixtures.judging import Judged, judge

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.renaming import are_near
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness, Traffic
from lcmtools.wire.packet import Sender

TWIST = (0x2E7C07D7CDF7E027,)


def node(name: str, role: Role, topic: str, command: str = "") -> Node:
    end = Endpoint(topic, role, ("geometry_msgs/Twist",), TWIST)
    return Node(name, name, "here", 1, command=command, endpoints=(end,))


def remedies(publisher: Node, subscriber: Node) -> tuple[str, ...]:
    evidence = Evidence("udpm://", graph=Graph((publisher, subscriber)))
    found = {finding.rule: finding for finding in judge(evidence)}
    return found["unconnected-subscriptions"].remedies


def test_a_listener_in_the_wrong_namespace_is_moved() -> None:
    publisher = node("/robot/pilot", Role.PUBLISHER, "/robot/cmd_vel")
    subscriber = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    assert remedies(publisher, subscriber) == (
        "/robot/cmd_vel is published: start /driver with __ns:=/robot",
    )


def test_a_publisher_is_moved_where_the_listeners_topic_is_fixed() -> None:
    publisher = node("/pioneer0/teleop", Role.PUBLISHER, "/pioneer0/cmd_vel")
    simulator = node("/gazebo", Role.SUBSCRIBER, "/RosAria/cmd_vel")
    assert remedies(publisher, simulator) == (
        "/pioneer0/teleop publishes /pioneer0/cmd_vel: start /pioneer0/teleop with __ns:=/RosAria",
    )


def test_where_neither_can_be_moved_the_publisher_is_remapped() -> None:
    publisher = node("/pilot", Role.PUBLISHER, "/fixed/cmd_vel")
    simulator = node("/gazebo", Role.SUBSCRIBER, "/RosAria/cmd_vel")
    assert remedies(publisher, simulator) == (
        "/pilot publishes /fixed/cmd_vel: start /pilot with /fixed/cmd_vel:=/RosAria/cmd_vel",
    )


def test_a_name_with_a_slip_is_remapped() -> None:
    publisher = node("/pilot", Role.PUBLISHER, "/cmd_vel")
    subscriber = node("/driver", Role.SUBSCRIBER, "/cmdvel")
    assert remedies(publisher, subscriber) == (
        "/cmd_vel is published: start /driver with cmdvel:=/cmd_vel",
    )


def test_a_remap_with_a_slip_is_written_again() -> None:
    publisher = node("/pilot", Role.PUBLISHER, "/robot/cmd_vel")
    command = "lcmtools run driver speed:=/robot/cmd_ve"
    subscriber = node("/driver", Role.SUBSCRIBER, "/robot/cmd_ve", command)
    assert remedies(publisher, subscriber) == (
        (
            "/robot/cmd_vel is published: start /driver with speed:=/robot/cmd_vel"
            " in place of speed:=/robot/cmd_ve"
        ),
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
def test_names_that_are_near(one: str, other: str, near: bool) -> None:  # noqa: FBT001 - expected
    assert are_near(one, other) is near
    assert are_near(other, one) is near


def test_a_remap_the_wrong_way_round_is_turned() -> None:
    command = "lcmtools run pilot cmd_vel:=speed"
    publisher = node("/pilot", Role.PUBLISHER, "/speed", command)
    simulator = node("/gazebo", Role.SUBSCRIBER, "/cmd_vel")
    assert remedies(publisher, simulator) == (
        (
            "/speed of the same type has no subscriber: start /pilot with speed:=cmd_vel"
            " in place of cmd_vel:=speed"
        ),
    )


def test_a_remap_with_a_slip_that_only_repeats_the_name_is_left_out() -> None:
    publisher = node("/pilot", Role.PUBLISHER, "/cmd_vel")
    subscriber = node("/driver", Role.SUBSCRIBER, "/cmd_vell", "run driver cmd_vel:=/cmd_vell")
    assert remedies(publisher, subscriber) == (
        "/cmd_vel is published: start /driver without cmd_vel:=/cmd_vell",
    )


def test_what_a_remedy_connects_is_no_unconnected_publication() -> None:
    graph = Graph(
        (
            node("/robot/pilot", Role.PUBLISHER, "/robot/cmd_vel"),
            node("/driver", Role.SUBSCRIBER, "/cmd_vel"),
        )
    )
    rules = [finding.rule for finding in judge(Evidence("udpm://", graph=graph))]
    assert "unconnected-publications" not in rules


def simulator(name: str, *ends: Endpoint) -> Node:
    clock = Endpoint("/clock", Role.PUBLISHER, ("rosgraph_msgs/Clock",), (1,))
    return Node(name, name + ends[0].topic, "here", 1, endpoints=(clock, *ends))


def test_a_command_is_told_where_to_publish() -> None:
    publisher = replace(node("/_pub", Role.PUBLISHER, "/Husky0/cmd_vel"), tool=True)
    ear = node("/gazebo", Role.SUBSCRIBER, "/husky0/cmd_vel")
    assert remedies(publisher, ear) == (
        "/_pub publishes /Husky0/cmd_vel: let it publish on '/husky0/cmd_vel'",
    )
    publisher = replace(node("/_pub", Role.PUBLISHER, "/cmd_vel"), tool=True)
    assert remedies(publisher, ear) == (
        "/_pub publishes /cmd_vel: let it publish on '/husky0/cmd_vel'",
    )


def test_a_command_is_not_told_to_publish_something_else() -> None:
    publisher = replace(node("/_pub", Role.PUBLISHER, "/husky0/wish"), tool=True)
    assert remedies(publisher, node("/gazebo", Role.SUBSCRIBER, "/husky0/cmd_vel")) == (
        "start what publishes /husky0/cmd_vel; what is there: lcmtools list -v",
    )


def test_a_remap_that_leads_away_from_what_is_published_is_taken_back() -> None:
    publisher = node("/robot/wheels", Role.PUBLISHER, "/robot/odometry")
    command = "lcmtools run filter __ns:=/robot odometry:=speed"
    subscriber = node("/robot/filter", Role.SUBSCRIBER, "/robot/speed", command)
    assert remedies(publisher, subscriber) == (
        "/robot/odometry is published: start /robot/filter without odometry:=speed",
    )


def test_others_go_by_the_names_of_a_simulator() -> None:
    odometry = Endpoint("/robot/odometry", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    morse = simulator("/morse", odometry)
    assert remedies(morse, node("/robot/filter", Role.SUBSCRIBER, "/robot/odom")) == (
        "/robot/odometry is of the same type: start /robot/filter with odom:=odometry",
    )


def test_a_simulator_is_not_connected_with_another_one() -> None:
    speed = Endpoint("/robot/speed", Role.PUBLISHER, ("geometry_msgs/Twist",), TWIST)
    command = Endpoint("/robot/command", Role.SUBSCRIBER, ("geometry_msgs/Twist",), TWIST)
    assert remedies(simulator("/morse", speed), simulator("/morse", command)) == (
        "start what publishes /robot/command; what is there: lcmtools list -v",
    )


@pytest.mark.parametrize(
    ("channel", "remedy"),
    [
        ("/cmd_vel", "'/cmd_vel' is published, by sender: let it publish on '/husky0/cmd_vel'"),
        ("cmd_vel", "'cmd_vel' is published, by sender: let it publish on '/husky0/cmd_vel'"),
        (
            "/husky0/cmdvel",
            (
                "/husky0/cmdvel is published, by sender: let it publish on '/husky0/cmd_vel',"
                " or start /gazebo with /husky0/cmd_vel:=/husky0/cmdvel"
            ),
        ),
    ],
)
def test_a_program_that_is_no_node_is_told_where_to_publish(channel: str, remedy: str) -> None:
    sender = Sender("127.0.0.1", 4000)
    traffic = Traffic(channel, sender, TWIST, 5, 50, 1, 2)
    ear = node("/gazebo", Role.SUBSCRIBER, "/husky0/cmd_vel")
    streams = (Stream(channel, sender, "sender", (1, 2)),)
    evidence = Evidence("udpm://", graph=Graph((ear,), (traffic,)), streams=streams)
    found = {finding.rule: finding for finding in judge(evidence)}
    assert found["unconnected-subscriptions"].remedies == (remedy,)


def said_of(*nodes: Node, **evidence: object) -> dict[str, Judged]:
    found = Evidence("udpm://", graph=Graph(nodes), **evidence)  # type: ignore[arg-type]
    return {finding.rule: finding for finding in judge(found)}


def test_a_plain_program_in_a_namespace_moves_the_node_there() -> None:
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
def test_a_publisher_whose_remap_has_a_slip_is_named(slip: str) -> None:
    publisher = node("/pilot", Role.PUBLISHER, slip, f"lcmtools run pilot cmd_vel:={slip}")
    subscriber = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    assert remedies(publisher, subscriber) == (
        f"/pilot publishes {slip}: start /pilot without cmd_vel:={slip}",
    )


@pytest.mark.parametrize("channel", ["cmd_vel", "/cmd_vel "])
def test_a_plain_program_on_a_channel_that_no_node_can_have(channel: str) -> None:
    traffic = (Traffic(channel, Sender("127.0.0.1", 4000), TWIST, 5, 50, 1, 2),)
    driver = node("/driver", Role.SUBSCRIBER, "/cmd_vel")
    found = {one.rule: one for one in judge(Evidence("udpm://", graph=Graph((driver,), traffic)))}
    (remedy,) = found["unconnected-subscriptions"].remedies
    assert remedy.startswith(f"'{channel}' is published, by ")
    assert remedy.endswith(": let it publish on '/cmd_vel'")


def test_another_type_in_another_namespace_is_named_with_both_types() -> None:
    counter = Endpoint("/robot/cmd_vel", Role.PUBLISHER, ("std_msgs/Int32",), (5,))
    publisher = Node("/a", "a", "here", 1, endpoints=(counter,))
    assert remedies(publisher, node("/driver", Role.SUBSCRIBER, "/cmd_vel")) == (
        (
            "/a publishes /robot/cmd_vel, but as std_msgs/Int32, and /driver expects"
            " geometry_msgs/Twist"
        ),
    )


def test_a_slash_at_the_start_that_leaves_the_namespace_is_removed() -> None:
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
    mapped = replace(controller, command="run controller __ns:=/husky0 odometry:=/odometry")
    assert remedies(robot, mapped) == (
        "/husky0/odometry is published: start /husky0/controller without odometry:=/odometry",
    )


def test_a_command_in_a_namespace_that_is_mistyped_is_to_use_the_near_topic() -> None:
    command = replace(node("/_pub", Role.PUBLISHER, "/husky/desired_velocity"), tool=True)
    controller = node("/husky0/controller", Role.SUBSCRIBER, "/husky0/desired_velocity")
    assert remedies(command, controller) == (
        "/_pub publishes /husky/desired_velocity: let it publish on '/husky0/desired_velocity'",
    )


def test_a_node_with_another_topic_connected_is_in_the_right_namespace() -> None:
    robot = node("/husky0/robot", Role.PUBLISHER, "/husky0/odometry")
    pilot = node("/husky/pilot", Role.PUBLISHER, "/husky/desired_velocity")
    controller = node("/husky0/controller", Role.SUBSCRIBER, "/husky0/desired_velocity")
    odometry = replace(controller.endpoints[0], topic="/husky0/odometry")
    controller = replace(controller, endpoints=(*controller.endpoints, odometry))
    assert said_of(robot, pilot, controller)["unconnected-subscriptions"].remedies == (
        "/husky/pilot publishes /husky/desired_velocity: start /husky/pilot with __ns:=/husky0",
    )


def test_of_several_namespaces_each_is_offered() -> None:
    robots = [node(f"/r{n}/wheels", Role.PUBLISHER, f"/r{n}/speed") for n in range(3)]
    found = said_of(*robots, node("/filter", Role.SUBSCRIBER, "/speed"))
    assert found["unconnected-subscriptions"].remedies == (
        "/r0/speed is published: start /filter with __ns:=/r0 (or __ns:=/r1, __ns:=/r2)",
    )


def test_a_second_publisher_with_a_slip_is_led_to_the_subscriber() -> None:
    other = node("/other", Role.PUBLISHER, "/speedd", "run other speed:=/speedd")
    pair = (node("/first", Role.PUBLISHER, "/speed"), node("/ear", Role.SUBSCRIBER, "/speed"))
    assert said_of(other, *pair)["unconnected-publications"].remedies == (
        "/ear subscribes to /speed: start /other without speed:=/speedd",
    )


def test_a_publication_whose_subscriber_was_killed_is_not_reported_twice() -> None:
    killed = replace(node("/ear", Role.SUBSCRIBER, "/speed"), stale=Staleness.ENDED)
    killed = replace(killed, endpoints=())
    talker = node("/talker", Role.PUBLISHER, "/speed")
    assert list(said_of(talker, killed, stale_subscribed=frozenset({"/speed"}))) == ["stale-nodes"]


def test_who_publishes_where_a_node_is_moved_to_is_left_alone() -> None:
    robot = node("/morse", Role.PUBLISHER, "/husky0/odometry")
    command = replace(node("/_pub", Role.PUBLISHER, "/husky0/wish"), tool=True)
    controller = node("/husky/controller", Role.SUBSCRIBER, "/husky/odometry")
    wish = replace(controller.endpoints[0], topic="/husky/wish")
    controller = replace(controller, endpoints=(*controller.endpoints, wish))
    assert said_of(robot, command, controller)["unconnected-subscriptions"].remedies == (
        "/husky0/odometry is published: start /husky/controller with __ns:=/husky0",
    )
