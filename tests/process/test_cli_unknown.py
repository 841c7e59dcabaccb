"""What cannot be seen of programs that do not announce themselves is not known, and not zero."""

import json
import sys

import pytest
from fixtures.says import assert_says

PLAIN = """
import sys, time, lcm
bus = lcm.LCM()
bus.subscribe("OTHER", lambda channel, data: None)
while True:
    bus.publish("CMD", b"12345678abcd")
    bus.handle_timeout(50)
"""

LOADS = "import time; print('on', flush=True); time.sleep(60)"

pytestmark = pytest.mark.usefixtures("private_network")


def test_info_names_the_programs_that_may_be_subscribers(cli, start, wait_until):
    program = start(sys.executable, "-c", PLAIN)
    wait_until(lambda: "CMD" in cli("list").out)

    shown = cli("info", "CMD").out

    assert_says(shown, f"(pid {program.pid})", "they listen to the bus; on which channels is not")
    assert "Subscribers: None" not in shown
    (record,) = json.loads(cli("info", "CMD", "--json").out)
    assert [one["pid"] for one in record["possible_subscribers"]] == [program.pid]
    assert record["subscribers"] == []
    for words, place in (("list", "-v"), "out"), (("list", "-s"), "err"):
        assert f"(pid {program.pid})" in getattr(cli(*words), place)
    assert_says(cli("node", "list").err, "no nodes on", "-a shows programs that are not nodes")


@pytest.mark.parametrize(
    ("words", "is_said"), [(["CMD"], True), (["/CMD"], False), (["CMD", "--plain-channel"], False)]
)
def test_pub_beside_plain_programs_tells_how_to_reach_their_channel(
    words, *, is_said, cli, start, wait_until
):
    start(sys.executable, "-c", PLAIN)
    wait_until(lambda: "CMD" in cli("list").out)

    said = cli("pub", "-1", *words, "std_msgs/String", "data: x").err

    assert ("publishes on /CMD; for the channel CMD of plain LCM" in said) is is_said


@pytest.mark.parametrize(
    ("options", "is_said"), [((), True), (("--domain", "9"), False), (("--domain=9",), False)]
)
@pytest.mark.parametrize("command", [("list",), ("node", "list")])
def test_a_list_names_the_node_that_still_loads(command, options, *, is_said, cli, start):
    words = ("lcmtools", "run", "sim", *options)
    program = start(sys.executable, "-c", LOADS, *words)
    program.wait_for("on")

    said = cli(*command).err

    assert (f"lcmtools run sim (pid {program.pid}) is starting: list again" in said) is is_said
