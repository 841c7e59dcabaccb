"""Where launch files and nodes are found."""

import os
from pathlib import Path

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.launch.executables import Executable, find_executable, find_typed
from lcmtools.launch.packages import LABS, find_files, package_folder
from lcmtools.packages.programs import startable


@pytest.fixture
def workspace(folder):
    """``workspace("pkg", "launch/a.launch")``: a package in this folder, with these files."""

    def make(name, *files):
        package = folder / name
        for file in files:
            path = package / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        (package / "pyproject.toml").write_text(
            f'[project]\nname = "{package.name}"\n[project.entry-points."lcmtools.nodes"]\n'
            f'drive = "{package.name}.drive:main"\n[tool.lcmtools]\n'
        )
        return package

    return make


@pytest.mark.parametrize(
    ("words", "path"),
    [
        (["simple_controller.launch"], "air_lab0/launch/simple_controller.launch"),
        (["simple_controller"], "air_lab0/launch/simple_controller.launch"),
        (["air_lab0", "simple_controller.launch"], "air_lab0/launch/simple_controller.launch"),
        (["gazebo_ros", "empty_world.launch"], "gazebo_ros/launch/empty_world.launch"),
        (["pre_assignment2"], "pre_assignment2/launch/pre_assignment2.launch"),
        (["gazebo_ros"], "gazebo_ros/launch/empty_world.launch"),
    ],
)
def test_labs_files_are_found_by_name_and_by_package(folder, words, path):
    assert folder == Path.cwd()
    assert find_files(words) == [LABS / path]


def test_packages_of_ros_are_found_in_ros_package_path(folder, tmp_path_factory, monkeypatch):
    first, second = tmp_path_factory.mktemp("first"), tmp_path_factory.mktemp("second")
    files = {
        first / "deep/er/still/arm": "arm",
        first / "deep/er/still/arm/inner": "in_a_package",
        first / ".hidden/secret": "secret",
        first / "old": "ignored",
        first / "stack": "",
        second / "arm": "arm",
        second / "leg": "leg",
        folder / "near": "leg",
    }
    for path, name in files.items():
        path.mkdir(parents=True)
        if name:
            (path / "package.xml").write_text(f"<package><name>{name}</name></package>")
    (first / "old" / "CATKIN_IGNORE").touch()
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{first}:/nowhere::{second}")
    assert package_folder("arm") == first / "deep/er/still/arm", "the first of two"
    assert package_folder("leg") == folder / "near", "the workspace comes first"
    for name in ("in_a_package", "secret", "ignored"):
        with raises_saying(UsageError, f"there is no package '{name}'"):
            package_folder(name)
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    with raises_saying(UsageError, "there is no package 'arm'"):
        package_folder("arm")


def test_own_package_and_own_file_come_before_the_labs(workspace, folder):
    package = workspace("air_lab0", "launch/simple_controller.launch", "deep/er/b.yaml")
    assert package_folder("air_lab0") == package
    assert find_files(["air_lab0", "simple_controller.launch"]) == [
        package / "launch" / "simple_controller.launch"
    ]
    assert find_files(["air_lab0", "b.yaml"]) == [package / "deep" / "er" / "b.yaml"]
    (folder / "simple_controller.launch").touch()
    assert find_files(["simple_controller.launch"]) == [Path("simple_controller.launch")]


def test_file_here_is_found_without_its_suffix_and_in_the_folder_launch(folder):
    (folder / "launch").mkdir()
    for name in ("a.yaml", "launch/b.launch"):
        (folder / name).touch()
    assert find_files(["a"]) == [Path("a.yaml")]
    assert find_files(["b.launch"]) == find_files(["b"]) == [Path("launch/b.launch")]
    with pytest.raises(InvalidFile, match=r"did you mean b\.launch\?"):
        find_files(["bb.launch"])


def test_package_is_found_from_within_and_below_src(workspace, folder, monkeypatch):
    package = workspace("src/mine", "launch/a.launch")
    assert package_folder("mine") == package
    monkeypatch.chdir(package / "launch")
    assert package_folder("mine") == package
    assert folder in package.parents


def test_installed_package_is_a_package():
    assert package_folder("lcmtools") == LABS.parents[1]


def test_several_files_are_taken_together(folder):
    (folder / "a.yaml").touch()
    (folder / "b.yaml").touch()
    assert find_files(["a.yaml", "b.yaml"]) == [Path("a.yaml"), Path("b.yaml")]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["simple_contoller.launch"], "did you mean simple_controller.launch?"),
        (["nothing"], "there is no launch file nothing; those of the labs: simple_controller"),
        (["air_lab0", "nope"], "there is no launch file nope in the package air_lab0; it has"),
        (["ar_lab0", "a.launch"], "there is no package 'ar_lab0'; did you mean air_lab0?"),
        (["../etc", "passwd"], "there is no package '../etc'"),
        (["here"], "here is a folder, not a launch file"),
        (["a.yaml", "b.yaml"], "there is no launch file b.yaml"),
    ],
)
def test_what_is_not_there_is_told(folder, words, reason):
    (folder / "here").mkdir()
    (folder / "a.yaml").touch()
    with pytest.raises(UsageError) as caught:
        find_files(words)
    assert reason in str(caught.value)


def test_package_with_several_launch_files_names_them(workspace):
    workspace("mine", "launch/a.launch", "launch/b.launch")
    with pytest.raises(InvalidFile, match=r"it has a.launch, b.launch"):
        find_files(["mine"])


@pytest.mark.parametrize(
    ("package", "name", "node"),
    [
        ("lcmtools", "talker", "talker"),
        ("beginner_tutorials", "listener", "listener"),
        ("air_lab0", "evaluate_controller.py", "lcmtools evaluate_controller"),
        ("my_package", "moving_robot", "lcmtools moving_robot"),
        ("gazebo_ros", "gzserver", "sim"),
        ("morse", "morse", "sim"),
    ],
)
def test_nodes_of_the_labs_are_lcmtools_own(folder, package, name, node):
    assert find_executable(package, name, folder).command == ("lcmtools", "run", *node.split())


@pytest.mark.parametrize(
    "tag", ["pkg='air_lab0' type='simple_controller'", "run='simple_controller'"]
)
def test_the_note_on_a_model_answer_is_written_once(plan, tag):
    made = plan(f"<launch><node name='a' {tag}/><node name='b' {tag}/></launch>")
    (note,) = made.notes
    assert_says(note, "a.launch:1", "the lab's model answer")
    for node in made.nodes:  # a node named with its package writes no note
        assert node.command[:4] == ("lcmtools", "run", "lcmtools", "simple_controller")


def test_nodes_of_the_workspace_are_found_from_here_and_from_the_files_folder(
    workspace, folder, monkeypatch
):
    launch = workspace("air_lab0", "launch/a.launch") / "launch"
    expected = ("lcmtools", "run", "air_lab0", "drive")
    assert find_executable("air_lab0", "drive.py", folder) == Executable(expected)
    assert find_typed(["air_lab0", "drive", "x"], folder) == Executable(expected, arguments=("x",))
    monkeypatch.chdir("/")
    assert find_executable("air_lab0", "drive", launch) == Executable(expected, str(launch))
    assert find_typed(["drive"], launch).directory == str(launch)


def test_a_package_of_the_workspace_is_never_replaced_by_lcmtools_own(
    workspace, folder, monkeypatch
):
    package = workspace("air_lab0", "air_lab0/moving_robot.py", "launch/robot.yaml")
    with raises_saying(UsageError, "'simple_controller'", "air_lab0"):
        find_executable("air_lab0", "simple_controller", folder)
    with raises_saying(UsageError, "moving_robot.py", "not a node"):
        find_executable("air_lab0", "moving_robot", folder)
    with raises_saying(InvalidFile, "simple_controller.launch", "air_lab0"):
        find_files(["simple_controller.launch"])
    (package / "launch" / "simple_controller.launch").touch()
    assert find_files(["simple_controller"]) == [package / "launch" / "simple_controller.launch"]
    monkeypatch.chdir("/")
    assert find_files(["simple_controller"])[0].is_relative_to(LABS)


def test_lcmtools_own_node_keeps_its_meaning_where_the_workspace_has_one_of_that_name(
    workspace, folder
):
    project = workspace("mine", "mine/sim.py") / "pyproject.toml"
    project.write_text(project.read_text().replace("drive", "sim"))
    assert find_typed(["sim"], folder).command == ("lcmtools", "run", "sim")
    own = ("lcmtools", "run", "lcmtools", "sim")
    assert find_executable("lcmtools", "sim", folder).command == own
    assert find_executable("gazebo_ros", "gzserver", folder).command == own


def test_executable_file_of_a_package_is_its_node(workspace):
    script = workspace("mine", "scripts/die.py") / "scripts" / "die.py"
    script.write_text("#!/bin/sh\n")
    here = Path.cwd()
    with raises_saying(UsageError, "'die'", "mine", "drive"):
        find_executable("mine", "die", here)
    script.chmod(0o755)
    for name in ("die", "die.py"):
        assert find_executable("mine", name, here) == Executable((str(script),))


def test_what_is_shown_as_lcmtools_is_the_one_that_runs_now():
    program, *rest = startable(["nice", "lcmtools", "run", "talker"])[1:]
    assert rest == ["run", "talker"]
    assert os.access(program, os.X_OK)
    assert startable(["echo", "lcmtools"]) == ["echo", "lcmtools"]
