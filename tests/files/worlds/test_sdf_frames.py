"""Worlds of Gazebo: bodies are where Gazebo's rules put them, here computed by matrices."""

import math

import numpy as np
import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import InvalidFile
from lcmtools_sim.geometry import Frame, axes
from lcmtools_sim.shapes import Cuboid, Cylinder, Sphere
from lcmtools_sim.world_file import read_scene

Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]

BODY = "<collision name='c'><geometry><box><size>1 2 3</size></box></geometry></collision>"
A, B, C = "1 2 3 0.1 0.2 0.3", "0.5 -1 2 -0.4 0.3 2", "-2 0.25 1 1 0.5 -0.7"


def matrix(pose):
    """The homogeneous matrix of a pose: fixed axes x, y, z in this order."""
    x, y, z, *angles = map(float, pose.split())
    turn = np.eye(3)
    for axis, angle in enumerate(angles):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        one = np.eye(3)
        one[i, i] = one[j, j] = math.cos(angle)
        one[j, i], one[i, j] = math.sin(angle), -math.sin(angle)
        turn = one @ turn
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = turn, (x, y, z)
    return found


def read(folder, inside):
    text = f"<sdf version='1.9'><world name='w'>\n{inside}\n</world></sdf>"
    return read_scene(text, str(folder / "yard.world"))


def places(scene):
    """The matrix of each body's first part in the world."""
    found = {}
    for thing in scene.objects:
        frame = thing.pose.frame.place(Frame(thing.parts[0].position, thing.parts[0].rotation))
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = np.array(axes(frame.rotation)).T, frame.position
        found[thing.name] = place
    return found


def model(name, inside, attributes=""):
    return f"<model name='{name}' {attributes}><static>1</static>{inside}</model>"


RELATIVE = {
    "a link's pose in a frame": (
        (
            f"<frame name='f'><pose>{A}</pose></frame>"
            f"<link name='l'><pose relative_to='f'>{B}</pose>{BODY}</link>"
        ),
        matrix(A) @ matrix(B),
    ),
    "a link's pose in a later link": (
        (
            f"<link name='l'><pose relative_to='k'>{B}</pose>{BODY}</link>"
            f"<link name='k'><pose>{A}</pose></link>"
        ),
        matrix(A) @ matrix(B),
    ),
    "a frame attached to a link": (
        (
            f"<link name='k'><pose>{A}</pose></link>"
            f"<frame name='f' attached_to='k'><pose>{B}</pose></frame>"
            f"<link name='l'><pose relative_to='f'>{C}</pose>{BODY}</link>"
        ),
        matrix(A) @ matrix(B) @ matrix(C),
    ),
    "a frame attached to one link, in another frame": (
        (
            f"<link name='k'><pose>{A}</pose></link><frame name='g'><pose>{C}</pose></frame>"
            f"<frame name='f' attached_to='k'><pose relative_to='g'>{B}</pose></frame>"
            f"<link name='l'><pose relative_to='f'>{C}</pose>{BODY}</link>"
        ),
        matrix(C) @ matrix(B) @ matrix(C),
    ),
    "a joint, which is in its child": (
        (
            f"<link name='k'><pose>{A}</pose></link>"
            "<joint name='j' type='fixed'><parent>world</parent><child>k</child>"
            f"<pose>{B}</pose></joint>"
            f"<link name='l'><pose relative_to='j'>{C}</pose>{BODY}</link>"
        ),
        matrix(A) @ matrix(B) @ matrix(C),
    ),
    "a collision's pose in the model": (
        f"<link name='l'><pose>{A}</pose>"
        + BODY.replace("<geometry>", f"<pose relative_to='__model__'>{B}</pose><geometry>")
        + "</link>",
        matrix(B),
    ),
    "a collision's pose in its own link": (
        f"<link name='l'><pose>{A}</pose>"
        + BODY.replace("<geometry>", f"<pose relative_to='l'>{B}</pose><geometry>")
        + "</link>",
        matrix(A) @ matrix(B),
    ),
    "a link of a nested model": (
        (
            f"<model name='n'><pose>{A}</pose><link name='k'><pose>{B}</pose></link></model>"
            f"<link name='l'><pose relative_to='n::k'>{C}</pose>{BODY}</link>"
        ),
        matrix(A) @ matrix(B) @ matrix(C),
    ),
}


@pytest.mark.parametrize(("inside", "place"), RELATIVE.values(), ids=RELATIVE.keys())
def test_poses_are_relative_to_any_frame(tmp_path, inside, place):
    found = places(read(tmp_path, model("m", f"<pose>{C}</pose>{inside}")))
    assert found["m::l"] == pytest.approx(matrix(C) @ place)


def test_models_are_relative_to_models_and_frames_of_the_world(tmp_path):
    link = f"<link name='l'>{BODY}</link>"
    inside = (
        model("a", f"<pose relative_to='b'>{A}</pose>{link}")
        + model("b", f"<pose relative_to='f'>{B}</pose>{link}")
        + f"<frame name='f'><pose>{C}</pose></frame>"
    )
    found = places(read(tmp_path, inside))
    assert found["b::l"] == pytest.approx(matrix(C) @ matrix(B))
    assert found["a::l"] == pytest.approx(matrix(C) @ matrix(B) @ matrix(A))


def test_a_placement_frame_is_what_the_pose_places(tmp_path):
    links = f"<link name='k'><pose>{A}</pose></link><link name='l'>{BODY}</link>"
    (tmp_path / "m.sdf").write_text(f"<sdf version='1.9'>{model('m', links)}</sdf>")
    inside = (
        model("m", f"<pose>{B}</pose>{links}", "placement_frame='k'")
        + "<include><uri>m.sdf</uri><name>i</name>"
        + f"<placement_frame>k</placement_frame><pose>{C}</pose></include>"
    )
    found = places(read(tmp_path, inside))
    assert found["m::l"] == pytest.approx(matrix(B) @ np.linalg.inv(matrix(A)))
    assert found["i::l"] == pytest.approx(matrix(C) @ np.linalg.inv(matrix(A)))


STATE = f"""
<state world_name='w'>
  <model name='moved'><pose frame=''>{B}</pose><link name='k'><pose>{C}</pose></link>
    <model name='n'><pose>{A}</pose></model></model>
  <model name='inc'><pose>{C}</pose></model>
  <model name='new'><pose>{A}</pose><scale>1 1 2</scale></model>
  <model name='not_there'><pose>{A}</pose><scale>1 1 1</scale></model>
  <insertions>{model("new", f"<link name='k'>{BODY}</link>")}</insertions>
  <deletions><name>gone</name></deletions>
</state>
<state world_name='second'><model name='moved'><pose>9 9 9 0 0 0</pose></model></state>
"""


def test_saved_state_places_models_and_links_in_the_world(tmp_path):
    two = (
        f"<pose>{A}</pose><link name='k'><pose>{B}</pose>{BODY}</link>"
        f"<link name='o'><pose>{A}</pose>{BODY}</link>"
        f"<model name='n'><pose>{C}</pose><link name='k'>{BODY}</link></model>"
    )
    file = model("file", f"<link name='k'>{BODY}</link>")
    (tmp_path / "m.sdf").write_text(f"<sdf>{file}</sdf>")
    inside = (
        model("moved", two)
        + f"<include><uri>m.sdf</uri><name>inc</name><pose>{A}</pose></include>"
        + model("kept", f"<pose>{A}</pose><link name='k'>{BODY}</link>")
        + model("gone", f"<link name='k'>{BODY}</link>")
    )
    (tmp_path / "yard.world").write_text(f"<sdf><world name='w'>{inside}{STATE}</world></sdf>")
    scene = read_scene((tmp_path / "yard.world").read_text(), str(tmp_path / "yard.world"))
    moved = read_scene(
        "objects:\n- {type: sdf, file: yard.world, pose: [1, 2, 3, 0.1, 0.2, 0.3]}",
        str(tmp_path / "mine.yaml"),
    )
    expected = {
        "moved::k": matrix(C),  # a link's own pose is in the world, too
        "moved::o": matrix(B) @ matrix(A),
        "moved::n::k": matrix(A),
        "inc::k": matrix(C),
        "kept::k": matrix(A),
        "new::k": matrix(A),
    }
    found = places(scene)
    assert found.keys() == expected.keys()
    for name, place in expected.items():
        assert found[name] == pytest.approx(place), name
        assert places(moved)[name] == pytest.approx(matrix(A) @ place), name
    (note,) = scene.notes
    assert_says(note, "yard.world", "left out", "scale in the saved state (1)")


@pytest.mark.parametrize(
    "normal", [(0, 0, 1), (1, 0, 0), (0, -2, 0), (1, 1, 1), (0, 0, -1), (-0.3, 0.2, -0.9)]
)
def test_a_plane_is_a_slab_behind_its_normal(tmp_path, normal):
    words = " ".join(map(str, normal))
    plane = f"<plane><normal>{words}</normal><size>4 5</size></plane>"
    body = f"<collision name='c'><geometry>{plane}</geometry></collision>"
    scene = read(tmp_path, model("m", f"<pose>{A}</pose><link name='k'>{body}</link>"))
    place = places(scene)["m::k"]
    unit = matrix(A)[:3, :3] @ np.array(normal) / np.linalg.norm(normal)
    assert scene.objects[0].parts[0].shape == Cuboid((4.0, 5.0, 0.02))
    assert place[:3, 2] == pytest.approx(unit)
    assert place[:3, 3] == pytest.approx(matrix(A)[:3, 3] - 0.01 * unit)


@pytest.mark.parametrize(
    ("turn", "normal", "is_ground"),
    [("0 0 0", "0 0 1", True), ("0 0 0", "1 0 0", False), ("0 -1.5707963 0", "1 0 0", True)],
)
def test_only_a_plane_that_faces_up_is_the_ground(tmp_path, turn, normal, *, is_ground):
    plane = f"<geometry><plane><normal>{normal}</normal></plane></geometry>"
    link = f"<link name='k'><collision name='c'>{plane}</collision></link>"
    scene = read(tmp_path, model("m", f"<pose>0 0 0 {turn}</pose>{link}"))
    assert (not scene.objects) is is_ground


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ("<box/>", Cuboid((1.0, 1.0, 1.0))),
        ("<sphere/>", Sphere(1.0)),
        ("<cylinder/>", Cylinder(1.0, 1.0)),
        ("<cylinder><length>3</length></cylinder>", Cylinder(1.0, 3.0)),
        ("<capsule/>", Cylinder(0.5, 1.0)),
    ],
)
def test_shapes_without_a_size_have_sdfs_defaults(tmp_path, shape, expected):
    link = f"<link name='k'><collision name='c'><geometry>{shape}</geometry></collision></link>"
    assert read(tmp_path, model("m", link)).objects[0].parts[0].shape == expected


def test_a_joint_to_no_link_is_left_out_by_name(tmp_path):
    joint = "<joint name='{}' type='fixed'><parent>{}</parent><child>{}</child></joint>"
    inside = (
        f"<model name='m'><link name='a'>{BODY}</link><link name='b'>{BODY}</link>"
        f"<link name='c'>{BODY}</link><frame name='f' attached_to='b'/>"
        f"{joint.format('lost', 'a', 'nope')}{joint.format('held', 'c', 'f')}</model>"
    )
    scene = read(tmp_path, inside)
    assert [len(thing.parts) for thing in scene.objects] == [1, 2]
    (note,) = scene.notes
    assert_says(note, "left out", "joint m::lost, as there is no link m::nope (1)")


def test_a_joint_between_models_is_counted(tmp_path):
    link = f"<link name='l'>{BODY}</link>"
    joint = "<joint name='j' type='fixed'><parent>a::l</parent><child>b::l</child></joint>"
    (note,) = read(tmp_path, f"{model('a', link)}{model('b', link)}{joint}").notes
    assert_says(note, "left out", "joint (1)")


def test_an_endless_chain_of_frames_is_refused(tmp_path):
    chain = "".join(f"<frame name='f{i}' attached_to='f{i + 1}'/>" for i in range(2000))
    link = f"<link name='l'><pose relative_to='f0'/>{BODY}</link><frame name='f2000'/>"
    with raises_saying(InvalidFile, "yard.world:1", "too many frames"):
        read(tmp_path, model("m", chain + link))


def test_comments_may_have_two_dashes(tmp_path):
    link = f"<link name='k'>{BODY}</link>"
    text = f"<!-- a -- b\n --- --->{model('m', link)}<!-- <model -- > -->"
    assert len(read(tmp_path, text).objects) == 1
    with raises_saying(InvalidFile, "yard.world:3"):
        read(tmp_path, "<!-- a -- \n --><model/>")


@pytest.mark.parametrize(
    ("inside", "reason"),
    [
        ("<frame name='f'><pose relative_to='f'/></frame>", "relative to itself"),
        (
            "<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>",
            "relative to itself",
        ),
        ("<frame name='ff'/>", "no frame 'f' in <model name='m'>; did you mean ff?"),
    ],
)
def test_frames_that_are_nowhere_are_named(tmp_path, inside, reason):
    link = f"<link name='l'><pose relative_to='f'/>{BODY}</link>"
    with raises_saying(InvalidFile, "yard.world:2", reason):
        read(tmp_path, model("m", inside + link))
