"""pub: what it sends, to whom; and that a mistake sends nothing."""

import math
import shlex
from itertools import count

import pytest
from fixtures.says import assert_line

from lcmtools.messages.registry import message_class

TWIST_ZERO = {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}

pytestmark = pytest.mark.usefixtures("use_module_bus")
_topics = count()


@pytest.fixture
def topic():
    """A topic of the test's own."""
    return f"/test{next(_topics)}"


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
    type_name, values, message, topic, receiver, cli
):
    received = receiver.subscribe(topic, type_name)
    result = cli("pub", "-1", topic, type_name, *values)
    assert (result.code, result.out) == (0, "")
    assert not result.err or "the last command" in result.err  # of a velocity that is not zero
    assert received() == [message]


@pytest.mark.parametrize(
    ("topic", "words", "said"),
    [
        (
            "/r/cmd_vel",
            ["-1", "geometry_msgs/Twist", "{linear: {x: 0.5}}"],
            "linear.x 0.5, and remains in effect until another one comes; to stop: lcmtools",
        ),
        (
            "DRIVE",
            [
                "--plain-channel",
                "-t",
                "2",
                "-r",
                "50",
                "geometry_msgs/TwistStamped",
                "twist: {angular: {z: 1}}",
            ],
            "to stop: lcmtools pub -1 --plain-channel DRIVE geometry_msgs/TwistStamped '{}'",
        ),
        (
            "/r/wheel_cmd",
            ["-1", "sensor_msgs/JointState", "{name: [a, b], effort: [1, 0]}"],
            """sensor_msgs/JointState '{"name":["a","b"],"effort":[0,0]}'""",
        ),
        ("/r/cmd_vel", ["-1", "geometry_msgs/Twist"], ""),
        ("/r/temperature", ["-1", "std_msgs/Float64", "20"], ""),
    ],
)
def test_the_end_tells_of_a_command_that_an_actuator_goes_on_to_obey(
    topic, words, said, receiver, cli
):
    type_at = next(place for place, word in enumerate(words) if "_msgs/" in word)
    kind = message_class(words[type_at])
    receiver.node.create_subscription(kind, topic, lambda _: None, plain_channel=True)
    err = cli("pub", *words[:type_at], topic, *words[type_at:]).err
    assert said in err
    assert bool(err) is bool(said)
    if said:
        stop = shlex.split(err.rpartition("to stop: lcmtools ")[2])
        assert cli(*stop).ok() == ""


@pytest.mark.parametrize(
    ("type_name", "words", "data"),
    [
        ("std_msgs/Float64", ["-1.5", "-1"], -1.5),
        ("std_msgs/Float64", ["--once", "-.5"], -0.5),
        ("std_msgs/Float64", ["-1", "-inf"], -math.inf),
        ("std_msgs/Int32", ["-1", "-1"], -1),
        ("std_msgs/Int32", ["-r", "50", "-t", "1", "--", "-1"], -1),
        ("std_msgs/Int32", ["-70", "-1v"], -70),
        ("std_msgs/Float64", ["-1", "---\n-1.5"], -1.5),
        ("std_msgs/Float64MultiArray", ["-1", "data: [-1, -2]"], [-1.0, -2.0]),
        ("std_msgs/Float64MultiArray", ["-1", "{}", "- -1\n- -2"], [-1.0, -2.0]),
    ],
)
def test_negative_numbers_are_values_and_no_options(type_name, words, data, topic, receiver, cli):
    received = receiver.subscribe(topic, type_name)
    assert cli("pub", "-w", "0", topic, type_name, *words).code == 0
    assert [message["data"] for message in received()] == [data]


@pytest.mark.parametrize(
    "words",
    [
        ["geometry_msgs/Twist", "{linear: [1, 2, x]}"],
        ["std_msgs/String", "x", "y"],
        ["geometry_msgs/Vector3", "-1", "0", "0"],
        ["std_msgs/String", "-f", "second_is_bad.yaml"],
        ["std_msgs/String", "x", "--timeout", "1s"],
    ],
)
def test_mistake_sends_nothing(words, topic, receiver, cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "second_is_bad.yaml").write_text("data: one\n---\ndata: [2]\n")
    received = receiver.subscribe(topic)
    result = cli("pub", topic, *words)
    assert (result.code, result.out) == (2, "")
    assert result.err.count("\n") == 1
    assert received() == []


def test_latched_message_comes_again_to_each_that_subscribes_later(topic, receiver, cli):
    late = []

    def all_have_it(written):
        if "publishing and latching message. Press ctrl-C to terminate\n" not in written:
            return False
        if not late or (len(late) < 3 and late[-1]()):
            node = receiver if not late else receiver.another()
            late.append(node.subscribe(topic))
        return len(late) == 3 and bool(late[-1]())

    result = cli("pub", topic, "std_msgs/String", "data: stay", until=all_have_it)
    assert result.code == 130
    assert all(found()[-1] == {"data": "stay"} for found in late)


def test_once_waits_for_one_who_can_receive(topic, receiver, cli):
    late = []

    def subscribes_late(_):
        if not late and receiver.node.graph().topic(topic).publishers:
            late.append(receiver.subscribe(topic))
        return False

    receiver.node.graph()
    result = cli("pub", "-1", topic, "std_msgs/String", "data: hello", until=subscribes_late)
    assert result.ok() == ""
    assert late[0]() == [{"data": "hello"}]


def test_once_does_not_wait_for_a_subscriber_of_another_type(receiver, topic, cli):
    receiver.subscribe(topic)
    result = cli("pub", "-1", topic, "std_msgs/Int32", "3")
    assert result.code == 0
    parts = (topic, "std_msgs/Int32", "/receiver", "std_msgs/String", "; publishing anyway\n")
    assert_line(result.err, "lcmtools pub: no node", *parts)


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
def test_names_are_resolved_and_remapped_as_a_nodes(words, receiver, cli):
    received = receiver.subscribe("/named/chatter")
    assert cli("pub", "-1", *words).ok() == ""
    assert received() == [{"data": "x"}]
    receiver.forget("/named/chatter")


_PLAIN_SUBSCRIBER = """
import lcm
bus = lcm.LCM()
bus.subscribe(".*PLAIN", lambda channel, payload: print("received", channel, flush=True))
print("ready", flush=True)
while True:
    bus.handle()
"""


@pytest.mark.parametrize("option", ["--plain-channel", "--literal"])
def test_a_plain_channel_is_taken_to_the_letter(option, start_python, cli):
    plain = start_python(_PLAIN_SUBSCRIBER)
    plain.wait_for("ready")
    cli("pub", "-1", option, "PLAIN", "std_msgs/String", "x")
    assert plain.wait_for("received") == "received PLAIN"
    cli("pub", "-1", "PLAIN", "std_msgs/String", "x")
    assert plain.wait_for("received") == "received /PLAIN"


def test_domain_chooses_the_bus(cli, monkeypatch):
    monkeypatch.delenv("LCM_DEFAULT_URL")
    result = cli("list", env={"LCMTOOLS_DOMAIN": "231"})
    assert_line(result.err, "no topics", "udpm://239.255.76.67:7898?ttl=0\n")
    for line in (["--domain", "231", "list"], ["list", "--domain", "231"]):
        assert cli(*line, env={"LCMTOOLS_DOMAIN": "5"}).err == result.err
