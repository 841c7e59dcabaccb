"""pub waits for subscribers, keeps its rate, stamps what it sends, and serves who comes late."""

import json
import os
import socket
import time
from itertools import count

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools import Node
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import NodeInfo
from lcmtools.publish import subscriber_wait
from lcmtools.types.rosgraph_msgs import Clock

STRING = "std_msgs/String"

pytestmark = pytest.mark.usefixtures("use_module_bus")
_topics = count()


@pytest.fixture
def topic():
    """A topic of the test's own."""
    return f"/waits{next(_topics)}"


def published(result):
    """The messages that pub -v prints."""
    rows = [row.partition(": ") for row in result.err.splitlines()]
    return [json.loads(rest) for head, _, rest in rows if head.startswith("publishing #")]


def test_as_many_subscribers_as_asked_are_waited_for(topic, receiver, cli, monkeypatch):
    monkeypatch.setattr(subscriber_wait, "_PATIENCE", 0.1)
    waits = f"lcmtools pub: waiting for 2 subscribers of {topic}; 0 so far\n"
    late = []

    def subscribe(written):
        if waits in written and not late:
            late.extend(node.subscribe(topic) for node in (receiver, receiver.another()))
        return False

    result = cli("pub", "-1", "-w", "2", topic, STRING, "x", until=subscribe)
    assert (result.code, result.err) == (0, waits)
    assert [received() for received in late] == [[{"data": "x"}]] * 2


@pytest.mark.parametrize("words", [["-w", "1"], ["-1"], ["-t", "2"], ["-r", "5", "-w", "1"]])
def test_subscribers_that_do_not_come_in_time_are_exit_code_4(words, topic, cli):
    result = cli("pub", *words, "--timeout", "100ms", topic, STRING, "x")
    assert (result.code, result.out) == (4, "")
    parts = ("0.1 s: ", f"1 subscriber of {topic}; 0 so far; ", f"lcmtools info {topic}")
    assert_line(result.err, "lcmtools pub: ", *parts)


_PLAIN_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("PLAIN", lambda channel, payload: print("received", flush=True))
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_plain_lcm_programs_are_not_waited_for(start_python, bus_url, cli, monkeypatch):
    words = ("pub", "-1", "--literal", "PLAIN", STRING, "x")
    bus = {"LCM_DEFAULT_URL": bus_url}
    alone = cli(*words, env=bus)
    assert_says(alone.err, "lcmtools pub: no node", "PLAIN")

    monkeypatch.setattr(subscriber_wait, "_LONGEST", 2000.0)
    monkeypatch.setattr(subscriber_wait, "_ANSWERED", 1000.0)  # every node here has answered
    plain = start_python(_PLAIN_LISTENER, **bus)
    plain.wait_for("ready")
    assert cli(*words, env=bus).ok() == ""
    plain.wait_for("received")


def test_nodes_of_this_computer_that_have_not_answered_are_waited_for(
    start_python, bus_url, cli, monkeypatch, tmp_path
):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setattr(subscriber_wait, "_ANSWERED", 0.3)
    records = NodeRecords(parse_url(bus_url), {"XDG_RUNTIME_DIR": str(tmp_path)})
    records.write(NodeInfo(name="/busy", id="busy", host=socket.gethostname(), pid=os.getpid()))
    bus = {"LCM_DEFAULT_URL": bus_url, "XDG_RUNTIME_DIR": str(tmp_path)}
    start_python(_PLAIN_LISTENER, **bus).wait_for("ready")
    started = time.monotonic()
    assert cli("pub", "-1", "--literal", "PLAIN", STRING, "x", env=bus).ok() == ""
    assert time.monotonic() - started > 0.3  # seconds


def test_each_message_is_stamped_when_it_is_sent(topic, cli):
    before = time.time_ns()
    words = ["geometry_msgs/PoseStamped", "{header: auto, pose: {position: {x: 1}}}"]
    result = cli("pub", "-v", "-w", "0", "-s", "-t", "3", "-r", "20", topic, *words)
    stamps = [message["header"]["stamp"] for message in published(result)]
    times = [stamp["sec"] * 1_000_000_000 + stamp["nsec"] for stamp in stamps]
    assert before < times[0] < times[1] < times[2] < time.time_ns()
    assert times[2] - times[0] > 50_000_000  # nanoseconds


def test_stamps_may_be_simulated_time(topic, start_node, bus_url, cli):
    def clock():
        node = Node("clock")
        publisher = node.create_publisher(Clock, "/clock")
        message = Clock()
        message.clock.sec, message.clock.nsec = 12, 34
        node.create_timer(0.02, lambda: publisher.publish(message))
        return node

    words = ("pub", "-1", "-w", "0", "--use-rostime", topic, "std_msgs/Header", "stamp: now")
    bus = {"LCM_DEFAULT_URL": bus_url}
    running = start_node(clock)
    result = cli(*words, "-v", env=bus)
    assert published(result) == [{"seq": 0, "stamp": {"sec": 12, "nsec": 34}, "frame_id": ""}]
    running.end()
    result = cli(*words, "--timeout", "100ms", env=bus)
    assert result.code == 4
    assert_line(result.err, "lcmtools pub: ", "/clock", "0.1 s; ", "simulator")


@pytest.mark.parametrize("words", [["-1", "--keep-alive", "50s"], ["-l", "-r", "0.05"]])
def test_late_subscribers_get_the_last_message_again(words, topic, receiver, cli):
    late = []

    def has_come(written):
        if "publishing #1: " in written and not late:
            late.append(receiver.subscribe(topic))
        return "publishing #1 again, to a new subscriber\n" in written

    result = cli("pub", "-v", "-w", "0", *words, topic, STRING, "data: stay", until=has_come)
    assert result.code == 130
    assert late[0]() == [{"data": "stay"}]


def test_keep_alive_ends_after_so_long(topic, cli):
    started = time.monotonic()
    assert cli("pub", "-1", "-w", "0", "--keep-alive", "200ms", topic, STRING, "x").ok() == ""
    assert time.monotonic() - started > 0.2  # seconds


_COUNTER = """
import sys, time
import lcm
bus = lcm.LCM()
times = []
bus.subscribe(sys.argv[1], lambda channel, payload: times.append(time.monotonic()))
print("ready", flush=True)
while len(times) < int(sys.argv[2]):
    bus.handle()
print("rate", (len(times) - 1) / (times[-1] - times[0]), flush=True)
"""


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_a_thousand_messages_a_second_are_kept_without_drift(
    topic, start, start_python, lcmtools_path
):
    counter = start_python(_COUNTER, topic, "1500")
    counter.wait_for("ready")
    start(lcmtools_path, "pub", "-r", "1000", topic, "std_msgs/Header", "auto")
    rate = float(counter.wait_for("rate").split()[1])
    assert rate == pytest.approx(1000, rel=0.05)
