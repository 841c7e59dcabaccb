"""echo's options for how values are shown: relative times, cut arrays, widths, a clear screen."""

import csv
import json
import os
import pty
import subprocess
import sys

import lcm
import pytest
import yaml
from fixtures.says import assert_says

from lcmtools.messages.codec import encode
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import Int32, String

pytestmark = pytest.mark.usefixtures("use_module_bus", "joints")

_JOINTS = """
import time
import lcm
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.sensor_msgs import JointState

bus = lcm.LCM()
message = JointState()
message.header.frame_id = "a rather long name"
message.position = [0.123456789, -2.0, 3.0]
message.name = ["left", "right", "front"]
message.position_length = message.name_length = 3
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


def test_offset_shows_stamps_relative_to_the_arrival(cli):
    stamp = yaml.safe_load(output(cli("echo", "JOINTS/header/stamp", "-1", "--offset"))[:-4])
    assert stamp["sec"] == -3
    assert 0 <= stamp["nsec"] <= 500_000_000
    row = output(cli("echo", "JOINTS/header", "-1", "--offset", "-p")).splitlines()[1]
    time, _, cell, _ = row.split(",")
    assert -3_000_000_000 < int(time) == int(cell) <= -2_500_000_000


def test_truncate_length_cuts_arrays_and_strings(cli):
    shown = output(cli("echo", "JOINTS", "-1", "--truncate-length", "2")).splitlines()
    assert '  frame_id: "a ..."' in shown
    assert "position: [0.123456789, -2.0, ...]" in shown
    assert shown[shown.index("name: ") + 3] == "  - ..."
    message = json.loads(output(cli("echo", "JOINTS", "-1", "-l", "2", "--json")))
    assert message["position"] == [0.123456789, -2.0, "..."]
    row = output(cli("echo", "JOINTS/position", "-1", "-l", "2", "-p")).splitlines()
    assert row[0] == "%time,field0,field1"


@pytest.mark.usefixtures("long_scan")
def test_long_arrays_are_shortened_on_a_terminal_only(on_terminal, cli):
    words = ("echo", "/long_scan/ranges", "-1", "--timeout", "20s")
    shown = on_terminal(*words).splitlines()[0]
    assert shown.startswith("[0.0, ")
    assert_says(shown, ", ... 101 more", "--full-length")
    assert shown.count("0.0") == 200
    for whole in (
        on_terminal(*words, "-f"),
        on_terminal(*words, "--json"),
        cli(*words).out,
    ):
        assert whole.count("0.0") == 301
        assert "more" not in whole


@pytest.fixture(scope="module")
def long_scan(module_start):
    scan = f"{{ranges: {[0.0] * 301}}}"
    program = (sys.executable, "-m", "lcmtools", "pub", "-r", "20", "/long_scan")
    module_start(*program, "sensor_msgs/LaserScan", scan).wait_for("publishing")


def test_nothing_is_cut_without_it(cli):
    for option in ([], ["--full-length"], ["-f"]):
        assert "..." not in output(cli("echo", "JOINTS", "-1", *option))


def test_width_is_that_of_rostopic(cli):
    assert output(cli("echo", "JOINTS/position", "-1", "-w", "5")) == (
        "[0.123, -2.00, 3.000]\n---\n"
    )


def test_csv_leaves_out_what_is_hidden(cli):
    shown = output(cli("echo", "JOINTS", "-1", "-p", "--noarr", "--nostr"))
    head, row = csv.reader(shown.splitlines())
    assert head == ["%time", "field.header.seq", "field.header.stamp"]
    assert row[0] == row[2]


def test_times_may_be_named_as_in_ros_1(cli):
    result = cli(
        *("echo", "JOINTS/header/stamp/secs", "-1", "--filter", "m.header.stamp.nsecs >= 0")
    )
    assert int(output(result).split()[0]) > 1_600_000_000


def test_clear_clears_only_a_screen(cli, lcmtools_path):
    command = ["echo", "JOINTS/position", "-1", "--clear"]
    assert output(cli(*command)).startswith("[")
    assert _on_terminal(lcmtools_path, command, "xterm").startswith("\033[2J\033[;H[")
    assert _on_terminal(lcmtools_path, command, "dumb").startswith("[")
    assert _on_terminal(lcmtools_path, [*command, "--json"], "xterm").startswith("[")


def _on_terminal(path, arguments, terminal):
    """The output of a command at a terminal."""
    ours, its = pty.openpty()
    try:
        environment = {**os.environ, "TERM": terminal}
        subprocess.run([path, *arguments], stdout=its, env=environment, timeout=20, check=True)
        return os.read(ours, 10_000).decode()
    finally:
        os.close(ours)
        os.close(its)


@pytest.fixture
def log(tmp_path):
    """A log of numbers, texts and stamped messages, an hour long, with damage in between."""
    path = tmp_path / "a b?.log"
    events = lcm.EventLog(str(path), "w", overwrite=True)
    for index in range(3):
        number, text, joints = Int32(), String(), JointState()
        number.data, text.data, joints.header.stamp.sec = index, f"text {index}", 100 + index
        time_us = 1_000_000 + index * 1_800_000_000
        for channel, message in ("/number", number), ("/text", text), ("/joints", joints):
            events.write_event(time_us, channel, encode(message))
    events.close()
    return str(path)


def test_a_log_is_read_at_once(log, cli):
    assert output(cli("echo", "-b", log, "number")) == (
        "data: 0\n---\ndata: 1\n---\ndata: 2\n---\n"
    )
    assert output(cli("echo", "--bag", log, "/text/data", "-n", "1")) == '"text 0"\n---\n'


def test_csv_of_a_log_has_the_times_of_recording(log, cli):
    rows = output(cli("echo", "-b", log, "/number", "-p")).splitlines()
    assert rows == ["%time,field.data", "1000000000,0", "1801000000000,1", "3601000000000,2"]


def test_all_topics_of_a_log(log, cli):
    lines = output(cli("echo", "-b", log, "-a", "--json", "--noarr")).splitlines()
    assert json.loads(lines[1]) == {"topic": "/text", "message": {"data": "text 0"}}
    assert [json.loads(line)["topic"] for line in lines] == ["/number", "/text", "/joints"] * 3
