"""Programs of packages: executable files, found as rosrun finds them."""

import sys
from pathlib import Path

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import UsageError
from lcmtools.packages.programs import command_of, find_program, programs_in

PROJECT = '[project]\nname = "air_lab0"\n[tool.lcmtools]\n'


@pytest.fixture
def package(write):
    """A package with a script in src, as the Husky text has it, and a module."""
    root = write(
        {
            "air_lab0/pyproject.toml": PROJECT,
            "air_lab0/src/evaluate_controller.py": "#!/usr/bin/env python\n",
            "air_lab0/air_lab0/__init__.py": "",
            "air_lab0/air_lab0/part.py": "",
        }
    )
    return root / "air_lab0"


@pytest.mark.parametrize("place", ["src", "scripts", ".", "build/deep"])
@pytest.mark.parametrize("name", ["evaluate_controller.py", "evaluate_controller"])
def test_an_executable_file_is_found_anywhere_in_a_package(package, place, name):
    script = package / place / "evaluate_controller.py"
    script.parent.mkdir(parents=True, exist_ok=True)
    (package / "src" / "evaluate_controller.py").rename(script)
    script.chmod(0o755)
    assert find_program(["air_lab0", name, "x"], package.parent) == script
    assert programs_in(package) == [script]


def test_a_file_that_is_not_executable_is_named_with_the_command(package):
    with raises_saying(UsageError, "src/evaluate_controller.py is not executable", "chmod +x "):
        find_program(["air_lab0", "evaluate_controller.py"], package.parent)


def test_a_module_is_no_program(package):
    assert find_program(["air_lab0", "part"], package.parent) is None
    assert find_program(["air_lab0"], package.parent) is None
    assert find_program(["other", "part"], package.parent) is None


def test_several_programs_of_one_name_are_named(package, monkeypatch):
    monkeypatch.chdir(package)
    for place in ("src", "scripts", "build", ".hidden"):
        (package / place).mkdir(exist_ok=True)
        (package / place / "drive").touch(mode=0o755)
    choices = "lcmtools run scripts/drive or lcmtools run src/drive"
    with raises_saying(UsageError, "several programs 'drive'", choices):
        find_program(["air_lab0", "drive"], package.parent)


def test_the_whole_name_comes_before_the_one_without_suffix(package):
    for name in ("drive", "drive.py"):
        (package / name).touch(mode=0o755)
        assert find_program(["air_lab0", name], package) == package / name


@pytest.mark.parametrize(
    ("name", "first", "is_by_this_python"),
    [
        ("a.py", "", True),
        ("a.py", "import lcmtools\n", True),
        ("a.py", "#!/usr/bin/env python0.9\n", True),
        ("a", "#! /usr/bin/env python0.9\n", True),
        ("a.py", "#!/usr/bin/env sh\n", False),
        ("a.py", "#!/usr/bin/python3\n", False),
        ("a", "\x7fELF", False),
    ],
)
def test_this_python_runs_files_that_name_no_installed_one(
    write, name, first, *, is_by_this_python
):
    path = write({name: first}) / name
    by_python = (sys.executable, "-m", "lcmtools.packages.script", str(path))
    assert command_of(path) == (by_python if is_by_this_python else (str(path),))


def test_an_installed_interpreter_is_the_files_choice(write, monkeypatch):
    root = write({"a.py": "#!/usr/bin/env python0.9\n", "python0.9": ""})
    (root / "python0.9").chmod(0o755)
    monkeypatch.setenv("PATH", str(root))
    assert command_of(root / "a.py") == (str(root / "a.py"),)


def test_this_python_runs_files_that_name_it(write, monkeypatch):
    folder = Path(sys.executable).parent
    monkeypatch.setenv("PATH", str(folder))
    path = write({"a.py": f"#!/usr/bin/env {Path(sys.executable).name}\n"}) / "a.py"
    assert command_of(path) == (sys.executable, "-m", "lcmtools.packages.script", str(path))
