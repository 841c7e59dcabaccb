"""Robots of URDF files: joints that cannot move here are named, by `run sim --check` too."""

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import InvalidFile
from lcmtools_sim.world_file import read_scene

WHEEL = """<link name="{0}"><collision><origin rpy="1.5707963 0 0"/><geometry>
<cylinder radius="0.1" length="0.04"/></geometry></collision></link>
<joint name="{0}_joint" type="continuous"><parent link="base_link"/><child link="{0}"/>
<origin xyz="0 {1} 0"/><axis xyz="0 1 0"/></joint>"""
ROBOT = """<robot name="r"><link name="base_link"><inertial><mass value="4"/>
<inertia ixx="0.04" iyy="0.05" izz="0.06"/></inertial>
<collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision></link>
{}{}{}</robot>"""
JOINT = """<link name="{0}_link"/><joint name="{0}" type="{1}"><parent link="base_link"/>
<child link="{0}_link"/>{2}</joint>"""


def scene(folder, text):
    (folder / "r.urdf").write_text(text)
    drive = "drive: {left: [l_joint], right: [r_joint]}"
    world = f"robots:\n- {{model: r.urdf, namespace: a, {drive}}}"
    return read_scene(world, str(folder / "yard.yaml"))


def robot(more):
    return ROBOT.format(WHEEL.format("l", 0.2), WHEEL.format("r", -0.2), more)


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic", "planar", "floating"])
def test_each_joint_that_nothing_drives_is_named(tmp_path, kind):
    (note,) = scene(tmp_path, robot(JOINT.format("arm", kind, ""))).notes
    assert_says(note, "r.urdf", "rigid", f"arm ({kind})")


def test_mimic_joints_are_named_and_fixed_ones_are_not(tmp_path):
    finger = JOINT.format("finger", "prismatic", '<mimic joint="thumb"/>')
    more = JOINT.format("thumb", "prismatic", "") + finger + JOINT.format("box", "fixed", "")
    (note,) = scene(tmp_path, robot(more)).notes
    assert note.endswith("them: thumb (prismatic), finger (mimic)")
    assert scene(tmp_path, robot(JOINT.format("box", "fixed", ""))).notes == ()


def test_robot_without_links_is_said_to_have_none(tmp_path):
    with raises_saying(InvalidFile, "r.urdf:1", "the robot has no links"):
        scene(tmp_path, "<robot name='r'/>")
