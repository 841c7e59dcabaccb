"""Paths of a world: the curve, its message and its marks in pictures. Metres."""

import math
from itertools import pairwise

import numpy as np
import pytest

from lcmtools.errors import InvalidFile
from lcmtools_sim.scene import MarkedPath
from lcmtools_sim.session import path_message
from lcmtools_sim.shapes import Line
from lcmtools_sim.vision.camera import Camera
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.render import render
from lcmtools_sim.vision.solids import solids_of
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

BLUE = (0.0, 0.0, 1.0)
DOWN = (1.0, 0.0, 0.0, 0.0)


def read_path(text):
    (path,) = read_scene(f"paths:\n  - {text}\n", "w.yaml").paths
    return path


def test_a_curve_leads_through_all_points_without_corners():
    path = read_path("{points: [[0, 0], [2, 0], [2, 2], [0, 2]], closed: true}")
    points = path.line.points
    assert path.topic == "/path"
    assert points[0] == points[-1] == (0, 0)
    assert all(any(math.dist(p, corner) < 1e-9 for p in points) for corner in [(2, 0), (2, 2)])
    assert all(math.dist(a, b) < 0.13 for a, b in pairwise(points))
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    turns = [math.remainder(b - a, math.tau) for a, b in pairwise(headings)]
    assert max(map(abs, turns)) < math.radians(20)


def test_two_points_are_a_straight_line():
    path = read_path("{points: [[0, 1], [1, 1]], topic: way, width: 0.1, color: [1, 0, 0]}")
    assert path.topic == "/way"
    assert [x for x, _ in path.line.points] == pytest.approx([x / 10 for x in range(11)])
    assert [y for _, y in path.line.points] == pytest.approx([1] * 11)
    assert (path.line.width, path.line.color) == (0.1, (1, 0, 0))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{points: [[0, 0]]}", "w.yaml:2: 'points' must have at least 2 elements"),
        ("{points: [[0, 0], [0, 0]]}", "w.yaml:2: two points in succession are the same"),
        ("{points: [[0, 0], [1, 0]], topic: a b}", "w.yaml:2: "),
        ("{corners: [[0, 0], [1, 0]]}", "w.yaml:2: unknown key 'corners' in 'paths[0]'"),
        (
            "{points: [[0, 0], [1, 0]]}\n  - {points: [[0, 0], [1, 0]]}",
            "w.yaml:3: two paths have the topic '/path'",
        ),
    ],
)
def test_a_path_that_is_none_is_refused(text, reason):
    with pytest.raises(InvalidFile) as error:
        read_path(text)
    assert str(error.value).startswith(reason)


def test_the_message_has_a_pose_at_each_point_that_looks_along_the_path():
    points = ((0.0, 0.0), (0.0, 1.0), (0.0, 2.0))
    message = path_message(MarkedPath("/path", Line(points, 0.05, BLUE)))
    assert message.header.frame_id == "world"
    assert [(p.pose.position.x, p.pose.position.y) for p in message.poses] == list(points)
    for pose in message.poses:
        turn = pose.pose.orientation
        assert (turn.z, turn.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))


def test_a_line_is_seen_on_the_ground_and_hidden_by_nothing_else():
    line = Line(((-5.0, 0.0), (5.0, 0.0)), 0.2, BLUE)
    solids = solids_of([], (0.5, 0.5, 0.5), (line,))
    camera = Camera(100, 100, math.radians(90))
    picture = color_image(render(solids, camera, (0.0, 0.0, 1.0), DOWN)).astype(int)
    is_blue = picture[:, :, 2] > picture[:, :, 0] + 100
    rows = np.flatnonzero(is_blue.any(axis=1))
    assert is_blue[rows].all()
    # 2 m are 100 rows.
    assert len(rows) == pytest.approx(10, abs=1)
    assert rows.mean() == pytest.approx(49.5, abs=0.6)


def test_the_pioneers_path_begins_at_the_robot_and_can_be_driven():
    scene = read_scene(*find_world("pioneer"))
    (path,), (robot,) = scene.paths, scene.robots
    points = np.array(path.line.points)
    steps = np.diff(points, axis=0)
    headings = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    assert path.line.points[0] == (robot.pose.x, robot.pose.y)
    curvature = np.abs(np.diff(headings)) / np.linalg.norm(steps, axis=1)[1:]
    assert 1 / curvature.max() > 0.4
    assert 10 < np.linalg.norm(steps, axis=1).sum() < 16
