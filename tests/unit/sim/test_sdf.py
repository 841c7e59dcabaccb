"""Worlds of Gazebo: what is taken of them, what is left out and said, what is refused."""

import math

import pytest

from lcmtools.errors import InvalidFile
from lcmtools_sim.geometry import Pose
from lcmtools_sim.scene import Ground
from lcmtools_sim.shapes import Cuboid, Cylinder, Sphere
from lcmtools_sim.world_file import read_scene, sdf

BOX = "<geometry><box><size>1 2 3</size></box></geometry>"


def world(inside):
    return f"<sdf version='1.6'><world name='w'>\n{inside}\n</world></sdf>"


def static(inside, pose="0 0 0 0 0 0"):
    return (
        f"<model name='m'><static>true</static><pose>{pose}</pose>"
        f"<link name='l'>{inside}</link></model>"
    )


GOOD = static(f"<collision name='c'>{BOX}</collision>")


def read(folder, inside):
    return read_scene(world(inside), str(folder / "yard.world"))


def only(scene):
    (thing,) = scene.objects
    return thing


def test_a_box_is_where_its_model_link_and_collision_put_it(tmp_path):
    inside = (
        "<model name='crate'><pose>1 0 0 0 0 1.5707963267948966</pose>"
        f"<link name='l'><pose>1 0 0.5 0 0 0</pose><inertial><mass>4</mass></inertial>"
        f"<collision name='c'><pose>0 0 1 0 0 0</pose>{BOX}"
        "<surface><friction><ode><mu>0.3</mu></ode></friction></surface></collision></link></model>"
    )
    crate = only(read(tmp_path, inside))
    assert (crate.name, crate.mass, crate.friction) == ("crate::l", 4.0, 0.3)
    assert crate.pose.position == pytest.approx((1.0, 1.0, 0.5))
    assert crate.pose.yaw == pytest.approx(math.pi / 2)
    assert crate.parts[0].shape == Cuboid((1.0, 2.0, 3.0))
    assert crate.parts[0].position == pytest.approx((0.0, 0.0, 1.0))


def test_every_simple_shape_is_taken(tmp_path):
    shapes = (
        "<cylinder><radius>0.5</radius><length>2</length></cylinder>",
        "<sphere><radius>0.4</radius></sphere>",
        "<capsule><radius>0.1</radius><length>1</length></capsule>",
        "<plane><normal>0 0 1</normal><size>4 5</size></plane>",
    )
    inside = "".join(
        f"<collision name='c{i}'><pose>0 0 1 0 0 0</pose><geometry>{shape}</geometry></collision>"
        for i, shape in enumerate(shapes)
    )
    thing = only(read(tmp_path, static(inside)))
    assert [part.shape for part in thing.parts] == [
        Cylinder(0.5, 2.0),
        Sphere(0.4),
        Cylinder(0.1, 1.0),
        Sphere(0.1),
        Sphere(0.1),
        Cuboid((4.0, 5.0, 0.02)),  # a plane that is not the ground, as a slab below it
    ]
    assert thing.mass == 0
    assert thing.parts[5].position == pytest.approx((0.0, 0.0, 0.99))


def test_the_plane_at_zero_is_the_ground_with_its_friction_and_color(tmp_path):
    inside = static(
        "<collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry>"
        "<surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision>"
        "<visual name='v'><material><diffuse>0.1 0.2 0.3 1</diffuse></material></visual>"
    )
    found = read(tmp_path, "<gravity>0 0 -3.7</gravity>" + inside)
    assert found.objects == ()
    assert found.ground == Ground(0.7, (0.1, 0.2, 0.3))
    assert (found.gravity, found.name) == (3.7, "yard")


@pytest.mark.parametrize(
    ("material", "color"),
    [
        ("<ambient>1 0 0 1</ambient>", (1.0, 0.0, 0.0)),
        ("<ambient>1 0 0 1</ambient><diffuse>0 1 0 1</diffuse>", (0.0, 1.0, 0.0)),
        ("<script><name>Gazebo/Yellow</name></script>", (1.0, 1.0, 0.0)),
        ("<script><name>Gazebo/Unknown</name></script>", (0.6, 0.6, 0.62)),
    ],
)
def test_a_color_is_that_of_the_look_of_the_same_shape(tmp_path, material, color):
    other = "<geometry><sphere><radius>1</radius></sphere></geometry>"
    look = f"<visual name='v'>{BOX}<material>{material}</material></visual>"
    inside = f"<visual name='o'>{other}</visual>{look}<collision name='c'>{BOX}</collision>"
    assert only(read(tmp_path, static(inside))).parts[0].color == color


def test_links_that_joints_hold_are_one_body_and_others_fall_apart(tmp_path):
    links = "".join(
        f"<link name='{name}'><pose>{x} 0 1 0 0 0</pose><inertial><mass>{m}</mass></inertial>"
        f"<collision name='c'>{BOX}</collision></link>"
        for name, x, m in (("a", 0, 1), ("b", 4, 3), ("c", 9, 5), ("d", 20, 1))
    )
    joints = (
        "<joint name='j' type='revolute'><parent>a</parent><child>b</child></joint>"
        "<joint name='k' type='fixed'><parent>world</parent><child>d</child></joint>"
    )
    found = read(tmp_path, f"<model name='m'>{links}{joints}</model>")
    assert [(t.name, t.mass, t.pose.x, len(t.parts)) for t in found.objects] == [
        ("m::a", 4.0, 3.0, 2),  # about the common centre of mass
        ("m::c", 5.0, 9.0, 1),
        ("m::d", 0.0, 20.0, 1),  # held by the world
    ]
    assert found.notes == (f"{tmp_path}/yard.world: left out: movement of a joint (1)",)


def test_nested_models_stand_in_each_other(tmp_path):
    inner = (
        "<model name='in'><pose>1 0 0 0 0 0</pose><link name='l'>"
        f"<collision name='c'>{BOX}</collision></link></model>"
    )
    outer = f"<model name='out'><static>1</static><pose>0 5 0 0 0 0</pose>{inner}</model>"
    thing = only(read(tmp_path, outer))
    assert (thing.name, thing.mass) == ("out::in::l", 0.0)
    assert thing.pose.position == (1.0, 5.0, 0.0)


@pytest.mark.parametrize(
    ("pose", "rotation"),
    [
        ("<pose>0 0 0 0 1.5707963267948966 0.7</pose>", Pose(pitch=math.pi / 2, yaw=0.7)),
        ("<pose>0 0 0 0 -1.5707963267948966 0.7</pose>", Pose(pitch=-math.pi / 2, yaw=0.7)),
        (
            "<pose degrees='true'>0 0 0 0 90 40</pose>",
            Pose(pitch=math.pi / 2, yaw=math.radians(40)),
        ),
        ("<pose rotation_format='quat_xyzw'>0 0 0 0 0 2 2</pose>", Pose(yaw=math.pi / 2)),
        ("<pose relative_to='world'>0 0 0 0.1 0.2 0.3</pose>", Pose(0, 0, 0, 0.1, 0.2, 0.3)),
        ("<pose/>", Pose()),
    ],
)
def test_a_rotation_is_read_in_all_its_forms(tmp_path, pose, rotation):
    inside = static(f"<collision name='c'>{BOX}</collision>")
    inside = inside.replace("<pose>0 0 0 0 0 0</pose>", pose)
    found = only(read(tmp_path, inside)).pose.rotation
    assert found == pytest.approx(rotation.rotation, abs=1e-7)


def test_includes_are_found_beside_the_file_and_where_gazebo_looks(tmp_path, monkeypatch):
    model = f"<sdf>{GOOD}</sdf>"
    for folder in ("near", "models/deeper", "elsewhere/far", "ros/arm", "ros/arm/models/hand"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "model.sdf").write_text(model)
    (tmp_path / "plain.sdf").write_text(model)
    monkeypatch.setenv("GAZEBO_MODEL_PATH", f"/nowhere:{tmp_path}/elsewhere")
    (tmp_path / "ros/arm/package.xml").write_text("<package><name>arm</name></package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}/ros")
    of_ros = ("package://arm", "package://arm/models/hand", "package://arm/model.sdf")
    uris = ("model://near", "model://deeper", "model://far", "plain.sdf", "near", *of_ros)
    inside = "".join(
        f"<include><uri>{uri}</uri><name>n{i}</name><pose>{i} 0 0 0 0 0</pose></include>"
        for i, uri in enumerate(uris)
    )
    found = read(tmp_path, inside)
    assert [(thing.name, thing.pose.x) for thing in found.objects] == [
        (f"n{i}::l", float(i)) for i in range(len(uris))
    ]
    assert found.notes == ()


def test_what_is_left_out_is_one_line(tmp_path):
    mesh = "<collision name='c'><geometry><mesh><uri>a.dae</uri></mesh></geometry></collision>"
    inside = (
        "<include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>"
        "<include><uri>package://gone/a</uri></include>"
        "<include><uri>https://fuel.org/house</uri></include><include><uri>model://gone</uri></include>"
        "<light name='l'/><scene/><physics/><gui/><plugin/>"
        + static(mesh)
        + static(mesh.replace("mesh", "heightmap"))
        + static(f"<visual name='v'>{BOX}</visual>")
    )
    found = read(tmp_path, inside)
    assert found.objects == ()
    assert found.notes == (
        (
            f"{tmp_path}/yard.world: left out: heightmap (1), light (1), mesh (1),"
            " visuals without collisions (1), https://fuel.org/house (not found, 1),"
            " model://gone (not found, 1), package://gone/a (not found, 1)"
        ),
    )


def test_a_model_whose_name_no_file_can_have_is_not_found(tmp_path):
    long = "a" * 300
    found = read(tmp_path, f"<include><uri>model://{long}</uri></include>")
    assert found.notes == (f"{tmp_path}/yard.world: left out: model://{long} (not found, 1)",)


def test_a_world_file_takes_the_things_of_a_gazebo_world(tmp_path):
    inside = static(f"<collision name='c'>{BOX}</collision>", "1 0 0 0 0 0")
    (tmp_path / "yard.world").write_text(world(inside + "<light name='a'/>"))
    text = "objects:\n- {type: sdf, file: yard.world, pose: [0, 2, 90 deg]}"
    found = read_scene(text, str(tmp_path / "mine.yaml"))
    assert only(found).pose.position == pytest.approx((0.0, 3.0, 0.0))
    assert found.notes == (f"{tmp_path}/yard.world: left out: light (1)",)


WRONG = [
    ("", "<sdf/>", ":1: the file contains neither a <world> nor a <model>"),
    ("", "<sdf><world>", (":1: not XML: no element found; is the <world> of line 1 closed?"
     " </world>, or <world ... />")),
    ("", "<!DOCTYPE a><sdf/>", ":1: a document type (<!DOCTYPE>) is not supported; remove it"),
    ("", "<robot name='a'/>", (":1: the file is about <robot>, not <sdf>; a robot (URDF) goes into"
     " the robots of a YAML world file: model: ./FILE")),
    ("<size>1 2 3</size>", "<size>1 2</size>", ":2: <size> must be 3 numbers, not '1 2'"),
    ("<size>1 2 3</size>", "<size>1 2 0</size>",
     ":2: <size> must be between 0.0001 and 1e+06, not 0"),
    ("<size>1 2 3</size>", "<size>1 2 inf</size>",
     ":2: <size> must be between 0.0001 and 1e+06, not inf"),
    ("<size>1 2 3</size>", "<size/>", ":2: <size> is empty"),
    ("0 0 0 0 0 0", "0 0 0", ":2: <pose> must be 6 or 7 numbers, not '0 0 0'"),
    ("0 0 0 0 0 0", "0 0 0 0 0 nan", ":2: <pose> must be between -1e+06 and 1e+06, not nan"),
    ("0 0 0 0 0 0", "0 0 0 0 0 0 0", ":2: the rotation is all zeros; 0 0 0 1 for none"),
    ("<pose>", "<pose relative_to='door'>", (":2: there is no frame 'door' in <world name='w'>;"
     " frames of included files are not read")),
    (" name='m'", "", ":2: <model> lacks the attribute 'name'"),
    ("</link>", "</link><link name='l'/>", ":2: two links of the model are named 'm::l'"),
    ("<model", "<gravity>1 0 0</gravity><model",
     ":2: gravity must be 0 0 -G, with G from 0 to 100"),
    ("</link>", "</link><joint name='j' type='fixed'/>", ":2: <joint name='j'> lacks <parent>"),
    ("<model", "<include/><model", ":2: <include> lacks <uri>"),
    ("<model", "<include><uri>empty.sdf</uri></include><model", (":2: FOLDER/empty.sdf contains no"
     " <model>")),
    ("<model", "<include><uri>loop.sdf</uri></include><model",
     ":1: FOLDER/loop.sdf includes itself"),
    ("<model", "<include><uri>bytes.sdf</uri></include><model", "bytes.sdf: it is not UTF-8 text"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), WRONG, ids=[f"{w[1]} {w[2]}" for w in WRONG])
def test_what_is_wrong_is_said_with_file_and_line(tmp_path, old, new, message):
    (tmp_path / "empty.sdf").write_text("<sdf/>")
    (tmp_path / "bytes.sdf").write_bytes(b"\xff\xfe")
    loop = "<sdf><model name='a'><include><uri>loop.sdf</uri></include></model></sdf>"
    (tmp_path / "loop.sdf").write_text(loop)
    text = world(GOOD.replace(old, new, 1)) if old else new
    with pytest.raises(InvalidFile) as caught:
        read_scene(text, str(tmp_path / "yard.world"))
    assert str(caught.value).endswith(message.replace("FOLDER", str(tmp_path)))


def test_includes_that_multiply_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(sdf, "_MOST_MODELS", 100)
    (tmp_path / "m0.sdf").write_text("<sdf><model name='a'/></sdf>")
    for i in range(1, 30):
        twenty = "".join(
            f"<include><uri>m{i - 1}.sdf</uri><name>n{k}</name></include>" for k in range(20)
        )
        (tmp_path / f"m{i}.sdf").write_text(f"<sdf><model name='a'>{twenty}</model></sdf>")
    with pytest.raises(InvalidFile, match=r"the world has more than 100 models"):
        read(tmp_path, "<include><uri>m29.sdf</uri></include>")
