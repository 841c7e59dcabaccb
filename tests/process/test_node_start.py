"""The start of a node, and the end of nodes and commands by a closed terminal."""

import os
import signal
from collections.abc import Callable
from typing import Any

import pytest
from fixtures.says import assert_says

from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Role

Start = Callable[..., Any]
SCRIPT = """
import lcmtools
from lcmtools import Node
lcmtools.init()
node = Node("own")
print("ready")
lcmtools.spin(node)
print("ended")
"""
HANGS_UP = f"""
import signal
signal.signal(signal.SIGHUP, signal.SIG_{{}})
{SCRIPT.replace('print("ready")', 'node.create_timer(0.02, lambda: print("tick"))')}"""


@pytest.fixture
def run(start_python, bus_url):
    """Start the script on the test's bus."""

    def start(*arguments):
        return start_python(SCRIPT, *arguments, LCM_DEFAULT_URL=bus_url)

    return start


def test_a_program_says_which_of_its_words_names_nothing(run):
    node = run("__ns=/husky0", "file=1", "--", ":=b")
    line = node.wait_for("names nothing")
    assert_says(line, "'__ns=/husky0'", "; did you mean __ns:=/husky0?")
    node.wait_for("ready")
    assert "file=1" not in node.output
    assert ":=b" not in node.output


def test_a_program_says_which_of_its_names_no_node_uses(run):
    node = run("chater:=/a", "speed:=3", "/rosout:=/log", "lr=3", "_lr=3", "rosout=b")
    node.wait_for("'rosout=b'")
    assert [line.partition("[/own]: ")[2] for line in node.lines if "[WARN]" in line] == [
        "chater:=/a has no effect: no topic or service here is named 'chater'",
        "speed:=3 has no effect: no topic or service here is named 'speed'",
        "'_lr=3' names nothing; did you mean _lr:=3?",
        "'rosout=b' names nothing; did you mean rosout:=b?",
    ]


def test_the_second_node_of_a_name_says_so(run):
    first = run()
    first.wait_for("ready")
    line = run().wait_for("of this name too")
    assert f"pid {first.pid} is" in line
    assert_says(line, "[/own]: ", "__name:=own2")
    other = run("__name:=own2")
    other.wait_for("ready")
    assert "too" not in other.output


def test_a_second_publisher_of_the_time_is_told_another_bus(start_python, bus_url, wait_until):
    clock = SCRIPT.replace('print("ready")', 'node.create_publisher(Clock, "/clock")')
    script = f"from lcmtools.types.rosgraph_msgs import Clock\n{clock}"
    first = start_python(script, LCM_DEFAULT_URL=bus_url)
    records = NodeRecords(parse_url(bus_url), os.environ)
    wait_until(lambda: "/clock" in records.topics({x.id for x in records.read()}, Role.PUBLISHER))
    second = start_python(script, LCM_DEFAULT_URL=bus_url)
    assert_says(second.wait_for("of this name too"), f"pid {first.pid} is", "with --domain 1")


def test_a_node_that_starts_anew_says_nothing(run):
    for _ in range(2):
        node = run()
        node.wait_for("ready")
        node.send_signal(signal.SIGKILL)
        node.wait()
        assert "too" not in node.output


def test_a_closed_terminal_ends_a_node_with_a_goodbye(start_python, bus_url):
    node = start_python(HANGS_UP.format("DFL"), LCM_DEFAULT_URL=bus_url)
    records = NodeRecords(parse_url(bus_url), os.environ)
    node.wait_for("tick")
    assert [one.name for one in records.read()] == ["/own"]
    node.send_signal(signal.SIGHUP)
    node.send_signal(signal.SIGHUP)  # the shell, and the terminal
    node.wait_for("ended")
    assert node.wait() in (0, -signal.SIGHUP)  # the second one may come after shutdown
    assert list(records.read()) == []


def test_nohup_lets_a_node_go_on(start_python, bus_url):
    node = start_python(HANGS_UP.format("IGN"), LCM_DEFAULT_URL=bus_url)
    node.wait_for("tick")
    node.send_signal(signal.SIGHUP)
    for _ in range(20):
        node.wait_for("tick")
    assert "ended" not in node.output


@pytest.mark.parametrize(("command", "ready"), [("echo", "hello"), ("pub", "latching")])
def test_a_closed_terminal_ends_a_command_with_a_goodbye(
    start, lcmtools_path, bus_url, command, ready
):
    talker = start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url)
    talker.wait_for("hello")
    words = ["/chatter", *(["std_msgs/String", "a"] if command == "pub" else [])]
    program = start(lcmtools_path, command, *words, LCM_DEFAULT_URL=bus_url)
    program.wait_for(ready)
    program.send_signal(signal.SIGHUP)
    assert program.wait() == 129
    records = NodeRecords(parse_url(bus_url), os.environ)
    assert [one.name for one in records.read()] == ["/talker"]
