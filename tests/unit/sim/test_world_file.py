"""World files: what is right becomes a scene, what is wrong is said with file, line and reason."""

import math

import pytest

from lcmtools.errors import InvalidFile
from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import Ground, RobotPlacement, Scene, box
from lcmtools_sim.shapes import Cuboid
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

# What is wrong, in which line, with which words.
MISTAKES = {
    "": "yard.yaml:1: the file is empty",
    "- a\n- b\n": "yard.yaml:1: 'world' must be a mapping (key: value), not a list",
    "robots: [": "yard.yaml:1: not YAML: a bracket is not closed",
    "node: a\n\tseed: 1": "yard.yaml:2: not YAML: a tab cannot indent; indent with spaces",
    "node: \x07": "yard.yaml:1: not YAML: the character U+0007 is not allowed",
    "a: " + "[" * 5000: "yard.yaml:1: not YAML: nested more than 100 levels deep",
    "gravety: 9.81": "yard.yaml:1: unknown key 'gravety' in 'world'; did you mean gravity?",
    "\nfoo: 1": (
        "yard.yaml:2: unknown key 'foo' in 'world';"
        " known keys: node, seed, dt, gravity, ground, objects, robots, paths"
    ),
    "seed: 1\n\nseed: 2": ("yard.yaml:3: not YAML: 'seed' is given twice; leave one of them out"),
    "objects: [&a {type: sphere, radius: 1, pose: [0, 0, 0]}, {<<: *a}]": (
        "yard.yaml:1: not YAML: '<<' cannot merge other keys here; write them out"
    ),
    "? [a]\n: 1": (
        "yard.yaml:1: not YAML: a key must be a word; put text that begins with '{{' in quotes"
    ),
    "node:": "yard.yaml:1: 'node' has no value",
    'node: "\\e[0m"': "yard.yaml:1: 'node' has characters that cannot be shown",
    "seed: one\n  two": "yard.yaml:1: 'seed' must be a whole number, not 'one two'",
    "node: [a]": "yard.yaml:1: 'node' must be one word or number, not a list",
    "seed: 1.5": "yard.yaml:1: 'seed' must be a whole number, not '1.5'",
    "seed: -1": "yard.yaml:1: 'seed' must be between 0 and 9.22337e+18, not -1",
    f"seed: {10**400}": f"yard.yaml:1: 'seed' must be between 0 and 9.22337e+18, not {10**400}",
    "dt: fast": "yard.yaml:1: 'dt' must be a number, not 'fast'",
    "dt: 1/0": "yard.yaml:1: 'dt' must be a number, not '1/0'",
    "dt: 0": "yard.yaml:1: 'dt' must be between 0.0001 and 0.02, not 0",
    "gravity: .nan": "yard.yaml:1: 'gravity' must be a number, not '.nan'",
    "gravity: nan": "yard.yaml:1: 'gravity' must be between 0 and 100, not nan",
    "gravity: inf": "yard.yaml:1: 'gravity' must be between 0 and 100, not inf",
    "gravity: true": "yard.yaml:1: 'gravity' must be a number, not 'true'",
    "ground: {friction: -1}": "yard.yaml:1: 'friction' must be between 0 and 10, not -1",
    "ground: ice": ("yard.yaml:1: 'ground' must be a mapping (key: value), not a single value"),
    "objects: {}": "yard.yaml:1: 'objects' must be a list, not a mapping",
    "objects:\n- {size: [1, 1, 1]}": "yard.yaml:2: 'objects[0]' lacks the key 'type'",
    "objects:\n- {type: bax}": "yard.yaml:2: unknown type 'bax'; did you mean box?",
    "objects:\n- {type: cone}": (
        "yard.yaml:2: unknown type 'cone'; known types: box, cylinder, sphere, table, walls, sdf"
    ),
    "objects:\n- {type: box, pose: [0, 0, 0]}": "yard.yaml:2: 'objects[0]' lacks the key 'size'",
    "objects:\n- {type: box, mas: 2}": (
        "yard.yaml:2: unknown key 'mas' in 'objects[0]'; did you mean mass?"
    ),
    "objects:\n- {type: box, height: 2}": (
        "yard.yaml:2: unknown key 'height' in 'objects[0]';"
        " known keys: type, name, pose, mass, friction, color, size"
    ),
    "objects:\n- type: box\n  size: [1, 1]\n  pose: [0, 0, 0]": (
        "yard.yaml:3: 'size' must have 3 elements, not 2"
    ),
    "objects:\n- type: box\n  size: [1, 0, 1]\n  pose: [0, 0, 0]": (
        "yard.yaml:3: 'size[1]' must be between 0.001 and 10000, not 0"
    ),
    "objects:\n- type: box\n  size: [1, 1, 1]\n  pose: [0, 0]": (
        "yard.yaml:4: 'pose' must have 3 or 6 elements, not 2"
    ),
    "objects:\n- type: box\n  size: [1, 1, 1]\n  pose: [0, 0, up]": (
        "yard.yaml:4: 'pose[2]' must be a number, not 'up'"
    ),
    "objects:\n- type: box\n  size: [1, 1, 1]\n  pose: [0, 0, x deg]": (
        "yard.yaml:4: 'pose[2]' must be an angle, not 'x deg'"
    ),
    "objects:\n- {type: walls, points: [[0, 0]]}": (
        "yard.yaml:2: 'points' must have at least 2 elements"
    ),
    "objects:\n- type: walls\n  points:\n  - [1, 2]\n  - [1, 2]": (
        "yard.yaml:5: 'points[1]' is the same point as 'points[0]'"
    ),
    "objects:\n- {type: walls, points: [[0, 0], [1, 0]], closed: maybe}": (
        "yard.yaml:2: 'closed' must be true or false, not 'maybe'"
    ),
    "robots:\n- {model: husky}": "yard.yaml:2: 'robots[0]' lacks the key 'namespace'",
    "robots:\n- {model: husk, namespace: a}": (
        "yard.yaml:2: unknown model 'husk'; did you mean husky?"
    ),
    "robots:\n- {model: r2d2, namespace: a}": (
        "yard.yaml:2: unknown model 'r2d2'; known models: husky, pioneer, dolly"
    ),
    "robots:\n- {model: husky, namespace: a}\n- {model: husky, namespace: /a}": (
        "yard.yaml:3: two robots have the namespace '/a'"
    ),
    "robots:\n- model: husky\n  namespace: a\n  cmd_timeout: 0": (
        "yard.yaml:4: 'cmd_timeout' must be between 0.001 and 100000, not 0"
    ),
}


# What a Husky's entry says, in line 4, and what comes back.
HUSKY_MISTAKES = {
    "sensors: {type: laser}": "'sensors' must be a list, not a mapping",
    "sensors: [{}]": "'sensors[0]' lacks the key 'type'",
    "sensors: [{type: lazer}]": "unknown sensor 'lazer'; did you mean laser?",
    "sensors: [{type: laser, rays: 1}]": "'rays' must be between 2 and 20000, not 1",
    "sensors: [{type: laser, rays: 10.5}]": "'rays' must be a whole number, not '10.5'",
    "sensors: [{type: laser, rate: 0}]": "'rate' must be between 0.001 and 10000, not 0",
    "sensors: [{type: laser, rate: nan}]": "'rate' must be between 0.001 and 10000, not nan",
    "sensors: [{type: laser, noise: -1}]": "'noise' must be between 0 and 1000, not -1",
    "sensors: [{type: laser, longest: inf}]": "'longest' must be between 0.01 and 1000, not inf",
    "sensors: [{type: laser, first_angle: 400 deg}]": (
        "'first_angle' must be between -6.28319 and 6.28319, not 6.98132"
    ),
    "sensors: [{type: laser, angle: 1}]": (
        "unknown key 'angle' in 'sensors[0]'; did you mean first_angle or last_angle?"
    ),
    "sensors: [{type: laser, shortest: 5, longest: 2}]": (
        "'shortest' (5) must be less than 'longest' (2)"
    ),
    "sensors: [{type: laser, shortest: 50}]": "'shortest' (50) must be less than 'longest' (10)",
    "sensors: [{type: depth_camera, near: 9}]": "'near' (9) must be less than 'far' (8)",
    "sensors: [{type: depth_camera, width: 0}]": "'width' must be between 1 and 4096, not 0",
    "sensors: [{type: laser}, {type: laser}]": (
        "two sensors have the topic 'scan'; give one another topic"
    ),
    "sensors: [{type: laser, topic: b}, {type: imu, topic: b}]": (
        "two sensors have the topic 'b'; give one another topic"
    ),
    "sensors: [{type: laser, topic: cmd_vel}]": (
        "the topic '/a/cmd_vel' is used twice; give one another name"
    ),
    "sensors: [{type: laser, topic: " + "x" * 70 + "}]": (
        "'/a/" + "x" * 70 + "' (from '" + "x" * 70 + "') has 73 bytes and LCM channels have at most"
        " 63; use a shorter name or namespace"
    ),
    "sensors: [{type: laser, pose: [0, 0]}]": "'pose' must have 3 or 6 elements, not 2",
    "sensors: [{type: laser, always: 1}]": "'always' must be true or false, not '1'",
    "sensors: [{type: laser, frame: a b}]": (
        "'a b' is not a legal name; names are made of letters, digits, '_' and '/', and start with"
        " a letter, '/' or '~'"
    ),
    "sensors: [{type: laser, topic: b, frame: f}, {type: camera, topic: c, frame: f}]": (
        "the frame 'f' is that of 'b' too, which sits elsewhere; give one another frame"
    ),
    "skid: coulom": "unknown skid 'coulom'; did you mean coulomb?",
    "gazebo_quirks: true": "a husky has no quirks in Gazebo",
    "gazebo_quirks: yes": "'gazebo_quirks' must be true or false, not 'yes'",
    "topics: [a]": "'topics' must be a mapping (key: value), not a list",
    "topics: {odometri: odom}": "unknown key 'odometri' in 'topics'; did you mean odometry?",
    "topics: {odometry: imu}": "the topic '/a/imu' is used twice; give one another name",
    "topics: {odometry: ''}": "'odometry' has no value",
    "topics: {odometry: a-b}": (
        "'a-b' is not a legal name; names are made of letters, digits, '_' and '/', and start with"
        " a letter, '/' or '~'"
    ),
    "commands: cmd_vel": "'commands' must be a list, not a single value",
    "commands: []": "'commands' is empty: nothing could steer the robot",
    "commands: [a, a]": "'a' is given twice in 'commands'",
    "commands: [odometry]": "the topic '/a/odometry' is used twice; give one another name",
    "drive: {left: [a], right: [b]}": (
        "a husky has a drive already; 'drive' is for a model from a URDF file"
    ),
}
MISTAKES |= {
    f"robots:\n- model: husky\n  namespace: a\n  {entry}": f"yard.yaml:4: {message}"
    for entry, message in HUSKY_MISTAKES.items()
}
MISTAKES |= {
    "robots:\n- {model: pioneer, namespace: a, skid: coulomb}": (
        "yard.yaml:2: a pioneer has two wheels, which do not skid"
    ),
    "robots:\n- {model: ./none.urdf, namespace: a}": (
        "yard.yaml:2: cannot read none.urdf: No such file or directory"
    ),
    "objects:\n- {type: sdf, pose: [0, 0, 0]}": "yard.yaml:2: 'objects[0]' lacks the key 'file'",
    "objects:\n- {type: sdf, file: ./none.sdf}": (
        "yard.yaml:2: cannot read none.sdf: No such file or directory"
    ),
    "objects:\n- {type: sdf, file: a.sdf, size: 3}": (
        "yard.yaml:2: unknown key 'size' in 'objects[0]'; known keys: type, file, pose"
    ),
    "objects:\n- {type: cylinder, radius: 0, height: 1, pose: [0, 0, 0]}": (
        "yard.yaml:2: 'radius' must be between 0.001 and 10000, not 0"
    ),
    "objects:\n- {type: cylinder, radius: 1, pose: [0, 0, 0]}": (
        "yard.yaml:2: 'objects[0]' lacks the key 'height'"
    ),
    "objects:\n- {type: sphere, radius: 1, height: 1, pose: [0, 0, 0]}": (
        "yard.yaml:2: unknown key 'height' in 'objects[0]';"
        " known keys: type, name, pose, mass, friction, color, radius"
    ),
    "objects:\n- {type: table, size: [0.05, 1, 1], pose: [0, 0, 0]}": (
        "yard.yaml:2: 'size' is too small for a table with legs of 0.05 m"
    ),
    "objects:\n- {type: table, size: [1, 1, 0.03], pose: [0, 0, 0]}": (
        "yard.yaml:2: 'size' is too small for a table with legs of 0.05 m"
    ),
    "objects:\n- {type: box, size: [1, 1, 1], pose: [0, 0, 0], color: red}": (
        "yard.yaml:2: 'color' must be a list, not a single value"
    ),
    "objects:\n- {type: walls, points: [[0, 0], [1, 0]], height: 0}": (
        "yard.yaml:2: 'height' must be between 0.01 and 1000, not 0"
    ),
}


@pytest.mark.parametrize(("text", "message"), MISTAKES.items(), ids=[t[-60:] for t in MISTAKES])
def test_a_mistake_is_said_with_file_line_and_reason(text, message):
    with pytest.raises(InvalidFile) as caught:
        read_scene(text, "yard.yaml")
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("text", "start"),
    [
        ("seed: 1\nnode: a b", "yard.yaml:2: 'a b' is not a legal node name; "),
        ("robots:\n- {model: husky, namespace: a b}", "yard.yaml:2: 'a b' is not a legal name; "),
        ("robots:\n- {model: husky, namespace: ~a}", "yard.yaml:2: '~a' is private"),
    ],
)
def test_an_illegal_name_is_said_with_its_rule(text, start):
    with pytest.raises(InvalidFile) as caught:
        read_scene(text, "yard.yaml")
    assert str(caught.value).startswith(start)


def test_a_file_that_says_nothing_has_the_defaults():
    assert read_scene("objects: []", "plain.yaml") == Scene(
        name="plain", node="sim", seed=0, dt=1 / 240, gravity=9.81, ground=Ground()
    )


def test_a_full_file_becomes_a_scene():
    text = """
node: morse
seed: 7
dt: 0.002
gravity: 3.7
ground: {friction: 0.5, color: [0, 0.5, 1]}
objects:
- {type: box, name: crate, size: [1, 2, 3], pose: [4, 5, 90 deg], mass: 1e1, friction: 0.2}
robots:
- {model: husky, namespace: husky0, pose: [1, 2, 3, 0.1, 0.2, 0.3], cmd_timeout: 0.5}
- {model: husky, namespace: /husky1, cmd_timeout: none}
"""
    assert read_scene(text, "worlds/mars.yaml") == Scene(
        name="mars",
        node="morse",
        seed=7,
        dt=0.002,
        gravity=3.7,
        ground=Ground(0.5, (0.0, 0.5, 1.0)),
        objects=(box("crate", (1, 2, 3), Pose(4, 5, 1.5, yaw=math.pi / 2), 10, 0.2),),
        robots=(
            RobotPlacement(HUSKY, "/husky0", Pose(1, 2, 3, 0.1, 0.2, 0.3), 0.5),
            RobotPlacement(HUSKY, "/husky1"),
        ),
    )


def test_a_closed_wall_has_a_piece_for_every_side_and_overlaps_at_the_corners():
    text = """
objects:
- {type: walls, points: [[0, 0], [4, 0], [4, 3]], closed: true, height: 2, thickness: 0.5}
"""
    pieces = read_scene(text, "w.yaml").objects
    shapes = [part.shape for piece in pieces for part in piece.parts]
    assert shapes == [Cuboid((4.5, 0.5, 2)), Cuboid((3.5, 0.5, 2)), Cuboid((5.5, 0.5, 2))]
    assert [(p.pose.x, p.pose.y, p.pose.z) for p in pieces] == [(2, 0, 1), (4, 1.5, 1), (2, 1.5, 1)]
    assert pieces[1].pose.yaw == pytest.approx(math.pi / 2)
    assert all(piece.mass == 0 for piece in pieces)


def test_an_alias_that_leads_back_to_itself_is_refused():
    with pytest.raises(InvalidFile, match=r"w.yaml:1: not YAML: unknown alias '\*all'"):
        read_scene("objects: &all [*all]", "w.yaml")


def test_the_comment_on_sensors_in_the_husky_world_is_right_when_it_counts():
    text, source = find_world("husky")
    sensors = [
        line for line in text.splitlines() if line.startswith(("    # sensors:", "    #   - "))
    ]
    topics = next(line for line in text.splitlines() if line.startswith("    # topics:"))
    counted = "\n".join(line.replace("    # ", "    ", 1) for line in [*sensors, topics])
    mounts = read_scene(f"{text}\n{counted}\n", source).robots[0].model.sensors
    assert len(sensors) == 6
    assert [(mount.kind, mount.topic) for mount in mounts] == [
        ("odometry", "odom"),
        ("ground_truth", "ground_truth"),
        ("imu", "imu"),
        ("transforms", "/tf"),
        ("laser", "scan"),
        ("camera", "camera"),
        ("bumper", "bumper"),
    ]
