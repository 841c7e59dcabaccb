"""Robots from URDF files: the body, the drive, and what is wrong with a file."""

import math

import pytest

from lcmtools.errors import InvalidFile
from lcmtools_sim.shapes import Cuboid, Cylinder, Sphere
from lcmtools_sim.world_file import read_scene

CART = """<?xml version="1.0"?>
<robot name="cart">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base_footprint"/>
  <link name="base_link">
    <inertial>
      <origin xyz="0 0 0.02"/><mass value="4"/>
      <inertia ixx="0.04" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><geometry><mesh filename="body.dae"/></geometry><material name="blue"/></visual>
    <collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision>
  </link>
  <link name="left">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.002" izz="0.001"/></inertial>
    <collision>
      <origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry>
    </collision>
  </link>
  <link name="right">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.002" izz="0.001"/></inertial>
    <collision>
      <origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry>
    </collision>
  </link>
  <link name="caster"><visual><geometry><sphere radius="0.04"/></geometry></visual></link>
  <joint name="up" type="fixed">
    <parent link="base_footprint"/><child link="base_link"/><origin xyz="0 0 0.12"/>
  </joint>
  <joint name="left_joint" type="continuous">
    <parent link="base_link"/><child link="left"/>
    <origin xyz="0 0.15 -0.02"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="right_joint" type="continuous">
    <parent link="base_link"/><child link="right"/>
    <origin xyz="0 -0.15 -0.02"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="caster_joint" type="fixed">
    <parent link="base_link"/><child link="caster"/><origin xyz="-0.15 0 -0.08"/>
  </joint>
</robot>
"""
DRIVE = "{left: [left_joint], right: [right_joint]}"


def scene(folder, urdf=CART, drive=DRIVE, more=""):
    (folder / "cart.urdf").write_text(urdf)
    text = f"robots:\n- model: cart.urdf\n  namespace: a\n  drive: {drive}\n{more}"
    return read_scene(text, str(folder / "yard.yaml"))


def model(folder, urdf=CART, drive=DRIVE):
    return scene(folder, urdf, drive).robots[0].model


def test_the_wheels_give_radius_track_and_the_names_of_the_sides(tmp_path):
    cart = model(tmp_path)
    assert cart.name == "cart"
    assert cart.drive.wheel_radius == 0.1
    assert cart.drive.track == pytest.approx(0.3)
    assert (cart.drive.max_speed, cart.drive.full_speed) == (1.0, 1.0)
    assert cart.left_wheels == ("left", "left_joint")
    assert cart.right_wheels == ("right", "right_joint")
    assert [mount.kind for mount in cart.sensors] == [
        "odometry",
        "wheel_states",
        "ground_truth",
        "transforms",
    ]


def test_viewers_see_wheels_with_spokes_that_turn(tmp_path):
    look = model(tmp_path).body.look
    assert [type(part.shape) for part in look.parts] == [Cuboid, Sphere]
    assert [wheel.centre for wheel in look.wheels] == [
        pytest.approx((0, 0.15, 0.1)),
        pytest.approx((0, -0.15, 0.1)),
    ]
    tyre, _, *spokes, _ = look.wheels[0].parts
    assert tyre.shape == Cylinder(0.1, 0.04)
    assert len(spokes) == 3


def test_what_the_drive_says_wins_over_the_geometry(tmp_path):
    drive = (
        "{left: [left_joint], right: [right_joint], wheel_radius: 0.11, track: 0.4,"
        " max_speed: 2, max_turn_rate: 3, max_acceleration: 4, time_constant: 0.2, friction: 0.5}"
    )
    found = model(tmp_path, drive=drive).drive
    assert (found.wheel_radius, found.track, found.max_speed) == (0.11, 0.4, 2.0)
    assert (found.max_turn_rate, found.max_acceleration) == (3.0, 4.0)
    assert (found.time_constant, found.tyre_friction) == (0.2, 0.5)


def test_masses_are_joined_by_the_parallel_axis_theorem(tmp_path):
    body = model(tmp_path).body
    # base_link hangs 0.12 m above the ground, its mass 0.02 m higher, the wheels' at 0.1 m.
    height = (4 * 0.14 + 2 * 0.5 * 0.1) / 5
    above, below = 0.14 - height, height - 0.1
    assert body.mass == 5
    assert body.base_height == pytest.approx(0.12)
    assert body.centre_of_mass == pytest.approx(height)
    assert body.inertia == pytest.approx(
        (
            0.04 + 4 * above**2 + 2 * (0.001 + 0.5 * (below**2 + 0.15**2)),
            0.05 + 4 * above**2 + 2 * (0.002 + 0.5 * below**2),
            0.06 + 2 * (0.001 + 0.5 * 0.15**2),
        )
    )


def test_a_turned_inertia_is_turned_into_the_base(tmp_path):
    turned = CART.replace('<origin xyz="0 0 0.02"/><mass', '<origin rpy="0 1.5707963 0"/><mass')
    before, after = model(tmp_path).body, model(tmp_path, turned).body
    heights = [(4 * z + 2 * 0.5 * 0.1) / 5 for z in (0.14, 0.12)]
    steiner = [
        4 * (z - h) ** 2 + (h - 0.1) ** 2 for z, h in zip((0.14, 0.12), heights, strict=True)
    ]
    assert before.inertia[0] - steiner[0] - (after.inertia[0] - steiner[1]) == pytest.approx(-0.02)
    assert before.inertia[2] - after.inertia[2] == pytest.approx(0.02)


def test_shapes_are_those_that_collide_or_else_those_that_are_seen(tmp_path):
    found = scene(tmp_path)
    parts = found.robots[0].model.body.parts
    assert [type(part.shape) for part in parts] == [Cuboid, Cylinder, Cylinder, Sphere]
    assert parts[0].color == (0.0, 0.0, 1.0)
    assert parts[0].position == pytest.approx((0.0, 0.0, 0.12))
    assert found.notes == ()


def test_nothing_but_the_feet_touches_the_ground(tmp_path):
    body = model(tmp_path).body
    for part in body.parts[1:]:
        radius = part.shape.radius if not isinstance(part.shape, Cuboid) else 0.0
        assert part.position[2] - radius > 0.003


def test_it_stands_on_wheels_and_caster_and_a_foot_where_nothing_supports_it(tmp_path):
    left, right, caster, added = model(tmp_path).body.feet
    assert (left, right) == ((0.0, pytest.approx(0.15)), (0.0, pytest.approx(-0.15)))
    assert caster == (pytest.approx(-0.15), 0.0)
    assert added[0] > 0.03


def test_four_wheels_can_skid_and_need_no_more_feet(tmp_path):
    extra = "".join(
        f'<link name="{side}2"><collision><origin rpy="1.5708 0 0"/><geometry>'
        '<cylinder radius="0.1" length="0.04"/></geometry></collision></link>'
        f'<joint name="{side}2_joint" type="continuous"><parent link="base_link"/>'
        f'<child link="{side}2"/><origin xyz="-0.2 {y} -0.02"/><axis xyz="0 1 0"/></joint>'
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    drive = "{left: [left_joint, left2_joint], right: [right_joint, right2_joint]}"
    found = scene(tmp_path, CART.replace("</robot>", extra + "</robot>"), drive, "  skid: coulomb")
    cart = found.robots[0].model
    assert cart.drive.skids
    corners = sorted((round(x, 9), round(y, 9)) for x, y in cart.drive.wheels)
    assert corners == [(-0.1, -0.15), (-0.1, 0.15), (0.1, -0.15), (0.1, 0.15)]
    assert cart.left_wheels == ("left", "left_joint", "left2_joint")
    assert "0.100 m" in found.notes[0]  # the file's base_link is over the front wheels
    assert "base_link is assumed at the middle between the wheels" in found.notes[0]


def test_a_link_that_is_only_seen_as_a_mesh_is_left_out_and_said(tmp_path):
    mesh = '<visual><geometry><mesh filename="a.stl"/></geometry></visual>'
    ball = '<visual><geometry><sphere radius="0.04"/></geometry></visual>'
    assert scene(tmp_path, CART.replace(ball, mesh)).notes == (
        f"{tmp_path}/cart.urdf:25: link 'caster' is left out: it is a mesh",
    )


@pytest.mark.parametrize(
    ("inertia", "is_noted"),
    [
        ('ixx="0.04" iyy="0.05" izz="0.09"', False),  # flat
        ('ixx="0.04" iyy="0.05" izz="0.0903"', False),  # rounded
        ('ixx="0.04" iyy="0.05" izz="0.2"', True),
        ('ixx="0.04" iyy="0.05" izz="0.06" ixy="0.05"', True),
        ('ixx="1" iyy="1" izz="1" ixy="0.4" ixz="0.4" iyz="0.4"', True),
        ('ixx="0" iyy="0" izz="0.06"', True),
    ],
)
def test_an_inertia_that_no_body_has_is_named(tmp_path, inertia, *, is_noted):
    text = CART.replace('ixx="0.04" iyy="0.05" izz="0.06" ixy="0" ixz="0" iyz="0"', inertia, 1)
    note = f"{tmp_path}/cart.urdf:5: no body has the inertia of link 'base_link': the engine"
    notes = [one for one in scene(tmp_path, text).notes if one.startswith(note)]
    assert len(notes) == is_noted


def test_topics_and_commands_are_renamed(tmp_path):
    found = scene(tmp_path, more="  topics: {odometry: odom}\n  commands: [drive]\n")
    cart = found.robots[0].model
    assert [mount.topic for mount in cart.sensors][:2] == ["odom", "wheel_states"]
    assert [command.name for command in cart.commands] == ["drive"]


BOX = '<box size="0.4 0.2 0.1"/>'
WRONG = [
    ('name="cart"', "", ":2: <robot> lacks the attribute 'name'"),
    ("</robot>", "", ":41: not XML: no element found"),
    ("<robot", "<!DOCTYPE a [<!ENTITY b 'c'>]><robot", (":2: a document type (<!DOCTYPE>)"
     " is not supported; remove it")),
    ("<robot", "<sdf/><robot", ":2: not XML: junk after document element"),
    ("<robot name", "<robt name", ":40: not XML: mismatched tag"),
    (BOX, '<mesh filename="a.stl"/>', (":11: link 'base_link' has a shape of <mesh>; boxes,"
     " cylinders and spheres are supported: give it one as <collision>")),
    (BOX, "", (":11: link 'base_link' has a shape of <nothing>; boxes, cylinders and spheres are"
     " supported: give it one as <collision>")),
    (BOX, '<box size="0.4 0.2"/>', ":11: 'size' of <box> must be 3 numbers, not '0.4 0.2'"),
    (BOX, '<box size="0.4 0.2 nan"/>',
     ":11: 'size' of <box> must be between 0.0001 and 1e+06, not nan"),
    (BOX, '<box size="0.4 0.2 -1"/>',
     ":11: 'size' of <box> must be between 0.0001 and 1e+06, not -1"),
    (BOX, '<box size="0.4 0.2 x"/>', ":11: 'size' of <box> must be a number, not 'x'"),
    (BOX, "<box/>", ":11: <box> lacks the attribute 'size'"),
    ('<mass value="4"/>', "", ":6: <inertial> lacks <mass>"),
    ('<mass value="4"/>', '<mass value="-4"/>',
     ":7: 'value' of <mass> must be between 0 and 1e+06, not -4"),
    ('<link name="caster">', '<link name="left">', ":25: two links are named 'left'"),
    ('<child link="caster"/>', '<child link="castor"/>',
     ":37: <joint name='caster_joint'> joins a link 'castor' that does not exist"),
    ('<child link="caster"/>', '<child link="left"/>', ":37: the link 'left' has two parents"),
    ('<link name="caster">', '<link name="lost"/><link name="caster">',
     ":2: the links must form one tree: base_footprint and lost are not joined"),
    ('<parent link="base_footprint"/>', '<parent link="caster"/>',
     ":5: the link 'base_link' is its own ancestor"),
    ('type="continuous"', 'type="fixed"',
     ":29: <joint name='left_joint'> is fixed: a wheel's is continuous"),
    ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>',
     (":29: <joint name='left_joint'> does not turn about the y axis of base_link, as wheels do;"
     ' give it <axis xyz="0 1 0"/>')),
    ('<origin rpy="1.5707963 0 0"/>', "",
     (":13: the cylinder of the wheel 'left' does not lie along its axle;"
     ' rpy="1.5708 0 0" in its <origin> turns it, where the axle is y')),
    ('xyz="-0.15 0 -0.08"', 'xyz="-0.15 0 -0.3"',
     ":25: the link 'caster' reaches 0.220 m below the wheels, which then carry nothing"),
    ("<robot", '<robot><link name="${n}"/></robot><robot', ": it is a xacro file, which must be"),
    ("<robot", "<robot><macro name='a'/></robot><robot", ": it is a xacro file, which must be"),
    ("<robot", '<robot xmlns:xacro="a"><xacro:include filename="b"/></robot><robot',
     ": it is a xacro file, which must be expanded first; type: xacro cart.urdf > plain_cart.urdf"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "message"), WRONG, ids=[f"{w[1]} {w[2]}"[:80] for w in WRONG]
)
def test_what_is_wrong_in_the_file_is_said_with_its_line(tmp_path, old, new, message):
    assert old in CART
    with pytest.raises(InvalidFile) as caught:
        scene(tmp_path, CART.replace(old, new, 1))
    assert str(caught.value).startswith(f"{tmp_path}/cart.urdf{message}")


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ("{left: [left_joint]}", "4: 'drive' lacks the key 'right'"),
        ("{left: left_joint, right: [right_joint]}", "4: 'left' must be a list, not a single"),
        ("{left: [], right: [right_joint]}", "4: 'left' names no joint"),
        ("{left: [left_joint], right: [left_joint]}", "4: the joint 'left_joint' is given twice"),
        ("{left: [right_joint], right: [left_joint]}", "4: the left wheels are not to the left"),
        (
            "{left: [left_jiont], right: [right_joint]}",
            "4: FOLDER/cart.urdf has no joint 'left_jiont'; did you mean left_joint?",
        ),
        (
            "{left: [x], right: [right_joint]}",
            "4: FOLDER/cart.urdf has no joint 'x'; joints that turn: left_joint, right_joint",
        ),
        ("{left: [left_joint], right: [right_joint], speed: 1}", "4: unknown key 'speed' in"),
        (
            "{left: [left_joint], right: [right_joint], max_speed: 0}",
            "4: 'max_speed' must be between 0.001 and 100, not 0",
        ),
    ],
)
def test_what_is_wrong_in_the_drive_is_said_with_its_line(tmp_path, drive, message):
    with pytest.raises(InvalidFile) as caught:
        scene(tmp_path, drive=drive)
    wanted = message.replace("FOLDER", str(tmp_path))
    assert str(caught.value).startswith(f"{tmp_path}/yard.yaml:{wanted}")


def test_the_error_for_a_urdf_without_a_drive_names_the_joints_that_turn(tmp_path):
    (tmp_path / "cart.urdf").write_text(CART)
    with pytest.raises(InvalidFile) as caught:
        read_scene("robots:\n- {model: ./cart.urdf, namespace: a}", str(tmp_path / "yard.yaml"))
    assert str(caught.value) == (
        f"{tmp_path}/yard.yaml:2: a model from a URDF file needs the key 'drive'; name its wheels:"
        " drive: {left: [JOINT], right: [JOINT]}; joints that turn: left_joint, right_joint"
    )


def test_wheels_without_mass_and_of_two_sizes_are_refused(tmp_path):
    massless = CART.replace('value="4"', 'value="0"').replace('value="0.5"', 'value="0"')
    uneven = CART.replace('radius="0.1"', 'radius="0.12"', 1)
    with pytest.raises(InvalidFile, match=r"cart.urdf:2: no link has a mass"):
        scene(tmp_path, massless)
    with pytest.raises(InvalidFile, match=r"the wheels have radii from 0.1 to 0.12 m; set whee"):
        scene(tmp_path, uneven)


def test_a_deep_file_is_refused(tmp_path):
    with pytest.raises(InvalidFile, match=r"cart.urdf:1: nested more than 50 levels deep"):
        scene(tmp_path, "<robot>" + "<a>" * 100_000)


def test_a_base_turned_in_the_world_makes_no_difference(tmp_path):
    turned = CART.replace('<origin xyz="0 0 0.12"/>', '<origin xyz="3 2 0.12" rpy="0 0 1"/>')
    assert model(tmp_path, turned).body.parts[0].position == pytest.approx((0, 0, 0.12))
    assert not math.isnan(model(tmp_path, turned).drive.track)
