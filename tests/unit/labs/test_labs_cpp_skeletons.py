"""Skeletons in C++: the model answers fill in their TODOs, and nothing else changes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.labs.skeletons import CPP_NAMES, in_package, skeleton_text

LABS = Path(__file__).parents[3] / "labs"
ANSWERS = {path.stem: path for path in LABS.glob("*/cpp/*.cpp")}


def kept(skeleton: str) -> list[str]:
    """Return the lines of a skeleton that stay when it is completed."""
    lines: list[str] = []
    is_task = False
    for line in skeleton.replace(" (skeleton)", "").splitlines():
        is_comment = line.strip().startswith("//")
        is_task = "// TODO" in line or (is_task and is_comment)
        if not is_task and line.strip() and "// remove this line" not in line:
            lines.append(line)
    return lines


def test_each_skeleton_has_its_model_answer() -> None:
    assert sorted(ANSWERS) == sorted(CPP_NAMES)


@pytest.mark.parametrize("name", CPP_NAMES)
def test_an_answer_differs_from_its_skeleton_only_where_a_todo_is(name: str) -> None:
    skeleton, answer = skeleton_text(name, is_cpp=True), ANSWERS[name].read_text()
    assert "TODO" in skeleton
    assert "TODO" not in answer
    lines = iter(answer.splitlines())
    assert [line for line in kept(skeleton) if line not in lines] == []


def test_a_skeleton_in_cpp_is_copied(
    cli: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    copied = cli("lab", "skeleton", "talker", "--cpp")
    assert copied.out == "talker.cpp\n"
    assert_line(copied.err, "fill in its TODOs", "compile")
    assert Path("talker.cpp").read_text() == skeleton_text("talker", is_cpp=True)
    assert cli("lab", "skeleton", "--list", "--cpp").out.split() == sorted(CPP_NAMES)
    there_are = "there are kinect_viewer, listener"
    refused = cli("lab", "skeleton", "path_follower", "--cpp")
    assert_line(refused.err, "no skeleton of 'path_follower' in C++", there_are)


def test_a_package_gets_a_skeleton_in_cpp_by_another_name(
    cli: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
def test_the_first_word_is_a_node_or_the_package(
    cli: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    cli("pkg", "create", "lab", "--node", "first")
    added = cli("pkg", "add-node", *words)
    assert (added.code, added.out) == (0, "lab/CMakeLists.txt\nlab/src/watch.cpp\n")
    assert "lcmtools run lab watch" in added.err
    assert cli("pkg", "add-node", "lab", "look").code == 0
    assert Path("lab/lab/look.py").is_file()


@pytest.mark.parametrize("name", CPP_NAMES)
def test_commands_of_a_skeleton_become_those_of_a_package(name: str) -> None:
    text = in_package(skeleton_text(name, is_cpp=True), name, "lab")
    assert_says(text, "lcmtools pkg build lab", f"lcmtools run lab {name}")
    assert "g++" not in text
    assert "msg generate" not in text
