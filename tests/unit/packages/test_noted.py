"""Noted workspaces: their packages are found from everywhere, like installed ones."""

from pathlib import Path

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.launch.packages import LABS, find_files, package_folder
from lcmtools.packages.finding import find_node, find_packages
from lcmtools.packages.noted import VARIABLE, note_workspace, noted_workspaces
from lcmtools.packages.ros_packages import ros_packages
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.user_types import UserTypes
from lcmtools.packages.workspace import noting, workspace
from lcmtools.types.fingerprints import FINGERPRINTS

PROJECT = """\
[project]
name = "{0}"
[project.entry-points."lcmtools.nodes"]
{1} = "{0}.{1}:main"
[tool.lcmtools]
"""


@pytest.fixture
def home(tmp_path):
    """An environment with nothing but a home."""
    return {"HOME": str(tmp_path)}


def file_of(home):
    return Path(home["HOME"], ".config/lcmtools/workspaces")


def test_new_workspace_is_noted_before_the_others(tmp_path, home):
    for name in ("one", "two words"):
        (tmp_path / name).mkdir()
        assert note_workspace(tmp_path / name, home)
    assert note_workspace(tmp_path / "one", home)
    noted = noted_workspaces(home)
    assert noted.folders == [tmp_path / "two words", tmp_path / "one"]
    assert noted.source == str(file_of(home))
    lines = file_of(home).read_text().splitlines()
    assert lines[0].startswith("# Workspaces: ")
    assert lines[2:] == [f"{tmp_path}/two words", f"{tmp_path}/one"]


def test_workspace_that_is_gone_is_ignored_and_then_forgotten(tmp_path, home):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        note_workspace(tmp_path / name, home)
    (tmp_path / "one").rmdir()
    assert noted_workspaces(home).folders == [tmp_path / "two"]
    (tmp_path / "three").mkdir()
    note_workspace(tmp_path / "three", home)
    assert "/one" not in file_of(home).read_text()


def test_the_variable_replaces_the_file(tmp_path, home):
    for name in ("one", "two", "three"):
        (tmp_path / name).mkdir()
    note_workspace(tmp_path / "one", home)
    named = {**home, VARIABLE: f"{tmp_path}/two:{tmp_path}/lost::{tmp_path}/two"}
    assert noted_workspaces(named) == ([tmp_path / "two"], VARIABLE)
    assert note_workspace(tmp_path / "two", named)
    assert not note_workspace(tmp_path / "three", named)
    assert noted_workspaces({**home, VARIABLE: ""}).folders == [tmp_path / "one"]


def test_without_a_home_or_with_a_colon_nothing_is_noted(tmp_path, home):
    assert noted_workspaces({}) == ([], "")
    assert not note_workspace(tmp_path, {})
    (tmp_path / "a:b").mkdir()
    assert not note_workspace(tmp_path / "a:b", home)


def test_file_that_cannot_be_written_is_named(tmp_path, home):
    (tmp_path / ".config").write_text("")
    with raises_saying(LcmtoolsError, f"cannot write {file_of(home)}"):
        note_workspace(tmp_path, home)


@pytest.mark.parametrize("place", ["ws", "ws/src", "ws/a"])
def test_package_of_a_noted_workspace_is_found_from_everywhere(write, monkeypatch, place):
    package = "ws/src/a" if place != "ws/a" else "ws/a"
    root = write({f"{package}/pyproject.toml": PROJECT.format("a", "drive"), "else/x": ""})
    monkeypatch.setenv(VARIABLE, str(root / place))
    (found,) = workspace(root / "else").packages
    assert found == ("a", root / package, True)
    known = runnables(root / "else")
    for words in (["a", "drive", "x"], ["drive", "x"]):
        node, rest = find_node(words, known, root / "else")
        assert (node.package, node.name, node.is_near, rest) == ("a", "drive", False, ["x"])
    assert [one.name for one in find_packages(None, root / "else")] == ["a"]
    assert package_folder("a", root / "else") == root / package


def test_packages_around_come_first_and_alone_without_a_name(write, monkeypatch):
    root = write(
        {
            "old/a/pyproject.toml": PROJECT.format("a", "drive"),
            "old/b/pyproject.toml": PROJECT.format("b", "stop"),
            "new/a/pyproject.toml": PROJECT.format("a", "drive"),
        }
    )
    monkeypatch.setenv(VARIABLE, str(root / "old"))
    found = {one.name: one for one in workspace(root / "new").packages}
    assert found["a"] == ("a", root / "new" / "a", False)
    assert found["b"].is_noted
    assert [one.name for one in find_packages(None, root / "new")] == ["a"]
    assert [one.name for one in find_packages("b", root / "new")] == ["b"]


def test_noted_package_replaces_nothing_of_lcmtools(write, monkeypatch):
    root = write(
        {
            "ws/mine/pyproject.toml": PROJECT.format("mine", "talker"),
            "ws/mine/launch/simple_controller.launch": "<launch/>",
            "ws/mine/mine/listener.py": "def main(): pass\n",
            "ws/mine/launch/mine.launch": "<launch/>",
            "ws/broken/pyproject.toml": "[tool.lcmtools]\nname = = 3\n",
            "else/x": "",
        }
    )
    monkeypatch.setenv(VARIABLE, str(root / "ws"))
    monkeypatch.chdir(root / "else")
    known = runnables(Path.cwd())
    for name in ("talker", "listener"):
        assert find_node([name], known, Path.cwd())[0].package == "lcmtools"
    with raises_saying(UsageError, "listener.py is not a node yet"):
        find_node(["mine", "listener"], known, Path.cwd())
    assert find_files(["simple_controller"])[0].is_relative_to(LABS)
    assert find_files(["mine"]) == [root / "ws/mine/launch/mine.launch"]


def test_types_of_a_noted_package_come_before_shipped_ones(write, cache_folder):
    root = write(
        {
            "ws/air_lab0/pyproject.toml": PROJECT.format("air_lab0", "drive"),
            "ws/air_lab0/air_lab0/msg/Stat.lcm": "package air_lab0; struct Stat { double last; }",
        }
    )
    environment = {VARIABLE: f"{root}/ws", "XDG_CACHE_HOME": str(cache_folder)}
    source = UserTypes(environment, [], FINGERPRINTS).workspace()
    assert source is not None
    assert list(source.fingerprints) == ["air_lab0/Stat"]


def test_ros_packages_of_a_noted_workspace_are_found(write, monkeypatch):
    xml = "<package><name>rover</name></package>"
    root = write({"ws/src/group/rover/package.xml": xml, "else/x": ""})
    monkeypatch.setenv(VARIABLE, str(root / "ws"))
    assert ros_packages(root / "else") == {"rover": root / "ws/src/group/rover"}


def test_package_itself_is_noted_where_its_workspace_would_not_be_searched(write):
    root = write({"ws/a/pyproject.toml": PROJECT.format("a", "drive")})
    package = root / "ws" / "a"
    assert noting(package) == root / "ws"
    (root / "ws").chmod(0o1777)
    assert noting(package) == package
    (root / "ws").chmod(0o755)
    for number in range(301):
        (root / "ws" / str(number)).mkdir()
    assert noting(package) == package
