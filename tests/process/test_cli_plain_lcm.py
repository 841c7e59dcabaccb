"""Programs that know nothing of lcmtools: lcm-source, as C has it, and a plain Python script."""

import re
import sys

import pytest
from fixtures.says import assert_line

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

_TAKER = """
import lcm
bus = lcm.LCM()
bus.subscribe("COMMAND", print)
bus.fileno()
print("listening", flush=True)
while True:
    bus.handle()
"""

on_the_modules_bus = pytest.mark.usefixtures("use_module_bus", "programs")


@pytest.fixture(scope="module")
def programs(module_start, lcm_program, tmp_path_factory):
    """Publishers on EXAMPLE (100 Hz), SLOW (1.1 Hz) and three channels of a script (20 Hz)."""
    source = lcm_program("lcm-source")
    script = tmp_path_factory.mktemp("plain") / "plain.py"
    script.write_text(_PLAIN)
    started = {
        "EXAMPLE": module_start(source, "-m", "EXAMPLE"),
        "SLOW": module_start(source, "-m", "SLOW", "-s", "100", "-p", "900000"),
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
def test_info_names_the_process_behind_the_channel(cli, programs):
    rows = cli("info", "EXAMPLE").out.splitlines()
    program = rows[rows.index("Publishers: ") + 1]
    assert re.fullmatch(
        rf" \* lcm-source -m EXAMPLE \(pid {programs['EXAMPLE'].pid}, port \d+\)", program
    )
    assert rows[0] == "Type: unknown type"
    assert rows[1].startswith("Fingerprint: ")
    assert not rows[2]


def test_info_names_the_programs_that_may_receive_an_unknown_channel(cli, start_python, bus_url):
    env = {"LCM_DEFAULT_URL": bus_url}
    taker = start_python(_TAKER, **env)
    taker.wait_for("listening")
    told = f"on which channels these listen is not seen: script_0.py (pid {taker.pid})"
    result = cli("info", "COMMAND", env=env)
    assert_line(result.err, "lcmtools info: unknown topic /COMMAND; ", told)


@on_the_modules_bus
def test_a_program_has_the_same_name_everywhere(cli, programs):
    pid = programs["POSE"].pid
    assert f" * plain.py --speed 0.5 (pid {pid}, port " in cli("info", "POSE").out
    assert re.search(rf" plain\.py \(pid {pid}\)", cli("spy", "--once", "POSE").out)
    assert f"plain.py --speed 0.5 (no node, pid {pid})" in cli("graph").out
    assert f":{pid} \tplain.py --speed 0.5" in cli("node", "list", "-a").out


@on_the_modules_bus
def test_echo_waits_for_a_slow_publisher(cli):
    result = cli("echo", "-1", "SLOW")
    assert result.out.splitlines()[1] == "bytes: 100"


@on_the_modules_bus
def test_wtf_does_not_take_them_for_a_fault(cli):
    result = cli("wtf", "--wait", "0.3s")
    assert (result.code, result.out.splitlines()[0]) == (0, "No errors or warnings")


@pytest.mark.usefixtures("private_network")
def test_list_waits_for_one_slow_program_alone(cli, start, lcm_program):
    """In a network of its own, where no other program makes list wait; lcm-source is static."""
    start(lcm_program("lcm-source"), "-m", "SLOW", "-p", "900000")
    cli("echo", "-1", "SLOW")  # the next one comes long after list has started
    assert cli("list").out == "SLOW\n"
