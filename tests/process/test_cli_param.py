"""``lcmtools param``: the parameters of real nodes, read and changed from a shell."""

import json
import signal
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest

Run = Callable[..., CompletedProcess[str]]
Start = Callable[..., Any]

NODE = """
import lcmtools
from lcmtools import SetParametersResult

lcmtools.init()
node = lcmtools.Node("driver")
node.declare_parameter("gain", 1.0, "effort [N]", minimum=-10.0, maximum=10.0)
node.declare_parameter("name", "bob")
node.declare_parameter("steps", [1, 2])
node.declare_parameter("pid.kp", 0.5)

def check(parameters):
    if any(p.name == "name" and p.value == "eve" for p in parameters):
        return SetParametersResult(False, "eve may not drive")

node.add_on_set_parameters_callback(check)
print("ready", flush=True)
lcmtools.spin(node)
lcmtools.shutdown()
"""
DUMP = """\
/husky0/driver:
  gain: 1.0
  name: bob
  pid.kp: 0.5
  steps: [1, 2]
  use_sim_time: false
"""


@pytest.fixture
def driver(bus_url: str, start_python: Start, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A node with parameters on a bus of the test's own."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    program = start_python(NODE, "__ns:=/husky0")
    program.wait_for("ready")
    return program


@pytest.mark.usefixtures("driver")
def test_list_and_get_take_both_spellings(lcmtools: Run) -> None:
    names = ["gain", "name", "pid.kp", "steps", "use_sim_time"]
    full = [f"/husky0/driver/{name}" for name in names]
    for words in ([], ["driver"], ["/husky0/driver"], ["/husky0"]):
        assert lcmtools("param", "list", *words).stdout.splitlines() == full
    assert "/husky0/driver/gain [float]: 1.0\n" in lcmtools("param", "list", "-t", "-v").stdout
    for words in (["driver", "gain"], ["/husky0/driver/gain"], ["driver/gain"]):
        assert lcmtools("param", "get", *words).stdout == "1.0\n"
    assert lcmtools("param", "get", "driver").stdout == "".join(
        f"{row.strip()}\n" for row in DUMP.splitlines()[1:]
    )
    assert lcmtools("param", "get", "/").stdout == DUMP
    assert json.loads(lcmtools("param", "get", "driver", "steps", "--json").stdout) == [1, 2]
    assert json.loads(lcmtools("param", "list", "--json").stdout)[0] == {
        "node": "/husky0/driver",
        "name": "gain",
        "type": "float",
        "value": 1.0,
        "description": "effort [N]",
        "minimum": "-10.0",
        "maximum": "10.0",
        "read_only": False,
    }


@pytest.mark.usefixtures("driver")
@pytest.mark.parametrize(
    ("words", "name", "value"),
    [
        (["driver", "gain", "-2"], "gain", "-2.0"),
        (["driver", "gain", "-1"], "gain", "-1.0"),
        (["/husky0/driver/gain", "1e-3"], "gain", "0.001"),
        (["driver", "name", "on"], "name", '"on"'),
        (["driver", "name", "two words: here"], "name", '"two words: here"'),
        (["driver", "steps", "[3, -4]"], "steps", "[3, -4]"),
        (["driver", "{gain: 3, name: ann}"], "name", "ann"),
    ],
)
def test_set_changes_a_parameter(lcmtools: Run, words: list[str], name: str, value: str) -> None:
    done = lcmtools("param", "set", *words)
    assert (done.returncode, done.stdout) == (0, "")
    assert f"/husky0/driver/{name} is now {value}\n" in done.stderr
    assert lcmtools("param", "get", "driver", name).stdout == f"{value}\n"


@pytest.mark.usefixtures("driver")
@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["gain", "fast"], "/husky0/driver refuses: parameter gain: expected a number, got 'fast'"),
        (["gain", "11"], "/husky0/driver refuses: parameter gain: 11.0 is more than 10.0"),
        (["name", "eve"], "/husky0/driver refuses: eve may not drive"),
        (["gian", "1"], "/husky0/driver has no parameter 'gian'; did you mean gain?"),
        (["{gain: 2, name: eve}"], "/husky0/driver refuses: eve may not drive"),
    ],
)
def test_what_a_node_refuses_is_said_and_changes_nothing(
    lcmtools: Run, words: list[str], line: str
) -> None:
    done = lcmtools("param", "set", "driver", *words)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"lcmtools param set: {line}\n"
    assert lcmtools("param", "dump").stdout == DUMP


@pytest.mark.usefixtures("driver")
def test_load_takes_back_what_dump_writes(lcmtools: Run, tmp_path: Path) -> None:
    file = str(tmp_path / "all.yaml")
    assert lcmtools("param", "dump", file, "driver").stdout == ""
    assert Path(file).read_text() == DUMP
    lcmtools("param", "set", "driver", "{gain: 3, name: 'true', steps: [], pid.kp: 9}")
    assert lcmtools("param", "load", file).returncode == 0
    assert lcmtools("param", "dump", "driver").stdout == DUMP
    as_json = lcmtools("param", "dump", "--json").stdout
    lcmtools("param", "set", "driver", "gain", "3")
    assert lcmtools("param", "load", "-", stdin=as_json).returncode == 0
    assert lcmtools("param", "dump").stdout == DUMP


@pytest.mark.usefixtures("driver")
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("gain: 4\npid: {kp: 2}\n", ["driver"]),
        ("husky0:\n  driver:\n    gain: 4\n    pid.kp: 2\n", []),
        ("/husky0/driver:\n  ros__parameters:\n    gain: 4\n    pid:\n      kp: 2\n", []),
        ("/**:\n  ros__parameters:\n    gain: 4\n    pid.kp: 2\n", []),
        ("driver: {gain: 4, pid.kp: 2}\n", []),
    ],
)
def test_load_takes_the_files_of_rosparam_and_ros2(
    lcmtools: Run, tmp_path: Path, text: str, words: list[str]
) -> None:
    file = tmp_path / "gains.yaml"
    file.write_text(text)
    done = lcmtools("param", "load", str(file), *words)
    assert (done.returncode, done.stderr) == (0, "/husky0/driver: gain, pid.kp set\n")
    assert lcmtools("param", "get", "driver", "gain").stdout == "4.0\n"
    assert lcmtools("param", "get", "driver", "pid.kp").stdout == "2.0\n"


@pytest.mark.usefixtures("driver")
@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("driver:\n  gain: 2\n  steps: [1, x]\n", 2, "3: parameter steps[1]: expected an integer,"),
        (
            "driver:\n  gain: 2\n  gian: 3\n",
            1,
            "3: /husky0/driver has no parameter 'gian'; did you",
        ),
        ("driver:\n  gain: 2\n\ndrivre:\n  gain: 3\n", 1, "5: there is no node /drivre"),
        ("driver:\n  name: eve\n  gain: 2\n", 1, " /husky0/driver refuses: eve may not drive"),
        ("driver:\n  name: x\n  gain: 20\n", 1, "3: /husky0/driver refuses: parameter gain: 20.0"),
        ("gain: 2\n", 1, "1: 'gain' is for no node; write the node after the file"),
    ],
)
def test_load_names_the_line_of_what_is_wrong_and_sets_nothing(
    lcmtools: Run, tmp_path: Path, text: str, code: int, line: str
) -> None:
    (tmp_path / "gains.yaml").write_text(text)
    file = str(tmp_path / "gains.yaml")
    done = lcmtools("param", "load", file)
    assert done.returncode == code
    assert done.stderr.startswith(f"lcmtools param load: {file}:{line}")
    assert lcmtools("param", "dump").stdout == DUMP


@pytest.mark.usefixtures("driver")
def test_describe_says_type_meaning_and_range(lcmtools: Run) -> None:
    assert lcmtools("param", "describe", "driver", "gain").stdout.splitlines() == [
        "Parameter: /husky0/driver/gain",
        "  Type: float",
        "  Value: 1.0",
        "  Description: effort [N]",
        "  Range: -10.0 to 10.0",
    ]
    assert "Read only" in lcmtools("param", "describe", "/husky0/driver/use_sim_time").stdout


def test_a_node_that_hangs_costs_exit_code_4_and_the_others_are_listed(
    driver: Any, lcmtools: Run, start: Start, lcmtools_path: str
) -> None:
    start(lcmtools_path, "run", "talker").wait_for("hello")
    driver.send_signal(signal.SIGSTOP)
    done = lcmtools("param", "list", "--timeout", "300ms")
    assert done.stdout == "/talker/use_sim_time\n"
    assert "/husky0/driver" in done.stderr
    driver.send_signal(signal.SIGCONT)


def test_the_controller_follows_a_changed_gain(
    driver: Any, lcmtools: Run, start: Start, lcmtools_path: str, wait_until: Callable[..., None]
) -> None:
    del driver
    start(lcmtools_path, "run", "simple_controller", "_ki:=0.0")
    wait_until(lambda: "/simple_controller" in lcmtools("node", "list").stdout)
    echo = start(lcmtools_path, "echo", "/controlled_velocity/effort")
    wait_until(lambda: "/_lcmtools" in lcmtools("node", "list", "-a").stdout)
    start(lcmtools_path, "pub", "-r", "20", "/odometry", "nav_msgs/Odometry")
    start(
        lcmtools_path,
        "pub",
        "-r",
        "20",
        "/desired_velocity",
        "geometry_msgs/Twist",
        "{linear: [0.5, 0, 0]}",
    )
    echo.wait_for("[0.5, 0.5]")
    assert lcmtools("param", "set", "simple_controller", "kp", "0.25").returncode == 0
    echo.wait_for("[0.125, 0.125]")
    done = lcmtools("param", "set", "simple_controller", "kp", "-1")
    assert "parameter kp: -1.0 is less than 0.0" in done.stderr


BUSY = """
import time
import lcmtools

lcmtools.init()
node = lcmtools.Node("busy")
print("ready", flush=True)
while lcmtools.ok():
    time.sleep(0.05)  # it announces itself and never spins
lcmtools.shutdown()
"""


@pytest.mark.usefixtures("driver")
def test_node_info_shows_parameters_and_says_who_did_not_answer(
    lcmtools: Run, start_python: Start, wait_until: Callable[..., None]
) -> None:
    shown = "Parameters: \n * gain: 1.0\n * name: bob\n"
    wait_until(lambda: shown in lcmtools("node", "info", "driver").stdout)
    (record,) = json.loads(lcmtools("node", "info", "driver", "--json").stdout)
    assert record["parameters"]["steps"] == [1, 2]
    start_python(BUSY).wait_for("ready")
    assert "Parameters: (did not answer)\n" in lcmtools("node", "info", "busy").stdout
    done = lcmtools("param", "get", "busy", "--timeout", "200ms")
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr.startswith("lcmtools param get: /busy did not answer within 0.2 s")
