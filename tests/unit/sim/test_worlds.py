"""The worlds that come with the simulator, and finding a world by name or file."""

import pytest

from lcmtools.errors import InvalidFile, UsageError
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import describe, find_world, world_names


@pytest.mark.parametrize("name", world_names())
def test_every_packaged_world_is_right_and_described(name):
    assert read_scene(*find_world(name)).name == name
    assert len(describe(name)) > 10


def test_the_labs_own_name_means_the_husky_world():
    text, source = find_world("lab_0123_world")
    assert (text, source) == find_world("husky")
    scene = read_scene(text, source)
    assert scene.node == "morse"
    assert [(r.model.name, r.namespace) for r in scene.robots] == [("husky", "/husky0")]


def test_a_file_is_read_from_where_it_is(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("node: mine")
    assert find_world(str(file)) == ("node: mine", str(file))


def test_an_unknown_name_brings_a_near_miss():
    with pytest.raises(UsageError, match=r"no world 'huskey'; did you mean husky\?"):
        find_world("huskey")


def test_an_unknown_name_far_from_all_brings_the_list():
    with pytest.raises(
        UsageError,
        match=r"'x'; worlds: dolly, empty, husky, multi, pioneer; or give a file, ./x.yaml",
    ):
        find_world("x")


def test_a_file_that_is_not_there_a_folder_and_binary_are_refused(tmp_path):
    binary = tmp_path / "image.yaml"
    binary.write_bytes(b"ab\xff\xfe")
    with pytest.raises(InvalidFile, match=r"cannot read .*no\.yaml: No such file"):
        find_world("./no.yaml")
    with pytest.raises(InvalidFile, match=r"cannot read .*: Is a directory"):
        find_world(f"{tmp_path}/")
    with pytest.raises(InvalidFile, match=r"image\.yaml: it is not UTF-8 text"):
        find_world(str(binary))
