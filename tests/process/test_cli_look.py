"""list, info, type, echo, hz and node ... on a bus with a talker and a listener."""

import json
import os
import re
import socket

import pytest
from fixtures.says import assert_says

from lcmtools.bus.sockets import SocketTable

HOST = socket.gethostname()

pytestmark = pytest.mark.usefixtures("use_module_bus", "nodes")


@pytest.fixture(scope="module")
def nodes(module_start, lcmtools_path):
    """A talker and a listener that have met; their pids."""
    listener = module_start(lcmtools_path, "run", "listener")
    talker = module_start(lcmtools_path, "run", "talker")
    listener.wait_for("I heard: [hello world")
    return {"talker": talker.pid, "listener": listener.pid}


def test_list_hz_measures_how_often_messages_come(cli):
    chatter, rosout = cli("list", "--hz", "-t").out.splitlines()
    name, kind, rate, unit = chatter.split()
    assert (name, kind, unit) == ("/chatter", "[std_msgs/String]", "Hz")
    assert float(rate) == pytest.approx(10, abs=2.5)
    assert rosout.startswith("/rosout [rosgraph_msgs/Log]")
    (record,) = json.loads(cli("list", "--hz", "--json", "chatter").out)
    assert record["rate"] == pytest.approx(10, abs=2.5)
    assert ", " in cli("list", "--hz", "-v", "chatter").out
    assert "rate" not in json.loads(cli("list", "--json", "chatter").out)[0]


def test_info_names_type_nodes_hosts_and_processes(cli, nodes):
    result = cli("info", "chatter")
    assert (result.code, result.err) == (0, "")
    counters = (
        r"     messages: \d+, bytes: \d+, drops: 0, depth: \d+, rate: (\d+\.\d\d) Hz,"
        r" last: \d\.\d s ago"
    )
    text = re.fullmatch(
        r"Type: std_msgs/String\n"
        r"\n"
        r"Publishers: \n"
        rf" \* /talker \({re.escape(HOST)}, pid {nodes['talker']}\)\n"
        rf"{counters}\n"
        r"\n"
        r"Subscribers: \n"
        rf" \* /listener \({re.escape(HOST)}, pid {nodes['listener']}\)\n"
        rf"{counters}, callbacks: [\d.]+ ms mean, [\d.]+ m?s longest\n"
        r"\n"
        r"\n",
        result.out,
    )
    assert text, result.out
    assert [float(rate) for rate in text.groups()] == pytest.approx([10, 10], abs=2.5)


def test_echo_tells_what_is_on_the_bus_while_nothing_comes(start, lcmtools_path):
    echo = start(lcmtools_path, "echo", "/zzz")
    line = echo.wait_for("no message on /zzz yet")
    assert_says(line, "lcmtools echo: ", "no message", "/zzz", "; on the bus: /chatter, /rosout")


def test_echo_is_seen_as_a_subscriber_while_it_runs(cli, start, lcmtools_path):
    echo = start(lcmtools_path, "echo", "chatter")
    echo.wait_for("---")
    assert f"/_lcmtools_echo_{echo.pid} ({HOST}, pid {echo.pid})" in cli("info", "chatter").out


def test_node_info_has_the_sections_of_rosnode(cli, nodes):
    result = cli("node", "info", "talker")
    assert result.code == 0
    assert result.out.startswith(
        f"{'-' * 80}\n"
        "Node [/talker]\n"
        "Publications: \n"
        " * /chatter [std_msgs/String]\n"
        " * /rosout [rosgraph_msgs/Log]\n"
        "\n"
        "Subscriptions: None\n"
        "\n"
        "Services: "
    )
    assert f"\nHost: {HOST}\nPid: {nodes['talker']}\n" in result.out
    assert re.search(r"\nCommand: .*lcmtools run talker\n", result.out)
    assert re.search(r"\nUp for: \d+ s\n", result.out)
    assert result.out.endswith("Connections:\n * topic: /chatter\n    * to: /listener\n\n")


def test_node_ping_times_the_answers(cli):
    result = cli("node", "ping", "-c", "2", "talker")
    assert (result.code, result.err) == (0, "")
    head, *replies, average, extremes = result.out.splitlines()
    assert head == "pinging /talker with a timeout of 3.0s"
    assert len(replies) == 2
    assert all(
        re.fullmatch(rf"reply from /talker \({re.escape(HOST)}\)\ttime=\d+\.\d{{6}}ms", reply)
        for reply in replies
    )
    assert re.fullmatch(r"ping average: \d+\.\d{6}ms", average)
    assert re.fullmatch(r"shortest: \d+\.\d{6}ms, longest: \d+\.\d{6}ms", extremes)


def test_wtf_finds_nothing_wrong_with_exit_code_0(cli):
    wtf = ("wtf", "--wait", "0.2s", "--ignore", "other-buses")  # where other tests run meanwhile
    result = cli(*wtf)
    assert (result.code, result.out, result.err) == (0, "No errors or warnings\n", "")
    assert json.loads(cli(*wtf, "--json").out) == []


@pytest.mark.parametrize("place", ["before", "after"])
def test_bus_can_be_said_before_and_after_the_commands_name(
    place, cli, module_bus_url, monkeypatch
):
    monkeypatch.delenv("LCM_DEFAULT_URL")
    option = ("--lcm-url", module_bus_url)
    for command in (("list",), ("topic", "list")):
        line = (*option, *command) if place == "before" else (*command, *option)
        assert cli(*line).out == "/chatter\n/rosout\n"
    line = ("node", *option, "list") if place == "before" else ("node", "list", *option)
    assert cli(*line).out == "/listener\n/talker\n"


def test_commands_leave_no_trace_on_the_bus(cli):
    cli("node", "cleanup")  # of what other tests have killed
    cli("echo", "-1", "chatter")
    left = json.loads(cli("node", "list", "--all", "--json").out)
    assert [node["node"] for node in left] == ["/listener", "/talker"]
    records = os.path.expandvars("$XDG_RUNTIME_DIR/lcmtools/records")
    assert sum(len(files) for _, _, files in os.walk(records)) == len(left)


def test_nodes_of_other_users_are_no_programs_without_a_node(cli, monkeypatch):
    monkeypatch.setattr(SocketTable, "holders", {})
    listed = cli("node", "list", "-a").out
    assert "/listener" in listed
    assert "Programs that are no nodes" not in listed
