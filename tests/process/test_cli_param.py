"""``lcmtools param``: the parameters of real nodes, read and changed from a shell."""

import json
import signal
import threading
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

import lcmtools
from lcmtools import Node, SetParametersResult
from lcmtools.labs.nodes.simple_controller import SimpleController
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

DUMP = """\
/husky0/driver:
  gain: 1.0
  name: bob
  pid.kp: 0.5
  steps: [1, 2]
  use_sim_time: false
"""


def make_driver():
    """A node with parameters."""
    node = Node("driver")
    node.declare_parameter("gain", 1.0, "effort [N]", minimum=-10.0, maximum=10.0)
    node.declare_parameter("name", "bob")
    node.declare_parameter("steps", [1, 2])
    node.declare_parameter("pid.kp", 0.5)

    def check(parameters):
        if any(p.name == "name" and p.value == "eve" for p in parameters):
            return SetParametersResult(successful=False, reason="eve may not drive")
        return None

    node.add_on_set_parameters_callback(check)
    return node


@pytest.fixture
def driver(bus_url, start_node, monkeypatch):
    """A node with parameters on a bus of the test's own."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    return start_node(make_driver, "__ns:=/husky0")


@pytest.mark.usefixtures("driver")
def test_list_and_get_take_both_spellings(cli):
    names = ["gain", "name", "pid.kp", "steps", "use_sim_time"]
    full = [f"/husky0/driver/{name}" for name in names]
    for words in ([], ["driver"], ["/husky0/driver"], ["/husky0"], ["driver", "__ns:=/husky0"]):
        assert cli("param", "list", *words).out.splitlines() == full
    assert "/husky0/driver/gain [float]: 1.0\n" in cli("param", "list", "-t", "-v").out
    for words in (["driver", "gain"], ["/husky0/driver/gain"], ["driver/gain"]):
        assert cli("param", "get", *words).out == "1.0\n"
    assert cli("param", "get", "driver").out == "".join(
        f"{row.strip()}\n" for row in DUMP.splitlines()[1:]
    )
    assert cli("param", "get", "/").out == DUMP
    assert json.loads(cli("param", "get", "driver", "steps", "--json").out) == [1, 2]
    assert json.loads(cli("param", "list", "--json").out)[0] == {
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
def test_set_changes_a_parameter(cli, words, name, value):
    done = cli("param", "set", *words)
    assert (done.code, done.out) == (0, "")
    assert f"/husky0/driver/{name} is now {value}\n" in done.err
    assert cli("param", "get", "driver", name).out == f"{value}\n"


@pytest.mark.usefixtures("driver")
@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ["gain", "fast"],
            "/husky0/driver rejects the change: parameter gain: expected a number, got 'fast'",
        ),
        (["gian", "1"], "/husky0/driver has no parameter 'gian'; did you mean gain?"),
        (["{gain: 2, name: eve}"], "/husky0/driver rejects the change: eve may not drive"),
        (["{pid: {kq: 2}}"], "/husky0/driver has no parameter 'pid/kq'; did you mean pid.kp?"),
    ],
)
def test_what_a_node_refuses_is_said_and_changes_nothing(cli, words, line):
    done = cli("param", "set", "driver", *words)
    assert (done.code, done.out) == (1, "")
    assert done.err == f"lcmtools param set: {line}\n"
    assert cli("param", "dump").out == DUMP


@pytest.mark.usefixtures("driver")
def test_set_takes_nested_names_as_load_does(cli):
    said = cli("param", "set", "driver", "{gain: 2, pid: {kp: 3}}").err
    gain, kp = said.splitlines()
    assert_says(gain, "/husky0/driver/gain", "2.0")
    assert_says(kp, "/husky0/driver/pid.kp", "3.0")


def test_dump_without_nodes_leaves_a_file_as_it_is(cli, tmp_path):
    file = tmp_path / "gains.yaml"
    file.write_text("gain: 2.0")
    done = cli("param", "dump", str(file))
    assert (done.code, file.read_text()) == (1, "gain: 2.0")
    assert_says(done.err, "no node with parameters on", f"{file} is left as it is")


@pytest.mark.usefixtures("driver")
def test_load_takes_back_what_dump_writes(cli, tmp_path):
    file = str(tmp_path / "all.yaml")
    assert cli("param", "dump", file, "driver").out == ""
    assert Path(file).read_text() == DUMP
    cli("param", "set", "driver", "{gain: 3, name: 'true', steps: [], pid.kp: 9}")
    assert cli("param", "load", file).code == 0
    assert cli("param", "dump", "driver").out == DUMP
    as_json = cli("param", "dump", "--json").out
    cli("param", "set", "driver", "gain", "3")
    assert cli("param", "load", "-", input=as_json).code == 0
    assert cli("param", "dump").out == DUMP


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
def test_load_takes_the_files_of_rosparam_and_ros2(cli, tmp_path, text, words):
    file = tmp_path / "gains.yaml"
    file.write_text(text)
    done = cli("param", "load", str(file), *words)
    assert done.code == 0
    assert_line(done.err, "/husky0/driver: ", "gain, pid.kp", "set")
    assert cli("param", "get", "driver", "gain").out == "4.0\n"
    assert cli("param", "get", "driver", "pid.kp").out == "2.0\n"


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
        (
            "driver:\n  name: eve\n  gain: 2\n",
            1,
            " /husky0/driver rejects the change: eve may not drive",
        ),
        (
            "driver:\n  name: x\n  gain: 20\n",
            1,
            "3: /husky0/driver rejects the change: parameter gain: 20.0",
        ),
        ("gain: 2\n", 1, "1: 'gain' is for no node; write the node after the file"),
    ],
)
def test_load_names_the_line_of_what_is_wrong_and_sets_nothing(cli, tmp_path, text, code, line):
    (tmp_path / "gains.yaml").write_text(text)
    file = str(tmp_path / "gains.yaml")
    done = cli("param", "load", file)
    assert done.code == code
    assert done.err.startswith(f"lcmtools param load: {file}:{line}")
    assert cli("param", "dump").out == DUMP


@pytest.mark.usefixtures("driver")
def test_describe_says_type_meaning_and_range(cli):
    assert cli("param", "describe", "driver", "gain").out.splitlines() == [
        "Parameter: /husky0/driver/gain",
        "  Type: float",
        "  Value: 1.0",
        "  Description: effort [N]",
        "  Range: -10.0 to 10.0",
    ]
    assert "Read only" in cli("param", "describe", "/husky0/driver/use_sim_time").out


HANGING = """
import lcmtools
lcmtools.init()
node = lcmtools.Node("hanging")
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.mark.usefixtures("driver")
def test_a_node_that_hangs_costs_exit_code_4_and_the_others_are_listed(cli, start_python):
    hanging = start_python(HANGING)
    hanging.wait_for("ready")
    hanging.send_signal(signal.SIGSTOP)
    done = cli("param", "list", "--timeout", "300ms")
    assert done.out.splitlines()[0] == "/husky0/driver/gain"
    assert "/hanging" not in done.out
    assert "/hanging" in done.err
    hanging.send_signal(signal.SIGCONT)


@pytest.mark.usefixtures("driver")
def test_the_controller_follows_a_changed_gain(cli, start_node, wait_until):
    efforts = []

    def robot():
        node = Node("robot")
        odometry = node.create_publisher(Odometry, "/odometry")
        desired = node.create_publisher(Twist, "/desired_velocity")
        wanted = Twist()
        wanted.linear.x = 0.5

        def move():
            odometry.publish(Odometry())
            desired.publish(wanted)

        node.create_timer(0.02, move)
        node.create_subscription(
            JointState, "/controlled_velocity", lambda message: efforts.append(list(message.effort))
        )
        return node

    start_node(SimpleController, "_ki:=0.0")
    start_node(robot)
    wait_until(lambda: [0.5, 0.5] in efforts)
    assert cli("param", "set", "simple_controller", "kp", "0.25").code == 0
    wait_until(lambda: [0.125, 0.125] in efforts)
    done = cli("param", "set", "simple_controller", "kp", "-1")
    assert_says(done.err, "parameter kp: -1.0", "0.0")


@pytest.mark.usefixtures("driver")
def test_node_info_shows_parameters_and_says_who_did_not_answer(cli, start_node):
    assert "Parameters: \n * gain: 1.0\n * name: bob\n" in cli("node", "info", "driver").out
    (record,) = json.loads(cli("node", "info", "driver", "--json").out)
    assert record["parameters"]["steps"] == [1, 2]

    is_blocked, is_over = threading.Event(), threading.Event()

    def busy():
        node = lcmtools.Node("busy")
        node.create_timer(0.001, lambda: is_blocked.set() or is_over.wait())
        return node

    start_node(busy)
    assert is_blocked.wait(40.0)
    try:
        assert "Parameters: (did not answer)\n" in cli("node", "info", "busy").out
        done = cli("param", "get", "busy", "--timeout", "200ms")
    finally:
        is_over.set()
    assert (done.code, done.out) == (4, "")
    assert_says(done.err, "lcmtools param get: /busy", "not answer", "0.2 s")
