"""Programs that know nothing of lcmtools: lcm-source, as C has it, and a plain Python script."""

import json
import re
import sys
import sysconfig
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

# The program itself, and not the wrapper on the PATH: a signal to that ends the wrapper only.
SOURCE = str(Path(sysconfig.get_path("purelib")) / "bin" / "lcm-source")

# What a user of lcm-gen writes: his own class, his own channel. EMPTY and NOISE are no LCM types.
_PLAIN = """
import time
import lcm
from lcmtools.types.geometry_msgs import Point

bus = lcm.LCM()
point = Point()
point.x = 1.5
while True:
    bus.publish("POSE", point.encode())
    bus.publish("EMPTY", b"")
    bus.publish("NOISE", bytes(range(200)))
    print("sent", flush=True)
    time.sleep(0.05)
"""

on_the_modules_bus = pytest.mark.usefixtures("use_module_bus", "programs")


@pytest.fixture(scope="module")
def programs(module_start, tmp_path_factory):
    """Publishers on EXAMPLE (100 Hz), SLOW (1.1 Hz) and three channels of a script (20 Hz)."""
    script = tmp_path_factory.mktemp("plain") / "plain.py"
    script.write_text(_PLAIN)
    started = {
        "EXAMPLE": module_start(SOURCE, "-m", "EXAMPLE"),
        "SLOW": module_start(SOURCE, "-m", "SLOW", "-s", "100", "-p", "900000"),
        "POSE": module_start(sys.executable, "-u", str(script), "--speed", "0.5"),
    }
    started["POSE"].wait_for("sent")
    return started


@on_the_modules_bus
def test_list_shows_their_channels_slow_ones_too(cli):
    result = cli("list")
    assert result.out.splitlines() == ["EMPTY", "EXAMPLE", "NOISE", "POSE", "SLOW"]
    assert (result.code, result.err) == (0, "")


@on_the_modules_bus
def test_list_does_not_call_what_it_cannot_know_by_a_type(cli):
    types = dict(line.split(" ", 1) for line in cli("list", "-t").out.splitlines())
    assert types["EXAMPLE"] == "[unknown type]"
    assert types["EMPTY"] == "[unknown type]"
    assert types["NOISE"] == "[unknown type]"


@on_the_modules_bus
def test_list_v_counts_them_as_publishers(cli):
    rows = cli("list", "-v").out.splitlines()
    assert " * EXAMPLE [unknown type] 1 publisher" in rows


@on_the_modules_bus
def test_info_names_the_process_behind_the_channel(cli, programs):
    rows = cli("info", "EXAMPLE").out.splitlines()
    program = rows[rows.index("Publishers: ") + 1]
    assert re.fullmatch(
        rf" \* lcm-source -m EXAMPLE \(pid {programs['EXAMPLE'].pid}, port \d+\)", program
    )
    assert rows[0] == "Type: unknown type"
    assert rows[1].startswith("Fingerprint: ")
    assert not rows[2]


@on_the_modules_bus
def test_info_of_a_known_type_names_all_that_it_may_be(cli, programs):
    rows = cli("info", "POSE").out.splitlines()
    assert rows[:2] == [
        "Type: geometry_msgs/Vector3 (one of 2)",
        "Fingerprint: 0xae7e5fba5eeca11e (geometry_msgs/Vector3 or geometry_msgs/Point)",
    ]
    assert f"(pid {programs['POSE'].pid}, port " in rows[4]


@on_the_modules_bus
def test_a_program_has_the_same_name_everywhere(cli, programs):
    pid = programs["POSE"].pid
    assert f" * plain.py --speed 0.5 (pid {pid}, port " in cli("info", "POSE").out
    assert re.search(rf" plain\.py \(pid {pid}\)", cli("spy", "--once", "POSE").out)
    assert f"plain.py --speed 0.5 (no node, pid {pid})" in cli("graph").out
    assert f":{pid} \tplain.py --speed 0.5" in cli("node", "list", "-a").out


@on_the_modules_bus
def test_info_json_has_rate_and_sender(cli):
    (topic,) = json.loads(cli("info", "--json", "POSE").out)
    (program,) = topic["other_publishers"]
    assert program["rate"] == pytest.approx(20, rel=0.3)
    assert re.fullmatch(r"[\d.]+:\d+", program["sender"])


@on_the_modules_bus
def test_type_tells_what_the_fingerprint_tells(cli):
    assert cli("type", "POSE").out == "geometry_msgs/Vector3\n"
    result = cli("type", "EMPTY")
    assert (result.code, result.out) == (1, "")
    assert_line(result.err, "lcmtools type: ", "EMPTY", "not known")


@on_the_modules_bus
def test_echo_decodes_what_has_a_known_fingerprint(cli):
    assert cli("echo", "-1", "POSE").out == "x: 1.5\ny: 0.0\nz: 0.0\n---\n"


@on_the_modules_bus
def test_echo_shows_other_payloads_in_hexadecimal(cli):
    start = bytes(range(64)).hex(" ")
    assert cli("echo", "-1", "NOISE").out == (
        f"# unknown type, fingerprint 0x0001020304050607\nbytes: 200\ndata: '{start} ...'\n---\n"
    )
    assert cli("echo", "-1", "EMPTY").out == (
        "# too short for an LCM message\nbytes: 0\ndata: ''\n---\n"
    )


@on_the_modules_bus
def test_echo_says_once_where_types_are_looked_for(cli, tmp_path):
    before = "lcmtools echo: no type is known for NOISE; "
    result = cli("echo", "-n", "2", "NOISE")
    assert_line(result.err, f"{before}LCMTOOLS_TYPE_PATH=FOLDER", ".lcm files\n")
    result = cli("echo", "-n", "2", "NOISE", env={"LCMTOOLS_TYPE_PATH": str(tmp_path / "nope")})
    assert result.err.startswith(before)
    assert_says(result.err, "/nope: ", "no such folder; ", "LCMTOOLS_TYPE_PATH\n")
    assert cli("echo", "-1", "EMPTY").err == ""


@on_the_modules_bus
def test_echo_json_has_the_whole_payload(cli):
    message = json.loads(cli("echo", "-1", "--json", "NOISE").out)
    assert bytes.fromhex(message["data"]) == bytes(range(200))
    assert message["bytes"] == 200
    assert message["error"] == "unknown type, fingerprint 0x0001020304050607"


@on_the_modules_bus
def test_echo_waits_for_a_slow_publisher(cli):
    result = cli("echo", "-1", "SLOW")
    assert result.out.splitlines()[1] == "bytes: 100"


@on_the_modules_bus
def test_hz_measures_them(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "POSE")
    rate = float(hz.wait_for("average rate: ").removeprefix("average rate: "))
    assert rate == pytest.approx(20, rel=0.2)


@on_the_modules_bus
def test_wtf_does_not_take_them_for_a_fault(cli):
    result = cli("wtf", "--wait", "0.3s")
    assert (result.code, result.out.splitlines()[0]) == (0, "No errors or warnings")


@on_the_modules_bus
def test_near_miss_of_a_literal_channel_is_found(cli):
    result = cli("info", "EXAMPEL")
    assert_line(result.err, "lcmtools info: ", "topic /EXAMPEL; did you mean EXAMPLE?\n")


@pytest.mark.parametrize("_time", range(2))
@pytest.mark.usefixtures("private_network")
def test_list_waits_for_one_slow_program_alone(_time, cli, start):
    """In a network of its own, where no other program makes list wait; lcm-source is static."""
    start(SOURCE, "-m", "SLOW", "-p", "900000")
    cli("echo", "-1", "SLOW")  # the next one comes long after list has started
    assert cli("list").out == "SLOW\n"
