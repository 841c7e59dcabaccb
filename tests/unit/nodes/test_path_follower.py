"""The node that follows a path, with a robot that does exactly what it commands. Metres."""

import math

import pytest

from lcmtools.labs.nodes.path_follower import PathFollower, Pursuit
from lcmtools.types.geometry_msgs import PoseStamped, Twist
from lcmtools.types.nav_msgs import Odometry, Path

ANGLES = [math.tau * n / 100 for n in range(101)]
CIRCLE = [(2 * math.sin(angle), 2 - 2 * math.cos(angle)) for angle in ANGLES]


def path_of(points):
    message = Path()
    for point in points:
        pose = PoseStamped()
        pose.pose.position.x, pose.pose.position.y = point
        message.poses.append(pose)
    return message


def at(x, y, heading=0.0):
    message = Odometry()
    pose = message.pose.pose
    pose.position.x, pose.position.y = x, y
    pose.orientation.z, pose.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
    return message


def test_a_robot_stays_on_a_closed_path_and_comes_to_its_end():
    pursuit = Pursuit(CIRCLE)
    x, y, heading = 0.0, 0.1, 0.3  # beside the path
    strays, step = [], 0.01
    for _ in range(2000):
        pursuit.advance((x, y))
        if pursuit.is_over:
            break
        heading += step * pursuit.curvature((x, y), heading)
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
        strays.append(abs(math.dist((x, y), (0, 2)) - 2))

    assert pursuit.is_over
    assert len(strays) * step > 0.95 * 2 * math.tau
    assert max(strays[100:]) < 0.03


@pytest.mark.parametrize("piece", [0.5, 1.0, 4.0])
def test_a_robot_follows_long_pieces(piece):
    pursuit = Pursuit([(piece * n, 0.0) for n in range(round(8 / piece) + 1)])
    x, y, heading, step = 0.0, 0.1, 0.0, 0.01
    strays = []
    while not pursuit.is_over and len(strays) < 900:
        heading += step * pursuit.curvature((x, y), heading)
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
        pursuit.advance((x, y))
        strays.append(abs(y))

    assert pursuit.is_over
    assert x == pytest.approx(8.0, abs=0.5)
    assert max(strays) <= 0.1


def test_it_drives_with_each_pose_and_stops_at_the_end(bench):
    bench.start(PathFollower)
    bench.publish("/ground_truth", at(0, 0))
    assert bench.published("/RosAria/cmd_vel", Twist) == []

    bench.publish("/path", path_of([(0, 0), (0.3, 0), (0.6, 0)]))
    bench.publish("/ground_truth", at(0, 0), at(0, 0, -1), at(0.6, 0), at(0.6, 0))

    sent = bench.published("/RosAria/cmd_vel", Twist)
    assert [twist.linear.x for twist in sent] == [0.4, 0.4, 0.0]
    assert sent[0].angular.z == 0
    assert sent[1].angular.z > 0.5
    assert sent[2].angular.z == 0


def test_a_path_without_poses_and_one_that_is_repeated_change_nothing(bench):
    bench.start(PathFollower)
    path = path_of([(0, 0), (0.3, 0), (0.6, 0)])
    bench.publish("/path", Path(), path)
    bench.publish("/ground_truth", at(0.6, 0))
    bench.publish("/path", path)
    bench.publish("/ground_truth", at(0, 0))

    assert [t.linear.x for t in bench.published("/RosAria/cmd_vel", Twist)] == [0.0]
