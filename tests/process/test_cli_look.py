"""list, info, type, echo, hz and node ... on a bus with a talker and a listener."""

import json
import os
import re
import socket
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]

HOST = socket.gethostname()

pytestmark = pytest.mark.usefixtures("use_module_bus", "nodes")


@pytest.fixture(scope="module")
def nodes(module_start: Callable[..., Any], lcmtools_path: str) -> dict[str, int]:
    """A talker and a listener that have met; their pids."""
    listener = module_start(lcmtools_path, "run", "listener")
    talker = module_start(lcmtools_path, "run", "talker")
    listener.wait_for("I heard: [hello world")
    return {"talker": talker.pid, "listener": listener.pid}


def test_list_prints_the_topics_sorted(lcmtools: Run) -> None:
    result = lcmtools("list")
    assert (result.returncode, result.stdout, result.stderr) == (0, "/chatter\n/rosout\n", "")


def test_topic_list_is_list(lcmtools: Run) -> None:
    assert lcmtools("topic", "list").stdout == lcmtools("list").stdout


def test_list_v_has_the_sections_of_rostopic(lcmtools: Run) -> None:
    assert lcmtools("list", "-v").stdout == (
        "\n"
        "Published topics:\n"
        " * /chatter [std_msgs/String] 1 publisher\n"
        " * /rosout [rosgraph_msgs/Log] 2 publishers\n"
        "\n"
        "Subscribed topics:\n"
        " * /chatter [std_msgs/String] 1 subscriber\n"
        "\n"
    )


def test_list_t_shows_the_types(lcmtools: Run) -> None:
    lines = lcmtools("list", "-t").stdout.splitlines()
    assert lines == ["/chatter [std_msgs/String]", "/rosout [rosgraph_msgs/Log]"]


def test_list_json_has_who_publishes_and_who_subscribes(lcmtools: Run) -> None:
    assert json.loads(lcmtools("list", "--json").stdout)[0] == {
        "topic": "/chatter",
        "type": "std_msgs/String",
        "publishers": ["/talker"],
        "subscribers": ["/listener"],
        "other_senders": [],
    }


@pytest.mark.parametrize("name", ["chatter", "/chatter", "/chatter/"])
def test_list_keeps_to_a_namespace_or_topic(name: str, lcmtools: Run) -> None:
    assert lcmtools("list", name).stdout == "/chatter\n"


def test_list_of_a_namespace_where_nothing_is_says_so_on_standard_error(
    lcmtools: Run, module_bus_url: str
) -> None:
    result = lcmtools("list", "/chat")
    assert (result.returncode, result.stdout) == (0, "")
    assert result.stderr == f"no topics in /chat on {module_bus_url}\n"


def test_list_all_shows_hidden_topics_too(
    lcmtools: Run, start: Callable[..., Any], lcmtools_path: str
) -> None:
    hidden = start(lcmtools_path, "pub", "-r", "20", "/_hidden/a", "std_msgs/String", "x")
    hidden.wait_for("no node subscribes")
    assert "/_hidden/a" not in lcmtools("list").stdout
    assert "/_hidden/a" in lcmtools("list", "--all").stdout.splitlines()


def test_info_names_type_nodes_hosts_and_processes(lcmtools: Run, nodes: dict[str, int]) -> None:
    result = lcmtools("info", "chatter")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == (
        "Type: std_msgs/String\n"
        "\n"
        "Publishers: \n"
        f" * /talker ({HOST}, pid {nodes['talker']})\n"
        "\n"
        "Subscribers: \n"
        f" * /listener ({HOST}, pid {nodes['listener']})\n"
        "\n"
        "\n"
    )


def test_info_says_none_where_nobody_is(lcmtools: Run) -> None:
    assert lcmtools("info", "/rosout").stdout.endswith("\nSubscribers: None\n\n\n")


def test_info_json_has_the_endpoints_with_their_counters(
    lcmtools: Run, nodes: dict[str, int]
) -> None:
    (topic,) = json.loads(lcmtools("info", "--json", "/chatter").stdout)
    (publisher,) = topic["publishers"]
    assert topic["type"] == "std_msgs/String"
    assert (publisher["node"], publisher["pid"]) == ("/talker", nodes["talker"])
    assert publisher["messages"] > 0
    assert publisher["bytes"] > publisher["messages"] * len("hello world")
    assert [e["node"] for e in topic["subscribers"]] == ["/listener"]
    assert topic["other_publishers"] == []


@pytest.mark.parametrize("command", ["info", "type"])
def test_unknown_topic_is_exit_code_1_with_a_near_miss(command: str, lcmtools: Run) -> None:
    result = lcmtools(command, "chater")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (f"lcmtools {command}: unknown topic /chater; did you mean /chatter?\n")


def test_topic_of_another_namespace_is_a_near_miss(lcmtools: Run) -> None:
    assert lcmtools("info", "/robot/chatter").stderr.endswith("; did you mean /chatter?\n")


def test_topic_like_no_other_leads_to_list(lcmtools: Run) -> None:
    result = lcmtools("info", "zzz")
    assert result.stderr == "lcmtools info: unknown topic /zzz; lcmtools list shows the topics\n"


def test_type_prints_the_type_alone(lcmtools: Run) -> None:
    assert lcmtools("type", "chatter").stdout == "std_msgs/String\n"
    assert json.loads(lcmtools("type", "/chatter", "--json").stdout) == {
        "topic": "/chatter",
        "type": "std_msgs/String",
    }


@pytest.mark.parametrize("name", ["chatter", "/chatter"])
def test_echo_n_prints_so_many_messages_as_rostopic_does(name: str, lcmtools: Run) -> None:
    result = lcmtools("echo", "-n", "2", name)
    assert (result.returncode, result.stderr) == (0, "")
    first, second = re.fullmatch(
        r'data: "hello world (\d+)"\n---\ndata: "hello world (\d+)"\n---\n', result.stdout
    ).groups()  # type: ignore[union-attr] # no match fails the test as well
    assert int(second) == int(first) + 1


def test_echo_json_is_an_object_a_line(lcmtools: Run) -> None:
    lines = lcmtools("echo", "--json", "-n", "3", "chatter").stdout.splitlines()
    assert len(lines) == 3
    assert all(json.loads(line)["data"].startswith("hello world ") for line in lines)


@pytest.mark.parametrize("option", ["--once", "-1"])
def test_echo_once_is_one_message(option: str, lcmtools: Run) -> None:
    assert lcmtools("echo", option, "/chatter").stdout.count("---\n") == 1


def test_echo_gives_up_after_its_timeout_with_exit_code_4(lcmtools: Run) -> None:
    result = lcmtools("echo", "chater", "--timeout", "200ms")
    assert (result.returncode, result.stdout) == (4, "")
    assert result.stderr == (
        "lcmtools echo: nothing came on chater within 0.2 s; did you mean /chatter?\n"
    )


def test_echo_tells_what_is_on_the_bus_while_nothing_comes(
    start: Callable[..., Any], lcmtools_path: str
) -> None:
    echo = start(lcmtools_path, "echo", "/zzz")
    line = echo.wait_for("no message on /zzz yet")
    assert line == "lcmtools echo: no message on /zzz yet; on the bus: /chatter, /rosout"


def test_echo_is_seen_as_a_subscriber_while_it_runs(
    lcmtools: Run, start: Callable[..., Any], lcmtools_path: str
) -> None:
    echo = start(lcmtools_path, "echo", "chatter")
    echo.wait_for("---")
    assert (
        f"/_lcmtools_echo_{echo.pid} ({HOST}, pid {echo.pid})" in lcmtools("info", "chatter").stdout
    )


def test_hz_prints_the_lines_of_rostopic(start: Callable[..., Any], lcmtools_path: str) -> None:
    hz = start(lcmtools_path, "hz", "chatter")
    hz.wait_for("subscribed to [/chatter]")
    assert hz.lines[0] == "subscribed to [/chatter]"
    rate = float(hz.wait_for("average rate: ").removeprefix("average rate: "))
    spread = hz.wait_for("min: ")
    assert rate == pytest.approx(10, abs=2.5)
    assert re.fullmatch(r"\tmin: 0\.\d{3}s max: 0\.\d{3}s std dev: 0\.\d{5}s window: \d+", spread)


def test_hz_w_limits_the_window(start: Callable[..., Any], lcmtools_path: str) -> None:
    hz = start(lcmtools_path, "hz", "/chatter", "-w", "3")
    assert hz.wait_for("window: ").endswith("window: 3")


def test_hz_json_is_an_object_a_line(start: Callable[..., Any], lcmtools_path: str) -> None:
    hz = start(lcmtools_path, "hz", "--json", "/chatter")
    measured = json.loads(hz.wait_for("rate"))
    assert measured["topic"] == "/chatter"
    assert measured["rate"] == pytest.approx(10, abs=2.5)
    assert measured["min"] <= 1 / measured["rate"] <= measured["max"]


def test_hz_gives_up_after_its_timeout_with_exit_code_4(lcmtools: Run) -> None:
    result = lcmtools("hz", "/zzz", "--timeout", "200ms")
    assert (result.returncode, result.stdout) == (4, "")
    assert result.stderr.endswith("lcmtools hz: nothing came on /zzz within 0.2 s\n")


def test_node_list_prints_the_nodes_sorted(lcmtools: Run) -> None:
    result = lcmtools("node", "list")
    assert (result.returncode, result.stdout, result.stderr) == (0, "/listener\n/talker\n", "")


def test_node_info_has_the_sections_of_rosnode(lcmtools: Run, nodes: dict[str, int]) -> None:
    result = lcmtools("node", "info", "talker")
    assert result.returncode == 0
    text, up = re.subn(r"Up for: \d+ s\n", "Up for: N s\n", result.stdout)
    command = re.search(r"\nCommand: (.*)\n", text)
    assert up == 1
    assert command is not None
    assert command[1].endswith("lcmtools run talker")
    assert text == (
        f"{'-' * 80}\n"
        "Node [/talker]\n"
        "Publications: \n"
        " * /chatter [std_msgs/String]\n"
        " * /rosout [rosgraph_msgs/Log]\n"
        "\n"
        "Subscriptions: None\n"
        "\n"
        "Services: None\n"
        "\n"
        "\n"
        f"Host: {HOST}\n"
        f"Pid: {nodes['talker']}\n"
        f"{command[0].strip()}\n"
        "Up for: N s\n"
        "Connections:\n"
        " * topic: /chatter\n"
        "    * to: /listener\n"
        "\n"
    )


def test_node_info_json_has_publications_and_subscriptions(lcmtools: Run) -> None:
    talker, listener = json.loads(lcmtools("node", "info", "--json", "/talker", "listener").stdout)
    assert [e["topic"] for e in talker["publications"]] == ["/chatter", "/rosout"]
    assert [e["topic"] for e in listener["subscriptions"]] == ["/chatter"]
    assert listener["stale"] is None


@pytest.mark.parametrize("command", ["info", "ping"])
def test_unknown_node_is_exit_code_1_with_a_near_miss(command: str, lcmtools: Run) -> None:
    result = lcmtools("node", command, "talkr")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (
        f"lcmtools node {command}: unknown node talkr; did you mean /talker?\n"
    )


def test_node_ping_times_the_answers(lcmtools: Run) -> None:
    result = lcmtools("node", "ping", "-c", "2", "talker")
    assert (result.returncode, result.stderr) == (0, "")
    head, *replies, average = result.stdout.splitlines()
    assert head == "pinging /talker with a timeout of 3.0s"
    assert len(replies) == 2
    assert all(
        re.fullmatch(rf"reply from /talker \({re.escape(HOST)}\)\ttime=\d+\.\d{{6}}ms", reply)
        for reply in replies
    )
    assert re.fullmatch(r"ping average: \d+\.\d{6}ms", average)


def test_node_ping_json_is_one_document(lcmtools: Run) -> None:
    document = json.loads(lcmtools("node", "ping", "-c", "1", "--json", "talker").stdout)
    assert document["node"] == "/talker"
    assert 0 < document["times"][0] < 1


def test_wtf_finds_nothing_wrong_with_exit_code_0(lcmtools: Run) -> None:
    result = lcmtools("wtf", "--wait", "0.2s")
    assert (result.returncode, result.stdout, result.stderr) == (0, "No errors or warnings\n", "")
    assert json.loads(lcmtools("wtf", "--wait", "0.2s", "--json").stdout) == []


@pytest.mark.parametrize("place", ["before", "after"])
def test_bus_can_be_said_before_and_after_the_commands_name(
    place: str, lcmtools: Run, module_bus_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("LCM_DEFAULT_URL")
    option = ("--lcm-url", module_bus_url)
    for command in (("list",), ("topic", "list")):
        line = (*option, *command) if place == "before" else (*command, *option)
        assert lcmtools(*line).stdout == "/chatter\n/rosout\n"
    line = ("node", *option, "list") if place == "before" else ("node", "list", *option)
    assert lcmtools(*line).stdout == "/listener\n/talker\n"


def test_topic_names_resolve_in_the_shells_namespace(lcmtools: Run) -> None:
    result = lcmtools("info", "chatter", LCMTOOLS_NAMESPACE="/husky0")
    assert result.stderr == (
        "lcmtools info: unknown topic /husky0/chatter; did you mean /chatter?\n"
    )


def test_commands_leave_no_trace_on_the_bus(lcmtools: Run) -> None:
    lcmtools("echo", "-1", "chatter")
    assert lcmtools("node", "list", "--all").stdout == "/listener\n/talker\n"
    records = os.path.expandvars("$XDG_RUNTIME_DIR/lcmtools/nodes")
    left = [name for _, _, files in os.walk(records) for name in files if "echo" in name]
    assert left == []
