"""Bodies that start inside another one are reported by ``run sim --check``. Metres."""

import sys

import pytest

from lcmtools_sim.__main__ import main

ROBOTS = """\
robots:
  - {model: husky, namespace: /a}
  - {model: husky, namespace: /b, pose: [0.3, 0, 0]}
"""
THINGS = """\
objects:
  - {type: box, name: shed, size: [2, 2, 2], pose: [3, 0, 0]}
  - {type: box, name: stack, size: [1, 1, 0.5], pose: [3, 0, 2.25, 0, 0, 0], mass: 5}
  - {type: sphere, name: ball, radius: 0.5, pose: [3, 1.25, 0], mass: 1}
  - {type: box, name: sunk, size: [1, 1, 1], pose: [-5, 0, 0, 0, 0, 0], mass: 1}
  - {type: box, name: wing, size: [2, 2, 2], pose: [4, 0, 0]}
"""


@pytest.fixture
def yard(tmp_path):
    return tmp_path / "yard.yaml"


def test_two_robots_that_start_inside_one_another_are_a_mistake_in_the_file(yard, capsys):
    yard.write_text(ROBOTS)
    assert main(["--check", str(yard)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    told = f"lcmtools run sim: {yard}:3: the husky /b starts 0.25 m inside /a; change its pose\n"
    assert captured.err == told


def test_movable_objects_that_start_inside_something_are_warned_of_and_others_not(yard, capsys):
    yard.write_text(THINGS)
    assert main(["--check", str(yard)]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        f"lcmtools run sim: {yard}:{line}: {fault}, and is thrown out of it"
        for line, fault in [
            (4, "ball starts 0.25 m inside shed"),
            (5, "sunk starts 0.50 m inside the ground"),
        ]
    ]


def test_without_an_engine_the_rest_is_checked_and_that_is_said(yard, capsys, monkeypatch):
    for package in ("pybullet", "mujoco"):
        monkeypatch.setitem(sys.modules, package, None)
    yard.write_text(ROBOTS)
    assert main(["--check", str(yard)]) == 0
    captured = capsys.readouterr()
    assert captured.out == f"{yard}: ok, husky /a, husky /b; 0 objects\n"
    assert captured.err.count("\n") == 1
    assert "is not checked without an engine" in captured.err


@pytest.mark.parametrize("option", ["--check", "--print-world"])
def test_an_empty_name_is_no_world_and_starts_nothing(option, capsys):
    assert main([option, ""]) == 2
    assert capsys.readouterr().err.startswith("lcmtools run sim: there is no world ''")
