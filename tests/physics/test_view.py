"""The world for viewers: its markers, and the true frames of its bodies. Metres."""

import math
from dataclasses import replace

import pytest

from lcmtools.messages.codec import encode
from lcmtools.types.visualization_msgs import Marker
from lcmtools_sim.geometry import Frame, Pose, rotate, yaw_of
from lcmtools_sim.robots import DOLLY, HUSKY, MODELS, PIONEER
from lcmtools_sim.scene import MarkedPath, RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.shapes import Cylinder, Line, Part, Sphere
from lcmtools_sim.view import Poses, world_markers

BALL = SceneObject("ball", (Part(Sphere(0.2), color=(1, 0, 0)),), Pose(3, 1, 0.2), mass=1)
POST = SceneObject("post", (Part(Cylinder(0.1, 1.5), (0, 0, 0.1)),), Pose(-3, 1, 0.65, yaw=1))
PATH = MarkedPath("/path", Line(((0, 0), (1, 0), (1, 1)), 0.05, (0, 0, 1)))


def markers(simulation, name):
    message = world_markers(simulation.scene, simulation.robots, simulation.objects)
    encode(message)
    return [marker for marker in message.markers if marker.ns == name]


def frames(simulation):
    """Each frame's parent and its pose there, as they are published."""
    poses = Poses(simulation.robots, simulation.objects)
    message = poses.message(simulation.time, poses.frames())
    encode(message)
    found = {}
    for one in message.transforms:
        place, turn = one.transform.translation, one.transform.rotation
        frame = Frame((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
        found[one.child_frame_id] = one.header.frame_id, frame
    return found


def triple(vector):
    return vector.x, vector.y, vector.z


def test_each_shape_is_a_marker_of_its_size_in_the_frame_of_its_body(simulate):
    crate = box("crate", (0.6, 0.5, 0.4), Pose(2, 3, 0.2), mass=5)
    simulation = simulate(scene=Scene("shapes", objects=(BALL, POST, crate), paths=(PATH,)))
    (ball,), (post,), (cube,) = (markers(simulation, name) for name in ("ball", "post", "crate"))
    assert (ball.type, triple(ball.scale)) == (Marker.SPHERE, (0.4, 0.4, 0.4))
    assert (ball.color.r, ball.color.g, ball.color.a) == (1, 0, 1)
    assert (ball.header.frame_id, triple(ball.pose.position)) == ("ground_truth/ball", (0, 0, 0.2))
    assert (cube.type, triple(cube.scale)) == (Marker.CUBE, (0.6, 0.5, 0.4))
    assert (post.type, triple(post.scale)) == (Marker.CYLINDER, (0.2, 0.2, 1.5))
    assert post.header.frame_id == "world"  # it cannot move
    assert triple(post.pose.position) == pytest.approx((-3, 1, 0.75))
    assert 2 * math.atan2(post.pose.orientation.z, post.pose.orientation.w) == pytest.approx(1)


def test_lines_lie_on_the_ground_and_the_ground_below_zero(simulate):
    simulation = simulate(scene=Scene("lines", paths=(PATH,)))
    (line,), (ground,) = markers(simulation, "/path"), markers(simulation, "ground")
    assert (line.type, line.scale.x, len(line.points)) == (Marker.LINE_STRIP, 0.05, 3)
    assert 0 < line.pose.position.z < 0.01
    assert triple(line.points[2]) == (1, 1, 0)
    assert ground.pose.position.z + ground.scale.z / 2 == pytest.approx(0)


def test_the_first_marker_removes_all_and_the_others_have_numbers_of_their_own(simulate):
    simulation = simulate()
    found = world_markers(simulation.scene, simulation.robots, ()).markers
    assert found[0].action == Marker.DELETEALL
    assert all(marker.action == Marker.ADD for marker in found[1:])
    assert len({marker.id for marker in found}) == len(found)


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
def test_a_robot_is_shown_about_where_sensors_and_the_engine_have_it(simulate, model):
    robots = (RobotPlacement(model, "/r"),)
    simulation = simulate(scene=Scene("robot", robots=robots))
    known = frames(simulation)
    shown = []
    for marker in markers(simulation, "/r"):
        parent, frame = known[marker.header.frame_id]
        while parent != "world":
            parent, above = known[parent]
            frame = above.place(frame)
        shown.append((frame.point(triple(marker.pose.position)), triple(marker.scale)))
    outline = simulation.robots[0].model.body.parts
    for axis in (0, 1):
        low = min(part.position[axis] - part.extent(axis) for part in outline) - 0.06
        high = max(part.position[axis] + part.extent(axis) for part in outline) + 0.06
        assert all(low < place[axis] < high for place, _ in shown)
    assert all(0 < place[2] < 0.7 for place, _ in shown)
    assert len(shown) > 20


def test_a_robot_without_a_look_shows_its_shapes(simulate):
    plain = replace(DOLLY, body=replace(DOLLY.body, look=type(DOLLY.body.look)()))
    simulation = simulate(scene=Scene("plain", robots=(RobotPlacement(plain, "/r"),)))
    assert len(markers(simulation, "/r")) == len(DOLLY.body.parts)


def test_frames_are_the_true_ones_and_wheels_turn(simulate, twist):
    simulation = simulate(BALL, pose=Pose(1, -1, yaw=0.5))
    (robot,) = simulation.robots
    robot.command(twist(0.5, 0.3))
    for _ in range(480):
        simulation.step()
    known, state = frames(simulation), robot.state(simulation.time)
    parent, base = known["ground_truth/husky0/base_footprint"]
    assert parent == "world"
    assert base.position[:2] == pytest.approx(state.position[:2], abs=1e-9)
    assert base.position[2] == pytest.approx(0, abs=1e-3)
    assert yaw_of(base.rotation) == pytest.approx(yaw_of(state.rotation))
    for number, wheel in enumerate(HUSKY.body.look.wheels):
        parent, frame = known[f"ground_truth/husky0/base_footprint/wheel{number}"]
        angle = state.wheel_angles[0 if wheel.centre[1] > 0 else 1]
        assert (parent, frame.position) == ("ground_truth/husky0/base_footprint", wheel.centre)
        top = rotate((0.0, 0.0, 1.0), frame.rotation)
        assert top == pytest.approx((math.sin(angle), 0, math.cos(angle)))
        assert angle > 1
    assert known["ground_truth/ball"][1].position == pytest.approx((3, 1, 0), abs=1e-3)


def test_odometry_begins_where_the_robot_was_put(simulate, twist):
    simulation = simulate(pose=Pose(1, -1, yaw=0.5))
    (robot,) = simulation.robots

    def estimated():
        """Where the odometry has base_link in the world."""
        x, y, _ = robot.state(simulation.time).odometry_pose
        parent, odometry = frames(simulation)["husky0/odom"]
        assert parent == "world"
        return odometry.point((x, y, 0.0))[:2]

    robot.command(twist(0.5, 0.3))
    for _ in range(480):
        simulation.step()
    assert estimated() == pytest.approx(robot.frame.position[:2], abs=0.02)
    simulation.place(robot, Pose(-3, 2, yaw=2))
    assert estimated() == pytest.approx((-3, 2))


def test_frames_of_a_robot_in_the_global_namespace_begin_with_no_slash(simulate):
    simulation = simulate(scene=Scene("global", robots=(RobotPlacement(PIONEER, "/"),)))
    assert {"ground_truth/base_footprint", "odom"} < frames(simulation).keys()


def test_objects_with_one_name_have_frames_of_their_own(simulate):
    crates = (box("crate", (1, 1, 1), Pose(3 * i, 0, 0.5), mass=5) for i in range(3))
    simulation = simulate(scene=Scene("crates", objects=tuple(crates)))
    known = frames(simulation)
    assert [known[f"ground_truth/crate{end}"][1].position[0] for end in ("", "_2", "_3")] == [
        pytest.approx(x) for x in (0, 3, 6)
    ]
