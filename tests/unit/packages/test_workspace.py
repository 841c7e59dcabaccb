"""Which folders are packages, and which workspace one is in."""

import errno
import os
from pathlib import Path

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.packages.finding import find_node
from lcmtools.packages.runnable_nodes import Runnable, runnables
from lcmtools.packages.workspace import workspace

PROJECT = '[project]\nname = "{}"\n[tool.lcmtools]\n'
NODES = '[project]\nname = "{0}"\n[project.entry-points."lcmtools.nodes"]\n{1}\n[tool.lcmtools]\n'


def names(*starts):
    return [package.name for package in workspace(*starts).packages]


@pytest.mark.parametrize("place", ["ws", "ws/a", "ws/a/a/msg", "ws/src", "ws/src/b", "ws/notes"])
def test_workspace_is_found_from_everywhere_in_it(place, write):
    root = write(
        {
            "ws/a/pyproject.toml": PROJECT.format("a"),
            "ws/a/a/msg/x.lcm": "",
            "ws/src/b/pyproject.toml": PROJECT.format("b-c"),
            "ws/notes/x.txt": "",
            "ws/other/pyproject.toml": '[project]\nname = "other"\n',
        }
    )
    assert names(root / place) == (["b_c"] if place.startswith("ws/src") else ["a", "b_c"])


@pytest.mark.parametrize("place", ["ws", "ws/src/repo/a", "ws/src/repo"])
def test_packages_in_a_repository_in_src_are_found(place, write):
    root = write(
        {
            "ws/src/repo/a/pyproject.toml": PROJECT.format("a"),
            "ws/src/b/pyproject.toml": PROJECT.format("b"),
            "ws/src/b/inner/pyproject.toml": PROJECT.format("inner"),
        }
    )
    assert names(root / place) == ["a", "b"]


def test_outside_there_is_none(write):
    root = write({"ws/a/pyproject.toml": PROJECT.format("a"), "else/where/x": ""})
    assert names(root / "else" / "where") == []


def test_a_folder_that_everybody_writes_concerns_only_who_is_in_it(write):
    root = write({"all/a/pyproject.toml": PROJECT.format("a"), "all/mine/x": "", "all/a/b/x": ""})
    (root / "all").chmod(0o1777)
    assert names(root / "all" / "mine") == []
    assert names(root / "all") == names(root / "all" / "a" / "b") == ["a"]


def test_a_folder_that_cannot_be_looked_into_stops_nobody(write, monkeypatch):
    root = write({"ws/a/pyproject.toml": PROJECT.format("a"), "ws/lost+found/x": ""})
    look = Path.stat

    def refused(path, **how):
        if path.parent.name == "lost+found":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return look(path, **how)

    monkeypatch.setattr(Path, "stat", refused)
    assert names(root / "ws") == ["a"]


def test_a_broken_package_stops_no_other(write):
    root = write(
        {
            "a/pyproject.toml": PROJECT.format("a"),
            "b/pyproject.toml": "[tool.lcmtools]\nname = = 3\n",
            "c/pyproject.toml": "[tool.lcmtools]\n",
            "d/pyproject.toml": PROJECT.format("../d"),
        }
    )
    found = workspace(root)
    assert [package.name for package in found.packages] == ["a"]
    told = [str(problem) for problem in found.problems]
    assert_says(told[0], f"{root}/b/pyproject.toml:2: ", "not TOML")
    assert_says(told[1], f"{root}/c/pyproject.toml: ", "name", "; write ")
    assert_says(told[2], f"{root}/d/pyproject.toml: ", "name", "; write ")


def test_folders_of_other_users_are_not_taken(write, monkeypatch):
    root = write({"a/pyproject.toml": PROJECT.format("a")})
    owner = (root / "a").stat().st_uid
    monkeypatch.setattr("os.getuid", lambda: owner + 1)
    assert names(root) == ([] if owner else ["a"]), "root's are everybody's"


def test_nodes_come_from_the_workspace_and_from_what_is_installed(write):
    root = write({"a/pyproject.toml": NODES.format("a", 'go = "a.go:main"')})
    found = {(node.package, node.name) for node in runnables(root)}
    assert {("a", "go"), ("lcmtools", "talker"), ("lcmtools", "sim")} <= found


def test_a_node_that_is_no_function_says_so_when_it_is_loaded(write):
    root = write({"a/pyproject.toml": NODES.format("a", 'go = "a/go.py"\nstop = "a:stop"')})
    go, stop = (node for node in runnables(root) if node.package == "a")
    assert (go.name, stop.name) == ("go", "stop")
    with raises_saying(LcmtoolsError, "'a/go.py'", "function", '; write  go = "a.go:main" '):
        go.load()


MAIN = "def main(args=None):\n    pass\n"


def said_of(*words):
    """Return what the user reads who types these words in the current folder."""
    here = Path.cwd()
    with pytest.raises(UsageError) as caught:
        find_node(words, runnables(here), here)
    return str(caught.value)


def test_nodes_of_the_workspace_have_precedence_over_lcmtools_own(write, monkeypatch):
    files = {
        "ws/a/pyproject.toml": NODES.format("a", 'talker = "a.talker:main"'),
        "ws/b/pyproject.toml": NODES.format("b", 'sim = "b:main"'),
        "elsewhere/x": "",
    }
    root = write(files)
    for folder, package in (("ws", "a"), ("ws/b", "a"), ("elsewhere", "lcmtools")):
        monkeypatch.chdir(root / folder)
        node, rest = find_node(["talker", "x"], runnables(Path.cwd()), Path.cwd())
        assert (node.package, rest) == (package, ["x"])
    monkeypatch.chdir(root / "ws")
    for words in (["lcmtools", "sim"], ["listener"]):
        assert find_node(words, runnables(Path.cwd()), Path.cwd())[0].package == "lcmtools"


def test_a_file_that_is_no_node_yet_is_named_with_the_line_that_is_missing(write, monkeypatch):
    root = write(
        {
            "a/pyproject.toml": NODES.format("a", 'go = "a:main"'),
            "a/a/talker.py": MAIN,
            "a/a/listener.py": "TEXTS = 3\n",
            "b/pyproject.toml": NODES.format("b", 'go = "b:main"'),
            "b/src/b/drive.py": MAIN,
        }
    )
    monkeypatch.chdir(root)
    table = '[project.entry-points."lcmtools.nodes"]'
    missing = (
        f'a/a/talker.py is not a node yet; write  talker = "a.talker:main"  in {table}'
        " of a/pyproject.toml, or type: lcmtools pkg add-node talker"
    )
    assert said_of("talker") == said_of("a", "talker") == said_of("a", "talker.py") == missing
    assert_says(said_of("drive"), "b/src/b/drive.py", "not a node", "; write  drive = ")
    parts = ("a/a/listener.py", "not a node", "main(args=None)", "write  listener =")
    assert_says(said_of("a", "listener"), *parts)
    node, _ = find_node(["listener"], runnables(root), root)
    assert node.package == "lcmtools", "a module beside that is no program hides nothing"


def test_a_file_in_a_package_with_a_broken_description_is_not_passed_over(write, monkeypatch):
    root = write({"a/pyproject.toml": "[tool.lcmtools]\n[project\n", "a/a/talker.py": MAIN})
    monkeypatch.chdir(root)
    broken = "a/a/talker.py is not a node yet; "
    assert_says(said_of("talker"), broken, f"{root}/a/pyproject.toml:2: ", "not TOML")


KNOWN = [
    Runnable("lab", "drive", "lab:main"),
    Runnable("lab", "talker", "lab:main"),
    Runnable("lcmtools", "talker", "lcmtools:main"),
    Runnable("other", "drive", "other:main"),
    Runnable("same", "same", "same:main"),
]


@pytest.mark.parametrize(
    ("words", "package", "name", "rest"),
    [
        (["lab", "drive", "a"], "lab", "drive", ["a"]),
        (["lab", "talker"], "lab", "talker", []),
        (["talker", "lab"], "lcmtools", "talker", ["lab"]),
        (["same"], "same", "same", []),
        (["same", "same", "same"], "same", "same", ["same"]),
        (["same", "__ns:=/a"], "same", "same", ["__ns:=/a"]),
    ],
)
def test_words_mean_a_node(words, package, name, rest):
    node, left = find_node(words, KNOWN)
    assert (node.package, node.name, left) == (package, name, rest)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["drive"], "several packages have a node 'drive'; write lab drive or other drive"),
        (["lab", "drvie"], "the package lab has no node 'drvie'; did you mean drive?"),
        (["lab", "x"], "the package lab has no node 'x'; it has drive, talker"),
        (["lob", "drive"], "there is no package 'lob'; did you mean lab?"),
        (
            ["arm", "talker"],
            "there is no package 'arm'; lab and lcmtools have such a node: lcmtools run talker",
        ),
        (["talkre"], "there is no node 'talkre'; did you mean talker?"),
    ],
)
def test_words_that_mean_no_node_get_a_hint(words, said):
    with pytest.raises(UsageError) as caught:
        find_node(words, KNOWN)
    assert str(caught.value) == said
