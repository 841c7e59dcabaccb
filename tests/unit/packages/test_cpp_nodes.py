"""Nodes in C++: declared in CMakeLists.txt, added to a package, found before and after building."""

import os
from pathlib import Path

import pytest
from fixtures.says import raises_saying

from lcmtools.cli.completion.runnables import arguments
from lcmtools.cli.completion.situation import Situation
from lcmtools.errors import InvalidName, UsageError
from lcmtools.launch.executables import find_executable, find_typed
from lcmtools.packages.add_node import add_cpp_node, add_node, cpp_source
from lcmtools.packages.cpp_nodes import (
    cpp_sources,
    cpp_summary,
    included,
    parts_of,
    undeclared_sources,
    wrong_include,
)
from lcmtools.packages.create import NewPackage, create
from lcmtools.packages.finding import find_node
from lcmtools.packages.programs import built_program, files_below
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import workspace

MAIN = "// Look around.\n#include <nav_msgs/Path.hpp>\nint main() {}\n"


@pytest.fixture
def package(tmp_path, monkeypatch):
    create(NewPackage("lab", "drive", dependencies=("nav_msgs",)), tmp_path / "lab")
    monkeypatch.chdir(tmp_path)
    return workspace(tmp_path).packages[0]


def built(package, name, place="build"):
    program = package.folder / place / name
    program.parent.mkdir(parents=True, exist_ok=True)
    program.touch(mode=0o755)
    return program


def look(package):
    add_cpp_node(package, "look", cpp_source(package, "look.cpp", package.folder))
    return next(node for node in runnables(package.folder) if node.name == "look")


@pytest.mark.parametrize(
    ("text", "sources"),
    [
        ("add_executable(look src/look.cpp)", {"look": "src/look.cpp"}),
        ("Add_Executable (\n  look\n  src/a.h src/look.cc src/b.cpp\n)", {"look": "src/look.cc"}),
        ("add_executable(a b.cpp)\nadd_executable(c d.cxx)", {"a": "b.cpp", "c": "d.cxx"}),
        ("add_executable(a ${CMAKE_CURRENT_SOURCE_DIR}/src/a.cpp)", {"a": "src/a.cpp"}),
        ("# add_executable(look src/look.cpp)", {}),
        ("add_executable(look IMPORTED)", {}),
        ("add_executable(${name} a.cpp)", {}),
        ("add_library(look src/look.cpp)", {}),
        ("add_executable(look src/look.cpp", {}),
    ],
)
def test_executables_of_a_project_are_nodes(tmp_path, text, sources):
    assert cpp_sources(tmp_path) == {}
    (tmp_path / "CMakeLists.txt").write_text(text)
    assert cpp_sources(tmp_path) == {name: tmp_path / file for name, file in sources.items()}


@pytest.mark.parametrize(
    ("text", "summary"),
    [
        ("// Look around.\n// And more.\n", "Look around."),
        ("\n/* Look around. */\n", "Look around."),
        ("/**\n * Look around.\n */\n", "Look around."),
        ("#include <a>\n// Look around.\n", ""),
        ("", ""),
    ],
)
def test_the_first_comment_of_a_source_is_its_summary(tmp_path, text, summary):
    (tmp_path / "a.cpp").write_text(text)
    assert cpp_summary(tmp_path / "a.cpp") == summary
    assert cpp_summary(tmp_path / "missing.cpp") == ""


def test_packages_of_included_types_are_known():
    text = (
        "#include <lcmtools/node.hpp>\n#include <geometry_msgs/Twist.hpp>\n"
        '  # include "geometry_msgs/Point.hpp"\n// #include <sensor_msgs/Image.hpp>\n'
        "#include <nlohmann/json.hpp>\n#include <std_msgs/String.hpp>\n"
        '#include <nav_msgs/Odometry.h>\n#include "tf2_msgs/msg/tf_message.hpp"\n'
    )
    known = ["sensor_msgs", "std_msgs", "geometry_msgs", "nav_msgs", "tf2_msgs"]
    assert included(text, known) == ["geometry_msgs", "std_msgs", "nav_msgs", "tf2_msgs"]


@pytest.mark.parametrize(
    ("include", "says"),
    [
        ("<nav_msgs/Path.hpp>", ""),
        ("<geometry_msgs/Twist.hpp>", ""),  # generated alone
        ("<nlohmann/json.h>", ""),
        ("<std_msgs/String.hpp>", ": add std_msgs to lcmtools_generate(look ...)"),
        ("<nav_msgs/Path.h>", ", as in ROS; here it is <nav_msgs/Path.hpp>"),
        ('"nav_msgs/msg/path.hpp"', ", as in ROS; here it is <nav_msgs/Path.hpp>"),
        ('"std_srvs/srv/set_bool.hpp"', ", as in ROS; here it is <std_srvs/SetBool.hpp>"),
        ("<ros/node_handle.h>", ", as in ROS; here it is <lcmtools/node.hpp>"),
        ('"rclcpp/rclcpp.hpp"', ", as in ROS; here it is <lcmtools/node.hpp>"),
    ],
)
def test_an_include_that_cannot_be_found_is_explained(tmp_path, include, says):
    (tmp_path / "look.cpp").write_text(f"#include <nav_msgs/Path.hpp>\n#include {include}\n")
    project = (
        "add_executable(look look.cpp)\nlcmtools_generate(look nav_msgs geometry_msgs/Twist)\n"
    )
    (tmp_path / "CMakeLists.txt").write_text(project)
    known = ["nav_msgs", "std_msgs", "std_srvs", "geometry_msgs"]
    said = wrong_include(tmp_path, known)
    assert said == (f"look.cpp includes <{include[1:-1]}>{says}" if says else "")


def test_sources_that_are_no_nodes_yet_are_known(package):
    look(package)
    for name, text in (("see.cpp", MAIN), ("part.cpp", "int x;\n")):
        (package.folder / "src" / name).write_text(text)
    assert undeclared_sources(package.folder) == [package.folder / "src" / "see.cpp"]


def test_a_source_that_is_newer_than_its_program_is_noted(package, start, lcmtools_path):
    source, program = look(package).source, built(package, "look")
    assert source is not None
    program.write_text("#!/bin/sh\necho runs with $1\n")
    for time, note in (
        (1, ""),
        (1e10, "look.cpp is newer than its program: lcmtools pkg build lab"),
    ):
        os.utime(source, (time, time))
        run = start(lcmtools_path, "run", "lab", "look", "x")
        assert run.wait(20) == 0
        assert "runs with x" in run.output
        assert ("newer" in run.output, note in run.output) == (bool(note), True)


def test_a_new_node_in_cpp_gets_a_source_and_its_lines(package):
    project, source = package.folder / "CMakeLists.txt", package.folder / "src" / "look.cpp"
    assert source.parent.is_dir()  # as a new package has it
    assert add_cpp_node(package, "look", source) == [project, source]
    assert 'Look() : Node("look")' in source.read_text()
    entry = (
        "add_executable(look src/look.cpp)\ntarget_link_libraries(look PRIVATE lcmtools::lcmtools)"
        "\nlcmtools_generate(look nav_msgs std_msgs)\n"
    )
    text = project.read_text()
    assert text.endswith(f"\n{entry}")
    add_cpp_node(package, "see", package.folder / "src" / "see.cpp")
    assert project.read_text() == f"{text}\n{entry.replace('look', 'see')}"
    create(NewPackage("other", "look", dependencies=("nav_msgs",), is_cpp=True), Path("other"))
    assert Path("other/CMakeLists.txt").read_text() == text.replace("lab", "other")


def test_the_parts_of_a_source_are_declared_with_it(package):
    texts = {
        "look.cpp": f'#include "pid.hpp"\n  # include "own/eye.h"\n#include <own/not.hpp>\n{MAIN}',
        "pid.hpp": '#include "missing.hpp"\n#include "text.cpp"',
        "pid.cc": '#include "pid.hpp"\n#include <std_msgs/String.hpp>',
        "text.cpp": "int text;",
        "own/eye.h": '#include "../look.hpp"',
        "look.hpp": '#include "pid.hpp"',
        "own/eye.cpp": MAIN,  # a program of its own
        "unfinished.cpp": "int x = ;",
    }
    source = package.folder / "src" / "look.cpp"
    for name, text in texts.items():
        (source.parent / name).parent.mkdir(exist_ok=True)
        (source.parent / name).write_text(text)
    names = ["look.cpp", "pid.hpp", "pid.cc", "own/eye.h", "look.hpp"]
    assert [one.relative_to(source.parent).as_posix() for one in parts_of(source)] == names
    add_cpp_node(package, "look", source)
    declared = (package.folder / "CMakeLists.txt").read_text()
    assert f"add_executable(look {' '.join(f'src/{name}' for name in names)})" in declared
    assert "lcmtools_generate(look nav_msgs std_msgs)" in declared
    assert cpp_sources(package.folder) == {"look": source}


def test_a_source_that_is_there_is_only_declared(package):
    source = package.folder / "src" / "look.cpp"
    source.write_text("int x;\n")
    with raises_saying(UsageError, "src/look.cpp has no function main", "int main("):
        add_cpp_node(package, "look", source)
    assert not (package.folder / "CMakeLists.txt").exists()
    source.write_text(MAIN)
    assert add_cpp_node(package, "look", source) == [package.folder / "CMakeLists.txt"]
    assert source.read_text() == MAIN
    assert "lcmtools_generate(look nav_msgs)" in (package.folder / "CMakeLists.txt").read_text()
    for file, name in ((source, "look"), (package.folder / "src/drive.cpp", "drive")):
        with raises_saying(UsageError, "lab has a node", f"'{name}' already"):
            add_cpp_node(package, name, file)
    with raises_saying(UsageError, "lab has a node 'look' already", "src/look.cpp"):
        add_node(package, "look")
    with raises_saying(UsageError, "look.cpp already exists", "--force"):
        add_cpp_node(package, "look", source, MAIN)
    assert add_cpp_node(package, "look", source, "new", replace=True) == [source]


@pytest.mark.parametrize("name", ["Look", "test", "all", "class"])
def test_names_that_no_node_in_cpp_can_have_are_refused(package, name):
    with pytest.raises(InvalidName):
        add_cpp_node(package, name, package.folder / "src" / "look.cpp")


@pytest.mark.parametrize(
    ("typed", "here", "place"),
    [
        ("look.cpp", ".", "src/look.cpp"),
        ("look.cpp", "lab/src", "src/look.cpp"),
        ("nodes/look.cpp", ".", "nodes/look.cpp"),
        ("nodes/look.cpp", "lab", "nodes/look.cpp"),
        ("there.cpp", ".", "there.cpp"),
        ("lab/there.cpp", ".", "there.cpp"),
        ("../there.cpp", "lab/src", "there.cpp"),
    ],
)
def test_a_source_is_found_or_placed_in_the_package(package, typed, here, place):
    (package.folder / "there.cpp").touch()
    assert cpp_source(package, typed, Path.cwd() / here) == package.folder / place


@pytest.mark.parametrize("typed", ["outside.cpp", "../../else.cpp"])
def test_a_source_outside_the_package_is_refused(package, typed):
    Path("outside.cpp").touch()
    with raises_saying(UsageError, "outside the package lab", "move it into lab/src"):
        cpp_source(package, typed, Path.cwd())


def test_a_node_that_is_not_built_names_the_command(package):
    node = look(package)
    said = "the node 'look' of lab is not built", "lcmtools pkg build lab"
    with raises_saying(UsageError, *said):
        built_program(node)
    with raises_saying(UsageError, *said):
        find_typed(["lab", "look"], Path.cwd())
    with raises_saying(UsageError, *said):
        find_executable("lab", "look", Path.cwd())


def test_the_program_of_a_node_is_its_own_and_not_a_trial_of_cmake(package):
    node = look(package)
    elsewhere, trial = built(package, "look", "other"), built(package, "look", "build/CMakeFiles/4")
    assert built_program(node) == elsewhere
    usual = built(package, "look")
    assert built_program(node) == usual
    assert trial not in files_below(package.folder)
    assert find_typed(["lab", "look", "x"], Path.cwd()).command == (str(usual),)
    assert find_typed(["lab", "look", "x"], Path.cwd()).arguments == ("x",)
    assert find_executable("lab", "look", Path.cwd()).command == (str(usual),)


def test_nodes_in_cpp_are_listed_and_completed(package):
    node = look(package)
    assert node.summary() == "Count the messages on a topic."
    situation = Situation("", {"name": ("lab",), "arguments": ()}, {})
    assert [one.value for one in arguments(situation)] == ["drive", "look"]


def test_an_undeclared_source_is_named_with_the_command(package):
    source = package.folder / "src" / "look.cpp"
    for text, hint in (("int x;\n", "no main"), (MAIN, "lcmtools pkg add-node look.cpp")):
        source.write_text(text)
        with raises_saying(UsageError, "lab/src/look.cpp is not a node yet", hint):
            find_node(["lab", "look"], runnables(Path.cwd()), Path.cwd())
