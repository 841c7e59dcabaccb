"""wtf, each rule provoked by real processes; and node cleanup, which mends one of them."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(autouse=True)
def _bus(bus_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.fixture
def node(
    start: Callable[..., Any], lcmtools: Run, lcmtools_path: str, wait_until: Callable[..., None]
) -> Callable[..., Any]:
    """``node("talker", "__ns:=/a")``: a node that is on the bus."""

    def run(*arguments: str) -> Any:
        program = start(lcmtools_path, "run", *arguments)
        wait_until(lambda: f'"pid": {program.pid},' in lcmtools("node", "list", "--json").stdout)
        return program

    return run


@pytest.fixture
def wtf(lcmtools: Run) -> Callable[[], tuple[int, str]]:
    """Exit code and output of a short wtf."""

    def run() -> tuple[int, str]:
        # other tests' buses are on this computer too
        result = lcmtools("wtf", "--wait", "0.2s", "--ignore", "other-buses")
        assert result.stderr == ""
        return result.returncode, result.stdout

    return run


def test_unconnected_subscriptions_are_listed_as_roswtf_does(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]]
) -> None:
    node("simple_controller")
    code, text = wtf()
    assert code == 1
    assert text == (
        "Found 1 warning(s).\n"
        "Warnings are things that may be just fine, but are sometimes at fault\n"
        "\n"
        "WARNING The following node subscriptions are unconnected:\n"
        " * /simple_controller:\n"
        "   * /odometry\n"
        "   * /desired_velocity\n"
        "\n"
        "Found 1 note(s).\n"
        "Notes are seldom at fault\n"
        "\n"
        "NOTE The following node publications have no announced subscriber:\n"
        " * /simple_controller:\n"
        "   * /controlled_velocity\n"
    )


def test_subscription_is_connected_by_a_latching_pub(
    node: Callable[..., Any],
    start: Callable[..., Any],
    wtf: Callable[[], tuple[int, str]],
    lcmtools_path: str,
) -> None:
    node("listener")
    pub = start(lcmtools_path, "pub", "/chatter", "std_msgs/String", "hi")
    pub.wait_for("publishing and latching")
    assert wtf() == (0, "No errors or warnings\n")


def test_namespace_that_is_missing_is_proposed(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]]
) -> None:
    node("talker", "__ns:=/robot")
    node("listener")
    code, text = wtf()
    assert code == 1
    assert "\n * /listener:\n   * /chatter\n" in text
    assert "   -> /robot/chatter is published: start /listener with __ns:=/robot\n" in text


def test_types_that_do_not_match_are_an_error_with_both_ends(
    node: Callable[..., Any],
    start: Callable[..., Any],
    wtf: Callable[[], tuple[int, str]],
    lcmtools_path: str,
) -> None:
    node("listener")
    pub = start(lcmtools_path, "pub", "/chatter", "std_msgs/Int32", "3", "__name:=wrong")
    pub.wait_for("publishing and latching")
    code, text = wtf()
    assert code == 2
    assert (
        "ERROR The types on /chatter do not match:\n"
        " * /wrong publishes std_msgs/Int32\n"
        " * /listener expects std_msgs/String\n"
        "   -> remap one of them to another topic, for example /chatter:=/chatter_2\n"
    ) in text


def test_two_nodes_of_one_name_are_an_error_with_their_processes(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]]
) -> None:
    first, second = node("talker"), node("talker")
    code, text = wtf()
    assert code == 2
    assert "ERROR 2 nodes have the name /talker:\n" in text
    assert f" * pid {first.pid} on " in text
    assert f" * pid {second.pid} on " in text
    assert "   -> end one of them, or start it with __name:=talker2\n" in text


def test_killed_node_is_stale_until_it_is_cleaned_up(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]], lcmtools: Run
) -> None:
    talker = node("talker")
    talker.send_signal(signal.SIGKILL)
    talker.wait()
    code, text = wtf()
    assert code == 2
    assert (
        "ERROR The following nodes do not answer any more:\n"
        f" * /talker (pid {talker.pid}): ended without saying goodbye\n"
        "   -> start /talker again, or forget it: lcmtools node cleanup\n"
    ) in text
    assert lcmtools("node", "list").stdout == "/talker (stale: ended without saying goodbye)\n"
    assert "Stale: ended without saying goodbye\n" in lcmtools("node", "info", "talker").stdout
    assert lcmtools("list").stdout == ""

    assert lcmtools("node", "cleanup").stdout == "/talker\n"
    assert lcmtools("node", "list").stdout == ""
    result = lcmtools("node", "cleanup")
    assert (result.returncode, result.stdout) == (0, "")
    assert result.stderr == "no node has ended without saying goodbye\n"


def test_killed_node_that_was_started_again_is_no_fault(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]], lcmtools: Run
) -> None:
    killed = node("talker")
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    again = node("talker")
    code, text = wtf()
    assert code == 0, text
    assert f"Pid: {again.pid}\n" in lcmtools("node", "info", "talker").stdout
    assert lcmtools("node", "ping", "-c", "1", "talker").returncode == 0


def test_stopped_node_is_stale_until_it_goes_on(
    node: Callable[..., Any], wtf: Callable[[], tuple[int, str]], lcmtools: Run
) -> None:
    talker = node("talker")
    talker.send_signal(signal.SIGSTOP)
    code, text = wtf()
    assert code == 2
    assert (
        f" * /talker (pid {talker.pid}): runs but does not answer\n"
        f"   -> wake it (kill -CONT {talker.pid}) or end it (kill {talker.pid})\n"
    ) in text
    assert lcmtools("node", "list").stdout == "/talker (stale: runs but does not answer)\n"
    assert lcmtools("node", "cleanup").stdout == ""
    ping = lcmtools("node", "ping", "-c", "1", "--timeout", "300ms", "talker")
    assert ping.returncode == 4
    assert ping.stderr.startswith(
        f"lcmtools node ping: /talker did not answer within 0.3 s; its process is {talker.pid} on "
    )
    talker.send_signal(signal.SIGCONT)
    assert wtf()[0] == 0


def test_killed_command_is_no_fault(
    start: Callable[..., Any], wtf: Callable[[], tuple[int, str]], lcmtools_path: str
) -> None:
    pub = start(lcmtools_path, "pub", "/a", "std_msgs/String", "x")
    pub.wait_for("publishing and latching")
    pub.send_signal(signal.SIGKILL)
    pub.wait()
    assert "do not answer" not in wtf()[1]


def test_empty_bus_is_a_warning(wtf: Callable[[], tuple[int, str]], bus_url: str) -> None:
    code, text = wtf()
    assert code == 1
    assert text.splitlines()[3:] == [
        f"WARNING There are no nodes on {bus_url}, and nothing came in 0.2 s",
        "   -> start something, for example: lcmtools run talker",
        (
            "   -> if it runs already, it is on another bus: compare LCM_DEFAULT_URL and"
            " LCMTOOLS_DOMAIN in both shells"
        ),
    ]


def test_json_has_rule_severity_items_and_remedies(node: Callable[..., Any], lcmtools: Run) -> None:
    listener = node("listener")
    result = lcmtools("wtf", "--json", "--wait", "0.2s", "--ignore", "other-buses")
    assert result.returncode == 1
    (finding,) = json.loads(result.stdout)
    pid = finding["subjects"][0].pop("pid")
    assert finding == {
        "rule": "unconnected-subscriptions",
        "severity": "warning",
        "text": "The following node subscriptions are unconnected:",
        "items": ["/listener:", "/chatter"],
        "remedies": [],
        "subjects": [
            {"kind": "node", "name": "/listener", "address": finding["subjects"][0]["address"]},
            {"kind": "topic", "name": "/chatter", "pid": None, "address": None},
        ],
        "values": {"kind": "unconnected-subscriptions"},
        "facts": [{"kind": "node-topics", "node": "/listener", "topics": ["/chatter"]}],
        "actions": [],
    }
    assert pid == listener.pid


def test_doctor_is_wtf(lcmtools: Run) -> None:
    ask = ("--wait", "0.1s", "--ignore", "other-buses")
    assert lcmtools("doctor", *ask).stdout == lcmtools("wtf", *ask).stdout
    assert os.environ["LCM_DEFAULT_URL"] in lcmtools("doctor", *ask).stdout


_NAN = """
import time, lcm
from lcmtools.types.geometry_msgs import Twist
bus, message = lcm.LCM(), Twist()
message.linear.x = float("inf")
while True:
    bus.publish("/cmd", message.encode())
    print("sends", flush=True)
    time.sleep(0.02)
"""


def test_only_one_rule_or_not_another(start_python: Callable[..., Any], lcmtools: Run) -> None:
    start_python(_NAN).wait_for("sends")
    result = lcmtools("wtf", "--wait", "0.3s", "--rule", "not-finite", "--rule", "loss")
    assert result.returncode == 1
    assert "WARNING Numbers that are published are not finite:\n * /cmd from " in result.stdout
    result = lcmtools("wtf", "--json", "--wait", "0.3s", "--ignore", "not-finite")
    assert "not-finite" not in result.stdout


def test_rules_are_listed_and_explained(lcmtools: Run) -> None:
    listed = lcmtools("wtf", "--list").stdout.splitlines()
    rules = json.loads(lcmtools("wtf", "--list", "--json").stdout)
    assert [line.split()[0] for line in listed] == [rule["rule"] for rule in rules]
    for rule in ("loss", "kernel-drops"):
        result = lcmtools("wtf", "--explain", rule)
        assert result.returncode == 0
        assert result.stdout.startswith(f"{rule} (warning)\n\n")
        assert "\n\n   -> " in result.stdout


def test_json_has_a_finding_where_the_environment_names_no_bus(
    lcmtools: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67")
    result = lcmtools("wtf", "--json")
    assert (result.returncode, result.stderr) == (2, "")
    (finding,) = json.loads(result.stdout)
    assert finding["rule"] == "bus"
    assert "the port is missing" in finding["text"]
    assert finding["remedies"] == ["export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'"]
    assert lcmtools("wtf", "--json", "--lcm-url", "udpm://x").stdout == ""


def test_options_of_a_url_that_lcm_reads_otherwise_are_named(
    lcmtools: Run, bus_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url.replace("ttl=0", "tll=1&ttl=256"))
    text = lcmtools("wtf", "--wait", "0.1s", "--rule", "environment").stdout
    assert "tll=1 has no effect; did you mean ttl?\n" in text
    assert "ttl=256 is sent as 0; the greatest is 255\n" in text


def test_what_another_bus_has_is_said_here_where_nobody_else_is_asked(
    node: Callable[..., Any], lcmtools: Run, free_port: Callable[[], int], start: Any
) -> None:
    """--ignore takes one rule's findings away, and none of another's."""
    node("listener")
    away = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    talker = "import lcm, time\nbus = lcm.LCM()\nwhile True:\n"
    talker += " bus.publish('/chatter', bytes(12)); print('sent', flush=True); time.sleep(0.02)\n"
    start(sys.executable, "-c", talker, LCM_DEFAULT_URL=away).wait_for("sent")
    options = ("--json", "--wait", "0.3s", "--ignore", "other-buses")
    rules = [finding["rule"] for finding in json.loads(lcmtools("wtf", *options).stdout)]
    assert rules == ["unconnected-subscriptions"]
