"""run: nodes by their names, with names, remaps and parameters in both forms."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

pytestmark = pytest.mark.usefixtures("use_module_bus")


def test_list_names_what_can_be_run(cli):
    result = cli("run", "--list")
    rows = [line.split(maxsplit=1) for line in result.out.splitlines()]
    known = {row[0] for row in rows}
    assert result.code == 0
    assert known >= {"talker", "listener", "simple_controller", "evaluate_controller", "sim"}
    assert [row[0] for row in rows] == sorted(known)
    assert ["listener", "Log the texts of the talker: the first subscriber."] in rows
    assert all(len(row) == 2 for row in rows), "each has its summary"
    assert json.loads(cli("run", "--list", "--json").out) == sorted(known)


def test_the_start_of_a_lab_says_its_steps_line_by_line(cli, monkeypatch):
    monkeypatch.setattr("lcmtools.cli.run.command", lambda **_: 0)
    said = cli("lab", "start", "husky").err.splitlines()
    assert said[1] == "In a second terminal, type:"
    assert said[2].startswith("  lcmtools ")
    assert "Ctrl-C ends the simulator." in said


def test_names_and_remaps_are_taken_in_both_forms(start, cli, lcmtools_path):
    arguments = ["--ns", "/husky0", "__name:=speaker", "--remap", "chatter:=news"]
    start(lcmtools_path, "run", "talker", *arguments).wait_for("[/husky0/speaker]: hello world")
    info = cli("node", "info", "/husky0/speaker").out
    assert " * /husky0/news [std_msgs/String]\n" in info


def test_parameters_are_taken_in_both_forms(start, cli, lcmtools_path, wait_until):
    words = ("__ns:=/gains", "_kp:=2", "--param=ki:=0")
    start(lcmtools_path, "run", "simple_controller", *words)
    node = "/gains/simple_controller"
    wait_until(lambda: f"{node}\n" in cli("node", "list").out)
    values = [cli("param", "get", node, name).out for name in ("kp", "ki")]
    assert list(map(float, values)) == [2, 0]


@pytest.mark.parametrize("arguments", [["--help"], ["-h"]])
def test_help_after_the_name_is_the_nodes_own(arguments, cli):
    result = cli("run", "talker", *arguments, env={"LCM_DEFAULT_URL": "no bus is needed"})
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith('Publish "hello world" ten times a second')


def test_a_python_without_docstrings_helps_and_runs(bus_url):
    """PYTHONOPTIMIZE=2 drops them: the nodes' help, and the sentences of commands and rules."""
    from lcmtools.labs import nodes

    files = Path(nodes.__file__).parent.glob("*.py")
    named = sorted(one.stem for one in files if "check_command_line(args" in one.read_text())
    named += ["teleop", "steering", "image_view", "kinect_viewer"]
    commands = [["run", name, "--help"] for name in dict.fromkeys(named) if name != "__init__"]
    commands += [["wtf", "--list"], ["wtf", "--explain", "loss"], ["pub", "--help"], ["list"]]
    source = f"from lcmtools.cli.main import main\nprint([main(words) for words in {commands}])"
    environment = {**os.environ, "LCM_DEFAULT_URL": bus_url, "PYTHONOPTIMIZE": "2"}
    command = [sys.executable, "-c", source]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert ran.stdout.endswith(f"{[0] * len(commands)}\n"), ran.stderr


@pytest.mark.parametrize("place", [0, 1, 2, 3])
def test_bus_can_be_said_anywhere(place, cli):
    words = ["run", "listener", "__ns:=/elsewhere"]
    words[place:place] = ["--lcm-url", "nonsense://"]
    result = cli(*words)
    assert (result.code, result.out) == (2, "")
    assert "nonsense://" in result.err


def test_exit_code_is_the_nodes_and_its_files_are_written(lcmtools_process, tmp_path):
    metadata = tmp_path / "mine-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[lcmtools.nodes]\nmine = mine:main\n")
    (tmp_path / "mine.py").write_text(
        f"file = open({str(tmp_path / 'data.csv')!r}, 'w')\nfile.write('1, 2')\n"
        "def main(args=None):\n    print(args)\n    return 7\n"
    )
    environment = {"PYTHONPATH": str(tmp_path)}
    result = lcmtools_process("run", "mine", "a", "--b", "c:=d", **environment)
    assert (result.returncode, result.stdout) == (7, "['a', '--b', 'c:=d']\n")
    assert (tmp_path / "data.csv").read_text() == "1, 2"  # though it was not closed
    assert "mine mine" in lcmtools_process("run", "--list", **environment).stdout.splitlines()


def test_simulator_without_pybullet_says_what_to_type_with_exit_code_3(lcmtools_process, tmp_path):
    (tmp_path / "pybullet.py").write_text(
        "raise ModuleNotFoundError(\"No module named 'pybullet'\", name='pybullet')\n"
    )
    result = lcmtools_process("run", "sim", PYTHONPATH=str(tmp_path), LCMTOOLS_ENGINE="bullet")
    assert (result.returncode, result.stdout) == (3, "")
    assert result.stderr.count("\n") == 1
    assert_says(result.stderr, "lcmtools run sim: ", "engine bullet", "No module")
    assert "pip install" in result.stderr


@pytest.mark.parametrize(
    ("words", "package", "said"),
    [
        (
            "run sim --list-worlds",
            "numpy",
            "lcmtools run sim: the simulator needs the extra 'sim' (",
        ),
        ("run kinect_viewer", "PIL", "lcmtools run: showing pictures needs the extra 'view' ("),
        ("lab check husky", "numpy", "lcmtools lab check: lab check needs the extra 'sim' ("),
    ],
)
def test_the_extra_that_a_command_needs_is_named_with_exit_code_3(
    lcmtools_process, tmp_path, words, package, said
):
    text = f"raise ModuleNotFoundError(\"No module named '{package}'\", name='{package}')\n"
    (tmp_path / f"{package}.py").write_text(text)
    result = lcmtools_process(*words.split(), PYTHONPATH=str(tmp_path))
    assert (result.returncode, result.stdout, result.stderr.count("\n")) == (3, "", 1)
    assert result.stderr.startswith(said)
    assert "; type: pip install 'lcmtools-robotics[" in result.stderr


def test_node_whose_package_is_missing_says_what_to_type_with_exit_code_3(
    lcmtools_process, tmp_path
):
    (tmp_path / "own.py").write_text("import cv2\n")
    (tmp_path / "cv2.py").write_text(
        "raise ModuleNotFoundError(\"No module named 'cv2'\", name='cv2')\n"
    )
    metadata = tmp_path / "mine-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[lcmtools.nodes]\nmine = own:main\n")
    result = lcmtools_process("run", "mine", PYTHONPATH=str(tmp_path))
    assert (result.returncode, result.stdout) == (3, "")
    install = "; type: pip install opencv-python\n"
    assert_line(result.stderr, "lcmtools run: mine", "'cv2'", install)
