"""wtf and faults that are planted with real processes, of which lcmtools knows nothing.

In a network of their own: each fault, and nothing else, is named, with its process and a remedy.
"""

import json
import os
import signal
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]
Finding = dict[str, Any]

pytestmark = pytest.mark.usefixtures("private_network")

_IGNORED = ("other-buses", "unconnected-publications", "irregular")
_LOOP = """
import sys, time, lcm
from lcmtools.types.geometry_msgs import PoseStamped, Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock
bus, number = lcm.LCM(), 0
while True:
    number += 1
    exec(sys.argv[1])
    if number == 3:
        print("sends", flush=True)
    time.sleep(float(sys.argv[2]))
"""


@pytest.fixture
def loop(start_python: Callable[..., Any]) -> Callable[..., Any]:
    """``loop("bus.publish(...)")``: a plain LCM program that does that 50 times a second."""

    def run(statements: str, period: float = 0.02) -> Any:
        program = start_python(_LOOP, statements, str(period))
        program.wait_for("sends")
        return program

    return run


@pytest.fixture
def findings(lcmtools: Run) -> Callable[..., list[Finding]]:
    """What wtf finds, but for what other tests and a busy computer may cause."""

    def run(*arguments: str) -> list[Finding]:
        ignored = [word for rule in _IGNORED for word in ("--ignore", rule)]
        result = lcmtools("wtf", "--json", "--wait", "0.7s", *ignored, *arguments)
        assert result.stderr == ""
        found: list[Finding] = json.loads(result.stdout)
        worst = max((("note", "warning", "error").index(f["severity"]) for f in found), default=0)
        assert result.returncode == worst
        return found

    return run


def _rules(found: Sequence[Finding]) -> list[str]:
    return [finding["rule"] for finding in found]


@pytest.fixture
def sink(
    start: Callable[..., Any], lcm_program: Callable[[str], str], wait_until: Callable[..., None]
) -> Any:
    """lcm-sink, which listens to everything with the system's usual buffer."""
    program = start(lcm_program("lcm-sink"))
    sockets = Path(f"/proc/{program.pid}/net/udp")
    wait_until(lambda: f":{7667:04X} " in sockets.read_text())
    return program


def test_healthy_plain_programs_are_no_finding(
    loop: Callable[..., Any], sink: Any, findings: Callable[..., list[Finding]]
) -> None:
    loop("m = Twist(); m.linear.x = 1.0; bus.publish('CMD', m.encode())")
    assert sink.pid
    assert findings() == []


def test_a_message_that_no_buffer_takes_names_the_listener(
    loop: Callable[..., Any], sink: Any, findings: Callable[..., list[Finding]]
) -> None:
    loop("bus.publish('CAM', bytes(1_500_000))", 0.1)
    found = findings("--ignore", "loss")
    assert _rules(found) == ["small-buffer"]
    assert f"(pid {sink.pid}): holds " in found[0]["items"][0]
    assert found[0]["remedies"][0].endswith("recv_buf_size=3000000'")


def test_a_stopped_listener_is_named_until_it_goes_on(
    loop: Callable[..., Any], sink: Any, findings: Callable[..., list[Finding]]
) -> None:
    loop("bus.publish('A', bytes(8) + bytes(5000))", 0.002)
    sink.send_signal(signal.SIGSTOP)
    found = findings()
    assert _rules(found) == ["stuck-listeners"]
    assert found[0]["items"][0].endswith(f"(pid {sink.pid}): it is stopped")
    remedy = f"wake it (kill -CONT {sink.pid}) or end it (kill {sink.pid})"
    assert found[0]["remedies"] == [remedy]
    sink.send_signal(signal.SIGCONT)
    assert "stuck-listeners" not in _rules(findings())


_SKIPS = """
import socket, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
number = 0
while True:
    number += 1
    if number % 10:
        data = b"LC02" + number.to_bytes(4, "big") + b"SKIP\\0"
        sender.sendto(data, ("239.255.76.67", 7667))
    if number == 3:
        print("sends", flush=True)
    time.sleep(0.01)
"""


def test_a_sender_whose_messages_get_lost_is_named(
    start_python: Callable[..., Any], findings: Callable[..., list[Finding]]
) -> None:
    program = start_python(_SKIPS)
    program.wait_for("sends")
    found = findings()
    assert _rules(found) == ["loss"]
    assert f"(pid {program.pid})" in found[0]["items"][0]
    assert "(10." in found[0]["items"][0] or "(9." in found[0]["items"][0]


@pytest.mark.parametrize(
    ("statements", "rule", "item"),
    [
        (
            "m = Twist(); m.angular.z = float('nan'); bus.publish('/cmd', m.encode())",
            "not-finite",
            "angular.z is nan",
        ),
        (
            "bus.publish('/odom', Odometry().encode())",
            "quaternions",
            "pose.pose.orientation is all",
        ),
        (
            (
                "m = Odometry(); m.pose.pose.orientation.w = 1.0; m.pose.covariance[1] = 1.0;"
                " bus.publish('/odom', m.encode())"
            ),
            "covariances",
            "pose.covariance is not symmetric: [6] and [1] are 0 and 1",
        ),
        (
            (
                "m = PoseStamped(); m.pose.orientation.w = 1.0;"
                " m.header.stamp.sec = int(time.time()) + 100; bus.publish('/p', m.encode())"
            ),
            "stamps",
            "in the future",
        ),
        (
            (
                "m = PoseStamped(); m.pose.orientation.w = 1.0;"
                " m.header.stamp.sec = int(time.time()) - 100; bus.publish('/p', m.encode())"
            ),
            "stamps",
            "s old",
        ),
        ("bus.publish('/odom', Odometry().encode()[:-5])", "undecodable", "Odometry"),
    ],
)
def test_odd_contents_are_named_with_topic_process_and_field(
    statements: str,
    rule: str,
    item: str,
    loop: Callable[..., Any],
    findings: Callable[..., list[Finding]],
) -> None:
    program = loop(statements)
    found = findings()
    assert _rules(found) == [rule]
    assert f"(pid {program.pid}): " in found[0]["items"][0]
    assert item in found[0]["items"][0]


def test_two_programs_on_one_topic_are_both_named(
    loop: Callable[..., Any], findings: Callable[..., list[Finding]]
) -> None:
    programs = [loop("bus.publish('/cmd_vel', Twist().encode())") for _ in range(2)]
    found = findings()
    assert _rules(found) == ["competing-publishers"]
    for program in programs:
        assert any(f"(pid {program.pid})" in item for item in found[0]["items"])


def test_simulated_time_that_is_slow_is_told(
    loop: Callable[..., Any], findings: Callable[..., list[Finding]]
) -> None:
    loop("m = Clock(); m.clock.nsec = number * 5_000_000; bus.publish('/clock', m.encode())")
    (finding,) = findings()
    assert finding["rule"] == "slow-simulator"
    assert finding["text"].startswith("Simulated time passes at 0.")


_SLOW = """
import time
import lcmtools
from lcmtools.types.std_msgs import String

def slowly(message):
    time.sleep(0.3)
    print("one", flush=True)

lcmtools.init()
node = lcmtools.Node("slow")
node.create_subscription(String, "/chatter", slowly, 10)
lcmtools.spin(node)
"""


def test_a_callback_that_is_too_slow_is_named(
    start: Callable[..., Any],
    start_python: Callable[..., Any],
    lcmtools_path: str,
    findings: Callable[..., list[Finding]],
) -> None:
    slow = start_python(_SLOW)
    start(lcmtools_path, "pub", "-r", "100", "/chatter", "std_msgs/String", "x")
    slow.wait_for("one")
    slow.wait_for("one")
    found = findings()
    assert _rules(found) == ["queue-drops"]
    assert found[0]["items"][0].startswith("/slow lost ")
    assert found[0]["items"][0].endswith(" messages of /chatter (depth 10)")


def test_only_one_rule_or_not_another(
    loop: Callable[..., Any], findings: Callable[..., list[Finding]], lcmtools: Run
) -> None:
    loop("m = Twist(); m.linear.x = float('inf'); bus.publish('/cmd', m.encode())")
    assert _rules(findings("--ignore", "not-finite")) == []
    result = lcmtools("wtf", "--wait", "0.3s", "--rule", "not-finite", "--rule", "loss")
    assert result.returncode == 1
    assert "WARNING Numbers that are published are none:\n * /cmd from " in result.stdout


def test_watch_shows_what_appears_and_clears_until_ctrl_c(
    start: Callable[..., Any], loop: Callable[..., Any], lcmtools_path: str
) -> None:
    loop("bus.publish('/good', Twist().encode())")
    rules = ("--rule", "not-finite", "--rule", "no-traffic")
    text = start(lcmtools_path, "wtf", "--watch", "--wait", "0.3s", *rules)
    watch = start(lcmtools_path, "wtf", "--watch", "--json", "--wait", "0.3s", *rules)
    text.wait_for("No errors or warnings")
    bad = loop("m = Twist(); m.linear.x = float('nan'); bus.publish('/cmd', m.encode())")
    appeared = json.loads(watch.wait_for("appeared"))
    assert (appeared["change"], appeared["rule"]) == ("appeared", "not-finite")
    text.wait_for("WARNING Numbers that are published are none:")
    bad.send_signal(signal.SIGTERM)
    assert json.loads(watch.wait_for("cleared"))["rule"] == "not-finite"
    text.wait_for("CLEARED Numbers that are published are none:")
    for program in (watch, text):
        program.send_signal(signal.SIGINT)
        assert program.wait() == 130


def test_a_program_on_another_bus_is_named_where_something_is_missed(
    start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    talker = start(lcmtools_path, "run", "talker", LCMTOOLS_DOMAIN="3")
    talker.wait_for("hello")
    found = json.loads(lcmtools("wtf", "--json", "--wait", "0.2s").stdout)
    (other,) = (finding for finding in found if finding["rule"] == "other-buses")
    assert other["items"][0].startswith(
        f"pid {talker.pid} on 239.255.76.67:7670 (LCMTOOLS_DOMAIN=3): "
    )
    assert other["remedies"] == ["export LCM_DEFAULT_URL='udpm://239.255.76.67:7670?ttl=0'"]


def test_rules_are_listed_and_explained(lcmtools: Run) -> None:
    listed = lcmtools("wtf", "--list").stdout.splitlines()
    rules = json.loads(lcmtools("wtf", "--list", "--json").stdout)
    assert [line.split()[0] for line in listed] == [rule["rule"] for rule in rules]
    for rule in ("loss", "kernel-drops"):
        result = lcmtools("wtf", "--explain", rule)
        assert result.returncode == 0
        assert result.stdout.startswith(f"{rule} (warning)\n\n")
        assert "\n\n   -> " in result.stdout


def test_the_bus_that_has_no_route_is_one_error(
    ip: Callable[..., None], findings: Callable[..., list[Finding]]
) -> None:
    ip("route", "del", "224.0.0.0/4")
    (finding,) = findings()
    assert (finding["rule"], finding["severity"]) == ("bus", "error")
    assert "ip route add 224.0.0.0/4" in finding["remedies"][0]
    assert os.environ.get("LCM_DEFAULT_URL") is None
