"""Skeletons in C++: each is its model answer with the marked parts taken out."""

import re
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.labs import skeletons
from lcmtools.labs.skeletons import CPP_NAMES, in_package, skeleton_text


@pytest.mark.parametrize("name", CPP_NAMES)
def test_a_skeleton_has_nothing_of_its_answer(name):
    text = skeleton_text(name, is_cpp=True)
    assert "// TODO" in text
    assert "SKELETON" not in text
    assert "#e" not in text
    answers = re.findall(r"(?:#else|#ifndef SKELETON)\n(.*?)#endif", _source(name), re.DOTALL)
    assert answers
    assert [one for one in answers if one in text] == []


def _source(name):
    return Path(skeletons.__file__).with_name(f"{name}.cpp").read_text()


def test_a_skeleton_in_cpp_is_copied(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    copied = cli("lab", "skeleton", "talker", "--cpp")
    assert copied.out == "talker.cpp\n"
    assert_line(copied.err, "fill in its TODOs", "compile")
    assert Path("talker.cpp").read_text() == skeleton_text("talker", is_cpp=True)
    assert cli("lab", "skeleton", "--list", "--cpp").out.split() == sorted(CPP_NAMES)
    there_are = "there are kinect_viewer, listener"
    refused = cli("lab", "skeleton", "path_follower", "--cpp")
    assert_line(refused.err, "no skeleton of 'path_follower' in C++", there_are)


def test_a_package_gets_a_skeleton_in_cpp_by_another_name(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    cli("pkg", "create", "lab", "--node", "first")
    added = cli("pkg", "add-node", "drive.cpp", "--skeleton", "simple_controller")
    assert (added.code, added.out) == (0, "lab/CMakeLists.txt\nlab/src/drive.cpp\n")
    assert_line(added.err, "next: lcmtools pkg build lab; lcmtools run lab drive")
    text = Path("lab/src/drive.cpp").read_text()
    assert_says(text, "//     lcmtools pkg build lab\n", 'Node("drive")')
    assert "lcmtools run lab drive __ns:=/husky0" in text
    assert "g++" not in text
    declared = Path("lab/CMakeLists.txt").read_text()
    assert "lcmtools_generate(drive geometry_msgs nav_msgs sensor_msgs)" in declared


@pytest.mark.parametrize("words", [["watch.cpp"], ["watch", "watch.cpp"], ["lab", "watch.cpp"]])
def test_the_first_word_is_a_node_or_the_package(cli, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    cli("pkg", "create", "lab", "--node", "first")
    added = cli("pkg", "add-node", *words)
    assert (added.code, added.out) == (0, "lab/CMakeLists.txt\nlab/src/watch.cpp\n")
    assert "lcmtools run lab watch" in added.err
    assert cli("pkg", "add-node", "lab", "look").code == 0
    assert Path("lab/lab/look.py").is_file()


@pytest.mark.parametrize("name", CPP_NAMES)
def test_commands_of_a_skeleton_become_those_of_a_package(name):
    text = in_package(skeleton_text(name, is_cpp=True), name, "lab")
    assert_says(text, "lcmtools pkg build lab", f"lcmtools run lab {name}")
    assert "g++" not in text
    assert "msg generate" not in text
