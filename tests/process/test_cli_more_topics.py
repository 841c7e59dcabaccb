"""hz, bw and delay as time passes, on a bus with nodes and a plain program."""

import re
import signal
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_says

# Knows no nodes. It sends a point, which is a vector to LCM; a pose stamped 0.25 s ago.
_PLAIN = """
import time
import lcm
from lcmtools.types.geometry_msgs import Point, PoseStamped

bus = lcm.LCM()
stamped = PoseStamped()
while True:
    then = time.time_ns() - 250_000_000
    stamped.header.stamp.sec, stamped.header.stamp.nsec = divmod(then, 1_000_000_000)
    bus.publish("POSE", stamped.encode())
    bus.publish("POINT", Point().encode())
    print("sent", flush=True)
    time.sleep(0.05)
"""

pytestmark = pytest.mark.usefixtures("use_module_bus", "programs")


@pytest.fixture(scope="module")
def programs(module_start, lcmtools_path, tmp_path_factory):
    """A listener, a publisher of "hello" at 20 Hz, and the plain program."""
    script = tmp_path_factory.mktemp("plain") / "plain.py"
    Path(script).write_text(_PLAIN)
    listener = module_start(lcmtools_path, "run", "listener")
    module_start(lcmtools_path, "pub", "-r", "20", "/chatter", "std_msgs/String", "hello")
    listener.wait_for("I heard: [hello")
    module_start(sys.executable, str(script)).wait_for("sent")


@pytest.mark.parametrize(
    ("verb", "topic", "first"),
    [
        ("bw", "POINT", "average: "),
        ("delay", "POSE", "average delay: 0.25"),
        ("hz", "POINT", "average"),
    ],
)
def test_so_many_reports_are_enough(verb, topic, first, cli):
    result = cli(verb, topic, "-n", "2")
    lines = result.out.splitlines()
    assert result.code == 0
    assert [line.startswith(first) for line in lines] == [True, False] * 2


def test_info_shows_what_was_seen_of_a_program_that_is_no_node(cli):
    lines = cli("info", "POINT").out.splitlines()
    row = next(row for row, line in enumerate(lines) if "plain.py (pid " in line)
    assert re.fullmatch(
        r"     seen messages: \d+, bytes: \d+, rate: \d+\.\d\d Hz, last: \d\.\d s ago",
        lines[row + 1],
    )


def test_hz_tells_which_of_several_topics_is_silent(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "/chatter", "/POINTS")
    line = hz.wait_for("no message on")
    assert_says(line, "lcmtools hz: ", "no message", "/POINTS", "; did you mean POINT?")


@pytest.mark.parametrize("verb", ["bw", "delay", "hz"])
def test_nothing_within_the_timeout_is_exit_code_4(verb, cli):
    result = cli(verb, "/zzz", "--timeout", "200ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, f"lcmtools {verb}: ", "/zzz", "within 0.2 s")


def test_ctrl_c_prints_what_was_measured_and_is_exit_code_130(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "POINT")
    hz.wait_for("average")
    hz.wait_for("window: ")
    echo = start(lcmtools_path, "echo", "-n", "2", "POINT")
    assert echo.wait() == 0  # so two messages have come since
    hz.send_signal(signal.SIGINT)
    assert hz.wait() == 130
    assert hz.output.count("average") >= 2
    assert "Traceback" not in hz.output
