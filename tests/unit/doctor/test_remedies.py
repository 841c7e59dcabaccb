"""The flag that connects what is not connected."""

import pytest

from lcmtools.doctor.model import Evidence
from lcmtools.doctor.near_names import are_near
from lcmtools.doctor.rules import examine
from lcmtools.graph.model import Endpoint, Graph, Node, Role

TWIST = (0x2E7C07D7CDF7E027,)


def node(name: str, role: Role, topic: str, command: str = "") -> Node:
    end = Endpoint(topic, role, ("geometry_msgs/Twist",), TWIST)
    return Node(name, name, "here", 1, command=command, endpoints=(end,))


def remedies(publisher: Node, subscriber: Node) -> tuple[str, ...]:
    evidence = Evidence("udpm://", graph=Graph((publisher, subscriber)))
    found = {finding.rule: finding for finding in examine(evidence)}
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
            "nobody hears /speed of the same type: start /pilot with speed:=cmd_vel"
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
    rules = [finding.rule for finding in examine(Evidence("udpm://", graph=graph))]
    assert "unconnected-publications" not in rules
