"""Candidates after ``lcmtools launch``."""

from pathlib import Path

import pytest

from lcmtools.cli.completion.situation import FILES, Situation, candidates
from lcmtools.graph.model import Graph, NodeInfo

GRAPH = Graph(nodes=(NodeInfo("/husky0/driver", "1", "morse", 1),))


def complete(kind, word, given):
    situation = Situation(word, {"words": given}, environment={})
    situation.__dict__["graph"] = GRAPH
    found = candidates(kind, situation)
    return ["files" if one is FILES else one.value for one in found if one.value.startswith(word)]


@pytest.fixture(autouse=True)
def _here(folder):
    """In a workspace of the test's own."""
    assert folder == Path.cwd()


def test_packages_files_of_the_labs_and_all_files_come_first():
    labs = ["simple_controller.launch", "empty_world.launch", "pre_assignment2.launch"]
    assert complete("runnables:launch_words", "", []) == ["some_package", *labs, "files"]


def test_arguments_that_are_not_given_yet_follow_the_file():
    given = ["pre_assignment2.launch", "gui:=true"]
    assert complete("runnables:launch_words", "", given) == ["paused:=", "rate:=", "__ns:="]


def test_files_of_a_package_follow_it():
    assert complete("runnables:launch_words", "", ["air_lab0"])[0] == "simple_controller.launch"


def test_namespaces_on_the_bus_follow_their_mark():
    assert complete("runnables:launch_words", "__ns:=/h", ["simple_controller"]) == [
        "__ns:=/husky0"
    ]


def test_nodes_are_the_files_and_a_broken_file_has_none(folder):
    given = ["simple_controller.launch", "__ns:=/a"]
    assert complete("runnables:launched_nodes", "", given) == ["/a/husky_simple_controller"]
    (folder / "broken.yaml").write_text("nodes: [")
    assert complete("runnables:launched_nodes", "", ["broken.yaml"]) == []
    assert complete("runnables:launch_words", "", ["broken.yaml"]) == ["__ns:="]
