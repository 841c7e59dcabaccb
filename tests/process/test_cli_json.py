"""``--json`` of every command: strict JSON, whose keys are all on the page docs/json.md.

Each line runs on a bus with nodes that have topics, services, parameters and faults, a plain LCM
program, a relay and a simulator, beside logs, packages and a launch file.
"""

import json
import math
import os
import shlex
import signal
import sys
from pathlib import Path

import pytest
from fixtures import networks
from fixtures.commands import COMMANDS, has_json
from fixtures.json_page import PAGE, sections, unlisted

pytest.importorskip("pybullet")

_ROBOT = """
import math, time
import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.std_msgs import Float64
from lcmtools.types.std_srvs import Trigger
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.tf2_msgs import TFMessage

lcmtools.init()
robot, driver = lcmtools.Node("robot"), lcmtools.Node("driver")
robot.declare_parameter("gain", math.nan, description="of the loop")
robot.declare_parameter("count", 3, minimum=0, maximum=9)
robot.declare_parameter("named", "husky")
robot.create_service(Trigger, "reset", lambda request, response: response)
driver.create_client(Trigger, "reset")

def fail(odometry):
    time.sleep(0.001)
    raise ValueError("no")

driver.create_subscription(Odometry, "odometry", fail)
odometry, twist = robot.create_publisher(Odometry, "odometry"), robot.create_publisher(Twist, "cmd")
gauge, frames = robot.create_publisher(Float64, "gauge"), robot.create_publisher(TFMessage, "tf")
moved = TransformStamped(child_frame_id="base_link")
moved.header.frame_id, moved.transform.rotation.w = "odom", 1.0
nothing = Float64()
nothing.data = math.nan

def tick():
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nsec = divmod(robot.get_clock().now(), 10**9)
    odometry.publish(message)
    gauge.publish(nothing)
    frames.publish(TFMessage(transforms=[moved]))

robot.create_timer(0.05, tick)
print("ready", flush=True)
lcmtools.spin(robot, driver)
"""
_TALKER = """
import lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("talker")
publisher = node.create_publisher(String, "chatter")
node.create_timer(0.1, lambda: publisher.publish(String()))
print("ready", flush=True)
lcmtools.spin(node)
"""
_PLAIN = """
import time

import lcm
from lcmtools.types.std_msgs import String

plain = lcm.LCM()
plain.subscribe("PLAIN", lambda *_: None)
print("ready", flush=True)
while True:
    plain.publish("PLAIN", String().encode())
    plain.publish("ODD", b"12345678 and more")
    plain.handle_timeout(0)  # of its own messages one always waits
    time.sleep(0.1)
"""
_WORLD = """\
node: yard
robots:
  - {model: husky, namespace: /husky0}
"""
_LAUNCH = """\
args:
  robot: {default: husky0, doc: its name}
nodes:
  - {run: talker, name: hello, ns: $(arg robot), param: {gain: .nan}, respawn: true}
"""
_CONTRACT = "topics:\n  /odometry: {type: nav_msgs/Odometry, min_rate: 1000}\n  /none: {}\n"

LINES = Path(__file__).with_name("json_lines.txt").read_text().splitlines()


@pytest.fixture(scope="module")
def other_bus_url():
    """The bus at the relay's other end."""
    with networks.reserve_port() as lock:
        yield f"udpm://239.255.76.67:{lock.getsockname()[1]}?ttl=0"


@pytest.fixture(scope="module")
def folder(module_start, lcmtools_path, tmp_path_factory, module_bus_url, other_bus_url, cli):
    """A folder with logs, packages and files, while all kinds of programs run on the bus."""
    folder = tmp_path_factory.mktemp("work")
    for name, text in (
        ("robot.py", _ROBOT),
        ("talker.py", _TALKER),
        ("plain.py", _PLAIN),
        ("yard.yaml", _WORLD),
        ("robot.yaml", _LAUNCH),
        ("contract.yaml", _CONTRACT),
        ("bad/Bad.lcm", "package bad; struct Bad { nothing x; }"),
    ):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    for script in ("robot.py", "talker.py", "plain.py"):
        module_start(sys.executable, str(folder / script)).wait_for("ready")
    gone = module_start(sys.executable, str(folder / "talker.py"))
    gone.wait_for("ready")
    os.kill(gone.pid, signal.SIGKILL)  # its node is stale from now on
    world = str(folder / "yard.yaml")
    module_start(lcmtools_path, "run", "sim", world).wait_for("simulating")
    module_start(lcmtools_path, "relay", other_bus_url).wait_for("")
    for words in (
        ("bag", "record", "-a", "--duration", "1.5s", "-o", str(folder / "ride.lcmlog")),
        ("bag", "record", "/odometry", "-n", "3", "-o", str(folder / "other.lcmlog")),
        ("pkg", "create", "air", str(folder), "--msg", "Reading"),
    ):
        own = {"LCM_DEFAULT_URL": module_bus_url, "XDG_CONFIG_HOME": str(folder / "config")}
        result = cli(*words, env=own)
        assert result.code == 0, result
    ride = (folder / "ride.lcmlog").read_bytes()
    (folder / "broken.lcmlog").write_bytes(ride[:5000] + b"\0" * 3000 + ride[5000:9000])
    return folder


@pytest.mark.parametrize("line", LINES)
def test_keys_of_json_are_on_the_page(
    line,
    folder,
    use_module_bus,  # noqa: ARG001 - the commands look at it
    cli,
    monkeypatch,
):
    monkeypatch.chdir(folder)
    monkeypatch.delenv("DISPLAY", raising=False)
    words = shlex.split(line)
    own = words.index("--") if "--" in words else len(words)  # a program's follow
    words.insert(own, "--json")
    result = cli(*words, until=_is_complete, ends_by=signal.SIGTERM)
    assert "Traceback" not in result.err, result
    documents = _documents(result.out)
    assert documents, result
    path = next(path for path in COMMANDS if words[: len(path) - 1] == list(path[1:]))
    assert unlisted(" ".join(path[1:]), documents) == []


def _is_complete(written):
    """Return True if a command that goes on has printed a document; ``wtf --watch`` some lines."""
    return "http://" in written or "ws://" in written or "change" in written


def _documents(text):
    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    try:
        return [json.loads(text, parse_constant=refuse)]
    except json.JSONDecodeError:
        return [json.loads(row, parse_constant=refuse) for row in text.splitlines()]


def test_what_a_page_does_not_list_is_found():
    odd = {"topic": 3, "rate": math.nan, "new": {"key": None}, "min": "nan"}
    assert unlisted("hz", [odd]) == ["new.key null", "topic integer/number"]


def test_an_error_has_the_keys_on_the_page(
    use_module_bus,  # noqa: ARG001 - the command looks at it
    cli,
):
    result = cli("node", "info", "nobody", "--json")
    assert unlisted("error", [json.loads(result.err)]) == []


def test_every_command_with_json_has_a_section_and_lines():
    commands = {" ".join(path[1:]) for path in COMMANDS if has_json(path)}
    assert commands - sections().keys() == set(), PAGE
    typed = [f"{line} " for line in LINES]
    assert [one for one in commands if not any(line.startswith(f"{one} ") for line in typed)] == []
