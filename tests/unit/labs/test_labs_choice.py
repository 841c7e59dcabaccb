"""The programs that a check takes: the files of the current folder, and those that are named."""

import re
import sys
from pathlib import Path

import pytest

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks.choice import choose
from lcmtools.packages.create import NewPackage, create

PYTHON = Path(sys.executable).name
DRIVES = "self.create_subscription(Odometry, 'odometry', ...); desired_velocity, velocity_cmd"
MAIN = "int main() {}"
PACKAGE = "create"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(files):
    for name, text in files.items():
        if text == PACKAGE:
            create(NewPackage(name, "simple_controller"), Path(name).absolute())
        else:
            Path(name).write_text(text)
            Path(name).chmod(0o755 if text.startswith("\x7f") else 0o644)


@pytest.mark.parametrize(
    ("files", "command", "says"),
    [
        ({}, "lcmtools run simple_controller", "there is no simple_controller or evaluate_contr"),
        ({"notes.txt": "controller"}, "lcmtools run simple_controller", "the model answers"),
        ({"controller_plan.py": "print(1)"}, "lcmtools run simple_controller", "model answers"),
        (
            {"simple_controller.py": ""},
            f"{PYTHON} simple_controller.py",
            "takes simple_controller.py; there is no evaluate_controller here",
        ),
        ({"my_controller.py": DRIVES}, f"{PYTHON} my_controller.py", "takes my_controller.py;"),
        (
            {"my_controller.py": DRIVES, "simple_controller.py": ""},
            f"{PYTHON} my_controller.py",
            "lab check husky simple_controller.py takes that one",
        ),
        ({"simple_controller.cpp": MAIN}, "simple_controller.cpp", "takes simple_controller.cpp;"),
        (
            {"simple_controller": "\x7fELF", "simple_controller.cpp": MAIN},
            "simple_controller.cpp",
            "takes simple_controller.cpp; there is no evaluate_controller here",
        ),
        ({"simple_controller": "\x7fELF"}, "./simple_controller", "takes simple_controller;"),
        (
            {"simple_controller.cpp": MAIN, "simple_controller.py": ""},
            f"{PYTHON} simple_controller.py",
            "lab check husky simple_controller.cpp takes that one",
        ),
        ({"lab": PACKAGE}, "lcmtools run lab simple_controller", "of the package lab;"),
        (
            {"lab": PACKAGE, "simple_controller.py": ""},
            f"{PYTHON} simple_controller.py",
            "takes simple_controller.py;",
        ),
    ],
)
def test_the_programs_of_the_current_folder_are_checked(files, command, says):
    write(files)
    runs, found = choose(LABS["husky"], {})
    assert " ".join(runs[0].command).partition(" __ns")[0] == command
    assert says in found


def test_within_a_package_its_nodes_are_checked_and_not_their_files(folder, monkeypatch):
    write({"lab": PACKAGE})
    monkeypatch.chdir(folder / "lab" / "lab")
    (run,), _ = choose(LABS["husky"], {})
    assert run.command[:4] == ["lcmtools", "run", "lab", "simple_controller"]


@pytest.mark.parametrize(
    ("name", "text", "option", "command"),
    [
        ("simple_controller.py", "", "controller", f"{PYTHON} simple_controller.py"),
        ("evaluate_controller.py", "", "evaluator", f"{PYTHON} evaluate_controller.py"),
        ("mine.py", DRIVES, "controller", f"{PYTHON} mine.py"),
        ("mine.py", "evaluation_stat ControllerEvaluationStat", "evaluator", f"{PYTHON} mine.py"),
        ("mine.cpp", f"// odometry velocity_cmd\n{MAIN}", "controller", "mine.cpp"),
    ],
)
def test_a_file_is_checked_as_the_program_that_it_is(name, text, option, command):
    write({name: text})
    (run,), found = choose(LABS["husky"], {}, [name])
    assert (run.program.option, found) == (option, "")
    assert " ".join(run.command).partition(" __ns")[0] == command
    by_option, _ = choose(LABS["husky"], {option: name})
    assert by_option == [run]


@pytest.mark.parametrize(
    ("files", "given", "says"),
    [
        (
            {"simple_controller.py": ""},
            ["simple_contoller.py"],
            "did you mean simple_controller.py?",
        ),
        ({"mine.py": "x"}, ["mine.py"], "say which it is: --controller mine.py or --evaluator"),
        ({"mine.txt": "x"}, ["mine.txt"], "mine.txt is not a program; chmod +x mine.txt"),
        ({"my_controller.cpp": "x"}, ["my_controller.cpp"], "it has no function main"),
        (
            {"a_controller.py": "", "b_controller.py": ""},
            ["a_controller.py", "b_controller.py"],
            "b_controller.py are both for --controller",
        ),
    ],
)
def test_a_file_that_cannot_be_checked_is_refused(files, given, says):
    write(files)
    with pytest.raises(UsageError, match=re.escape(says)):
        choose(LABS["husky"], {}, given)
