"""Coordinate frames: poses between any two, the tree, and the commands that show them."""

import json
import math

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.codec import encode
from lcmtools.observe.frames.frames import Frames, Transform, Trees
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet, Sender

_S = 10**9
_START = 1_795_384_180 * _S
_TURN = math.sqrt(0.5)  # of a quarter turn


def transform(parent, child, x=0.0, y=0.0, *, quarter=False, time=0):
    one = TransformStamped(child_frame_id=child)
    one.header.frame_id, one.header.stamp.sec = parent, time
    place, turn = one.transform.translation, one.transform.rotation
    place.x, place.y = x, y
    turn.z, turn.w = (_TURN, _TURN) if quarter else (0.0, 1.0)
    return one


def frames(*transforms):
    made = Frames()
    for time, one in enumerate(transforms):
        assert not made.add(one, "/tf", time * _S, None)
    return made


def test_a_pose_is_that_of_all_transforms_between_two_frames():
    made = frames(
        transform("odom", "base", 1.0, 2.0, quarter=True, time=9),
        transform("base", "laser", 0.5, time=8),
        transform("odom", "mark", 3.0, time=7),
    )
    pose, stamp = made.between("odom", "laser")
    assert pose.translation == pytest.approx((1.0, 2.5, 0.0))
    assert pose.angles == pytest.approx((0.0, 0.0, math.pi / 2))
    assert stamp == 8 * _S
    pose, _ = made.between("laser", "mark")
    assert pose.translation == pytest.approx((-2.5, -2.0, 0.0))
    assert pose.angles[2] == pytest.approx(-math.pi / 2)
    back, _ = made.between("mark", "laser")
    product = pose @ back
    assert product.translation == pytest.approx((0, 0, 0), abs=1e-9)
    pose, stamp = made.between("base", "base")
    assert pose.rotation == pytest.approx(Transform().rotation)
    assert stamp == 9 * _S


def test_what_cannot_be_computed_is_an_error_with_the_reason():
    made = frames(transform("map", "odom"), transform("a", "b"))
    with raises_saying(LcmtoolsError, "there is no frame odm", "did you mean odom"):
        made.between("map", "odm")
    with raises_saying(LcmtoolsError, "nothing connects odom, below map, with b, below a"):
        made.between("odom", "b")
    loop = frames(transform("b", "a"), transform("a", "b"))
    with raises_saying(LcmtoolsError, "is below itself"):
        loop.between("a", "b")
    assert [one.is_looped for one in loop.places()] == [True, True]


@pytest.mark.parametrize(
    ("parent", "child", "x", "w"),
    [("", "a", 0.0, 1.0), ("a", "a", 0.0, 1.0), ("a", "b", math.nan, 1.0), ("a", "b", 0.0, 0.0)],
)
def test_an_odd_transform_is_ignored_with_the_reason(parent, child, x, w):
    one = transform(parent, child, x)
    one.transform.rotation.w = w
    made = Frames()
    assert_says(made.add(one, "/tf", 0, None), f"of '{child}' in '{parent}' on /tf is ignored: it ")
    assert not made.names()


def test_namespaces_have_trees_of_their_own():
    trees = Trees()
    for name in ("/a", "/b"):
        trees.at(f"{name}/tf").add(transform("odom", "base", 1.0), f"{name}/tf", 0, None)
    trees.at("/a/tf_static").add(transform("base", "laser"), "/a/tf_static", 0, None)
    assert trees.between("odom", "laser")[0].translation == (1.0, 0.0, 0.0)
    with raises_saying(LcmtoolsError, "odom and base are in /a and in /b", "--ns"):
        trees.between("odom", "base")
    with raises_saying(LcmtoolsError, "there is no frame lasser", "did you mean laser"):
        trees.between("odom", "lasser")


@pytest.fixture
def log(tmp_path):
    """A log of 10 s: odom to base at 10 Hz, which moves at 1 m/s, and base to laser, once."""
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as writer:
        driver = writer.sender_number(Sender("127.0.0.1", 4001), "/driver")
        fixed = TFMessage(transforms=[transform("base", "laser", 0.5)])
        writer.add(Packet("/tf_static", encode(fixed), _START), driver)
        for tenth in range(101):
            moved = TFMessage(transforms=[transform("odom", "base", tenth / 10, time=tenth)])
            writer.add(Packet("/tf", encode(moved), _START + tenth * _S // 10), driver)
    return str(path)


def test_the_tree_of_a_log(log, capsys):
    assert main(["tf", "tree", "-b", log]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[1:]] == [
        ["odom"],
        ["base", "10.0", "Hz", "0.0", "s", "/tf", "/driver"],
        ["laser", "static", "10.0", "s", "/tf_static", "/driver"],
    ]
    assert main(["tf", "tree", "-b", log, "--json"]) == 0
    records = json.loads(capsys.readouterr().out)
    assert [(one["frame"], one["parent"], one["depth"]) for one in records] == [
        *(("odom", None, 0), ("base", "odom", 1), ("laser", "base", 2))
    ]


def test_poses_of_a_log(log, capsys):
    assert main(["tf", "echo", "odom", "laser", "-b", log, "--json"]) == 0
    records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [round(one["translation"][0], 1) for one in records] == [
        *(1.5 + second for second in range(9)),
        10.5,
    ]
    assert main(["tf", "echo", "/odom", "base", "-b", log, "-1"]) == 0
    assert_says(
        capsys.readouterr().out,
        "At time 10.000000000\n- Translation: [1.000, 0.000, 0.000]\n",
        "- Rotation: in Quaternion (xyzw) [0.000, 0.000, 0.000, 1.000]\n",
        "in RPY (degree) [0.000, 0.000, 0.000]\n",
    )
    assert main(["tf", "echo", "odom", "lasr", "-b", log]) == 1
    assert_says(capsys.readouterr().err, "there is no frame lasr; did you mean laser?")
