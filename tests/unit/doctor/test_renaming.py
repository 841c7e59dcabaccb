"""Names that may be misspellings of each other, and limits of what is suggested."""

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.renaming import are_near
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role


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


def _node(name, role, topic):
    end = Endpoint(topic, role, ("geometry_msgs/Twist",), (0x2E7C07D7CDF7E027,))
    return NodeInfo(name, name, "here", 1, endpoints=(end,))


def test_many_topics_that_may_be_meant_are_not_all_told_to_each_of_many_subscriptions():
    outputs = [_node(f"/out{i}", Role.PUBLISHER, f"/speed{i}") for i in range(100)]
    inputs = [_node(f"/in{i}", Role.SUBSCRIBER, f"/wish{i}") for i in range(3)]
    found = judge(Evidence("udpm://", graph=Graph((*outputs, *inputs))))
    assert len(found[0].remedies) == 3 * 20
