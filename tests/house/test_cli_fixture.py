"""The fixture that runs commands in the test's process keeps its promises."""

import os
import signal
import sys
import threading
from pathlib import Path

import pytest

from lcmtools.labs.nodes.talker import Talker


def test_a_command_gives_its_exit_code_and_both_streams(cli, bus_url):
    assert cli("msg", "proto", "std_msgs/String").ok() == "data: ''\n"
    failed = cli("info", "/nothing", "--lcm-url", bus_url)
    assert (failed.code, failed.out) == (1, "")
    assert failed.err == ("lcmtools info: unknown topic /nothing; lcmtools list shows the topics\n")
    assert "exit code 1" in repr(failed)
    assert failed.err in repr(failed)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_command_that_goes_on_is_ended_by_a_signal(number, cli, bus_url):
    result = cli("run", "talker", "--lcm-url", bus_url, until="hello world 1", ends_by=number)
    assert (result.code, result.out) == (0, "")
    assert "hello world 1" in result.err


def test_a_command_reads_its_input_and_leaves_the_process_as_it_was(cli, bus_url):
    before = dict(os.environ), Path.cwd(), list(sys.path), sys.argv, sys.stdin, sys.stdout
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    threads = threading.active_count()
    env = {"LCM_DEFAULT_URL": bus_url, "LCMTOOLS_DEBUG": "1"}
    result = cli("pub", "/a", "std_msgs/String", input="data: x\n---\ndata: y\n", env=env)
    assert result.code == 0
    assert (dict(os.environ), Path.cwd(), list(sys.path), sys.argv, sys.stdin, sys.stdout) == before
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == handlers
    assert threading.active_count() <= threads


def test_what_a_command_starts_writes_into_the_same_streams(cli, tmp_path, monkeypatch):
    script = tmp_path / "hello.launch.yaml"
    script.write_text("nodes: [{exec: echo hello}]\n")
    monkeypatch.chdir(tmp_path)
    assert "hello" in cli("launch", str(script)).out


def test_nodes_of_the_process_are_on_the_bus_like_others(cli, bus_url, start_node, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    talker = start_node(Talker, "__ns:=/a")
    start_node(Talker)
    assert cli("node", "list").ok() == "/a/talker\n/talker\n"
    assert "hello world" in cli("echo", "/a/chatter", "-n", "1").ok()
    talker.end()
    assert cli("node", "list").ok() == "/talker\n"
