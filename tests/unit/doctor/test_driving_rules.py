"""A robot that drives by the command of a program that has ended."""

from dataclasses import replace

import pytest
from fixtures.judging import judge
from fixtures.says import assert_says

from lcmtools.doctor.content import oddities
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness
from lcmtools.observe.actuators import unattended_commands
from lcmtools.types.nav_msgs import Odometry
from tests.unit.doctor.test_every_rule import (
    COMMANDED,
    EVEN,
    EVIDENCE,
    NOW,
    ROBOT,
    SECOND,
)

DRIVEN = EVIDENCE["driven-by-nobody"]
DRIVER = Node(
    *("/driver", "d", "here", 11),
    endpoints=(Endpoint("/r/cmd_vel", Role.PUBLISHER, ("geometry_msgs/Twist",)),),
)


def with_robot(**values):
    """The findings if the command's subscription is another one."""
    end = COMMANDED._replace(**values)
    robot = ROBOT._replace(endpoints=(end, *ROBOT.endpoints[1:]))
    nodes = (*DRIVEN.graph.nodes[:2], robot)
    return [one.rule for one in judge(replace(DRIVEN, graph=Graph(nodes, time=NOW)))]


def test_the_robot_its_speed_and_the_line_that_stops_it_are_named():
    (found,) = judge(DRIVEN)
    (fact,) = found.items
    assert_says(fact, "/robot drives at 0.50 m/s", "by /r/cmd_vel", "5 s ago")
    assert found.remedies == ("publish zeros: lcmtools pub -1 /r/cmd_vel geometry_msgs/Twist",)


@pytest.mark.parametrize(
    "values",
    [
        {"messages": 0},  # it drives by itself, or is pushed
        {"last_time": NOW - SECOND // 2},  # a robot with a timeout still rolls
        {"topic": "/other/cmd_vel"},  # of another robot
        {"types": ("geometry_msgs/PoseStamped",)},  # it drives to a goal
    ],
)
def test_a_robot_that_nobody_left_driving_is_not_named(values):
    assert "driven-by-nobody" not in with_robot(**values)


def test_a_robot_that_stands_or_is_commanded_is_not_named():
    assert judge(replace(DRIVEN, oddities=())) == []
    plain = replace(EVEN, channel="/r/cmd_vel")
    assert "driven-by-nobody" not in [one.rule for one in judge(replace(DRIVEN, streams=(plain,)))]


@pytest.mark.parametrize(
    ("driver", "count"), [(DRIVER, 0), (DRIVER._replace(stale=Staleness.ENDED), 1)]
)
def test_a_killed_driver_no_longer_commands(driver, count):
    assert len([*unattended_commands(Graph((ROBOT, driver)))]) == count


@pytest.mark.parametrize(("speed", "turn", "count"), [(0.5, 0, 1), (0, -0.3, 1), (0.01, 0.01, 0)])
def test_odometry_tells_that_a_robot_drives(speed, turn, count):
    message = Odometry()
    message.twist.twist.linear.y, message.twist.twist.angular.z = speed, turn
    assert len([kind for kind, _ in oddities(message) if kind == "drives"]) == count
