"""pub: what it sends, how often, to whom; and that a mistake sends nothing."""

import json
import subprocess
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]

TWIST_ZERO = {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}

pytestmark = pytest.mark.usefixtures("use_module_bus")


class Heard:
    """What ``lcmtools echo --json`` hears on a topic."""

    def __init__(self, echo: Any, run: Run) -> None:
        self._echo = echo
        self._run = run
        self._numbers = count()

    def messages(self) -> list[dict[str, Any]]:
        """Everything so far, each as its own JSON; in order."""
        end = f"the end {next(self._numbers)}"
        self._run("pub", "-1", self._echo.topic, "std_msgs/String", f"data: {end}")
        self._echo.wait_for(end)
        # standard error is among them, where echo tells that nothing has come for a while
        found = [json.loads(line) for line in self._echo.lines if line.startswith("{")]
        return [m for m in found if not str(m.get("data")).startswith("the end")]


@pytest.fixture(scope="module")
def echoes(module_start: Callable[..., Any], lcmtools_path: str) -> Callable[[str], Any]:
    """``echoes(topic)``: a running echo on it."""

    def start(topic: str) -> Any:
        echo = module_start(lcmtools_path, "echo", "--json", topic)
        echo.topic = topic
        return echo

    return start


_topics = count()


@pytest.fixture
def topic() -> str:
    """A topic of the test's own."""
    return f"/test{next(_topics)}"


@pytest.fixture
def heard(topic: str, echoes: Callable[[str], Any], lcmtools: Run) -> Heard:
    """An echo on the topic, which pub waits for."""
    return Heard(echoes(topic), lcmtools)


@pytest.mark.parametrize(
    ("type_name", "values", "message"),
    [
        ("std_msgs/String", ["data: hello"], {"data": "hello"}),
        ("std_msgs/String", ["hello"], {"data": "hello"}),
        ("std_msgs/String", [], {"data": ""}),
        ("std_msgs/Empty", [], {}),
        (
            "geometry_msgs/Twist",
            ["{linear: [0.5, 0, 0], angular: {z: -0.3}}"],
            {
                "linear": {"x": 0.5, "y": 0.0, "z": 0.0},
                "angular": {"x": 0.0, "y": 0.0, "z": -0.3},
            },
        ),
        (
            "geometry_msgs/msg/Twist",
            ["[1, 2, 3]", "[-4, -5, -6]"],
            {
                "linear": {"x": 1.0, "y": 2.0, "z": 3.0},
                "angular": {"x": -4.0, "y": -5.0, "z": -6.0},
            },
        ),
        ("geometry_msgs.Twist", ["{}"], TWIST_ZERO),
        (
            "sensor_msgs/JointState",
            ["name: ['left', 'right']\neffort: [1, -1]"],
            {
                "header": {"seq": 0, "stamp": {"sec": 0, "nsec": 0}, "frame_id": ""},
                "name": ["left", "right"],
                "position": [],
                "velocity": [],
                "effort": [1.0, -1.0],
            },
        ),
    ],
)
def test_once_sends_what_the_values_say_exactly_once(
    type_name: str,
    values: list[str],
    message: object,
    topic: str,
    heard: Heard,
    lcmtools: Run,
) -> None:
    result = lcmtools("pub", "-1", topic, type_name, *values)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert heard.messages() == [message]


@pytest.mark.parametrize(
    ("type_name", "words", "data"),
    [
        ("std_msgs/Float64", ["-1.5", "-1"], -1.5),
        ("std_msgs/Float64", ["--once", "-.5"], -0.5),
        ("std_msgs/Float64", ["-1", "-1e3"], -1000.0),
        ("std_msgs/Float64", ["-1", "-inf"], "-inf"),
        ("std_msgs/Int32", ["-1", "-1"], -1),
        ("std_msgs/Int32", ["--once", "--", "-1"], -1),
        ("std_msgs/Int32", ["-1", "-70"], -70),
        ("std_msgs/Int32", ["-70", "-1"], -70),
        ("std_msgs/Int32", ["-r", "50", "-t", "1", "-1"], -1),
        ("std_msgs/Int32", ["-1", "--times", "1"], -1),
        ("std_msgs/Int32", ["-70", "-1v"], -70),
        ("std_msgs/Float64", ["-1", "---\n-1.5"], -1.5),
        ("std_msgs/Float64MultiArray", ["-1", "data: [-1, -2]"], [-1.0, -2.0]),
        ("std_msgs/Float64MultiArray", ["-1", "{}", "- -1\n- -2"], [-1.0, -2.0]),
    ],
)
def test_negative_numbers_are_values_and_no_options(
    type_name: str, words: list[str], data: object, topic: str, heard: Heard, lcmtools: Run
) -> None:
    assert lcmtools("pub", topic, type_name, *words).returncode == 0
    assert [message["data"] for message in heard.messages()] == [data]


@pytest.mark.parametrize(
    "words",
    [
        ["geometry_msgs/Twist", "{linear: [1, 2]}"],
        ["geometry_msgs/Twist", "{linear: [1, 2, x]}"],
        ["geometry_msgs/Twist", "{linera: [1, 2, 3]}"],
        ["std_msgs/String", "data:x"],
        ["std_msgs/String", "x", "y"],
        ["std_msgs/String", "x", "--onec"],
        ["std_msgs/Int32", "-1"],
        ["std_msgs/String", "-f", "second_is_bad.yaml"],
        ["std_msgs/String", "x", "--timeout", "1s"],
        ["std_msgs/String", "x", "-1", "-t", "2"],
        ["std_msgs/Strung", "x"],
    ],
)
def test_mistake_sends_nothing(
    words: list[str],
    topic: str,
    heard: Heard,
    lcmtools: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "second_is_bad.yaml").write_text("data: one\n---\ndata: [2]\n")
    result = lcmtools("pub", topic, *words)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.count("\n") == 1
    assert heard.messages() == []


def test_rate_is_kept(topic: str, start: Callable[..., Any], lcmtools_path: str) -> None:
    hz = start(lcmtools_path, "hz", "--json", topic)
    hz.wait_for("subscribed to")
    start(lcmtools_path, "pub", "-r", "50", topic, "std_msgs/String", "x")
    hz.wait_for('"window"')  # the first one has begun in the middle
    assert json.loads(hz.wait_for('"window"'))["rate"] == pytest.approx(50, rel=0.1)


def test_latched_message_comes_again_to_each_that_subscribes_later(
    topic: str, start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    pub = start(lcmtools_path, "pub", topic, "std_msgs/String", "data: stay")
    pub.wait_for("publishing and latching message. Press ctrl-C to terminate")
    for _ in range(3):
        result = lcmtools("echo", "-1", "--timeout", "5s", topic)
        assert (result.returncode, result.stdout) == (0, 'data: "stay"\n---\n')


def test_latched_message_comes_to_a_node_that_starts_later(
    start: Callable[..., Any], lcmtools_path: str
) -> None:
    pub = start(lcmtools_path, "pub", "/latched/chatter", "std_msgs/String", "data: stay")
    pub.wait_for("publishing and latching")
    listener = start(lcmtools_path, "run", "listener", "__ns:=/latched")
    listener.wait_for("I heard: [stay]")


_LATE_SUBSCRIBER = """
import sys, time
import lcmtools
from lcmtools.types.std_msgs import String

lcmtools.init()
node = lcmtools.Node("late")
topic = sys.argv[1]
node.graph()
print("watching", flush=True)
while not node.graph().topic(topic).publishers:
    time.sleep(0.005)
node.create_subscription(String, topic, lambda message: print("heard", message.data, flush=True))
lcmtools.spin(node)
"""


def test_once_waits_for_one_who_can_hear(
    topic: str, start_python: Callable[..., Any], lcmtools: Run
) -> None:
    late = start_python(_LATE_SUBSCRIBER, topic)
    late.wait_for("watching")
    result = lcmtools("pub", "-1", topic, "std_msgs/String", "data: hello")
    assert (result.returncode, result.stderr) == (0, "")
    late.wait_for("heard hello")


def test_once_does_not_wait_for_a_subscriber_of_another_type(
    start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    listener = start(lcmtools_path, "run", "listener", "__ns:=/other")
    result = lcmtools("pub", "-1", "/other/chatter", "std_msgs/Int32", "3")
    assert result.returncode == 0
    assert result.stderr == (
        "lcmtools pub: no node subscribes to /other/chatter as std_msgs/Int32"
        " (/other/listener does as std_msgs/String) yet; publishing all the same\n"
    )
    warning = listener.wait_for("message ignored")
    assert warning.endswith("expected std_msgs/String, got std_msgs/Int32")


@pytest.mark.parametrize(
    "words",
    [
        ["chatter", "std_msgs/String", "x", "__ns:=/named"],
        ["chatter", "std_msgs/String", "x", "--ns", "/named"],
        ["a", "std_msgs/String", "x", "a:=/named/chatter"],
        ["a", "std_msgs/String", "x", "--remap", "a:=/named/chatter"],
        ["~a", "std_msgs/String", "x", "__name:=me", "~a:=/named/chatter"],
        ["--name", "me", "--ns", "named", "a", "std_msgs/String", "x", "/named/a:=chatter"],
    ],
)
def test_names_are_resolved_and_remapped_as_a_nodes(
    words: list[str], start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    echo = start(lcmtools_path, "echo", "--json", "/named/chatter")
    result = lcmtools("pub", "-1", *words)
    assert (result.returncode, result.stderr) == (0, "")
    echo.wait_for('{"data":"x"}')


_PLAIN_SUBSCRIBER = """
import lcm
bus = lcm.LCM()
bus.subscribe(".*PLAIN", lambda channel, payload: print("heard", channel, flush=True))
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_literal_takes_the_channel_to_the_letter(
    start_python: Callable[..., Any], lcmtools: Run
) -> None:
    plain = start_python(_PLAIN_SUBSCRIBER)
    plain.wait_for("ready")
    lcmtools("pub", "-1", "--literal", "PLAIN", "std_msgs/String", "x")
    assert plain.wait_for("heard") == "heard PLAIN"
    lcmtools("pub", "-1", "PLAIN", "std_msgs/String", "x")
    assert plain.wait_for("heard") == "heard /PLAIN"


def test_domain_chooses_the_bus(lcmtools: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("LCM_DEFAULT_URL")
    result = lcmtools("list", LCMTOOLS_DOMAIN="231")
    assert result.stderr == "no topics on udpm://239.255.76.67:7898?ttl=0\n"
    for line in (["--domain", "231", "list"], ["list", "--domain", "231"]):
        assert lcmtools(*line, LCMTOOLS_DOMAIN="5").stderr == result.stderr
