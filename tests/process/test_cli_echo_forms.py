"""echo's times relative to the arrival on a bus, and what it does on a terminal only."""

import sys

import pytest
import yaml
from fixtures.build import write_log
from fixtures.says import assert_says

_JOINTS = """
import time
import lcm
from lcmtools.types.sensor_msgs import JointState

bus = lcm.LCM()
message = JointState()
print("ready", flush=True)
while True:
    now = time.time_ns() - 2_500_000_000
    message.header.stamp.sec, message.header.stamp.nsec = divmod(now, 1_000_000_000)
    bus.publish("JOINTS", message.encode())
    time.sleep(0.02)
"""


@pytest.fixture(scope="module")
def joints(module_start, tmp_path_factory):
    """JOINTS, stamped two and a half seconds before they are sent."""
    script = tmp_path_factory.mktemp("joints") / "joints.py"
    script.write_text(_JOINTS)
    module_start(sys.executable, str(script)).wait_for("ready")


def output(result):
    assert (result.code, result.err) == (0, "")
    return result.out


@pytest.mark.usefixtures("use_module_bus", "joints")
def test_offset_shows_stamps_relative_to_the_arrival(cli):
    stamp = yaml.safe_load(output(cli("echo", "JOINTS/header/stamp", "-1", "--offset"))[:-4])
    assert stamp["sec"] == -3
    assert 0 <= stamp["nsec"] <= 500_000_000
    row = output(cli("echo", "JOINTS/header", "-1", "--offset", "-p")).splitlines()[1]
    time, _, cell, _ = row.split(",")
    assert -3_000_000_000 < int(time) == int(cell) <= -2_500_000_000


@pytest.fixture
def log(tmp_path):
    """A log with one long scan."""
    return write_log(
        tmp_path / "a.lcmlog", (0, "/scan", "sensor_msgs/LaserScan", {"ranges": [0.0] * 301})
    )


def test_long_arrays_are_shortened_on_a_terminal_only(on_terminal, log, cli):
    words = ("echo", "-b", log, "/scan/ranges")
    shown = on_terminal(*words).splitlines()[0]
    assert shown.startswith("[0.0, ")
    assert_says(shown, ", ... 101 more", "--full-length")
    assert shown.count("0.0") == 200
    for whole in on_terminal(*words, "-f"), on_terminal(*words, "--json"), cli(*words).out:
        assert whole.count("0.0") == 301
        assert "more" not in whole


def test_clear_clears_only_a_screen(on_terminal, log):
    words = ("echo", "-b", log, "/scan/range_min", "--clear")
    assert on_terminal(*words, TERM="xterm").startswith("\033[2J\033[;H0.0")
    assert on_terminal(*words, TERM="dumb").startswith("0.0")
    assert on_terminal(*words, "--json", TERM="xterm").startswith("0.0")
