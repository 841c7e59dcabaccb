"""lcmtools graph on a bus with nodes and with plain LCM programs."""

import re
import signal
import sys

import pytest
from fixtures.says import assert_says

_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("POSE", lambda *_: None)
print("ready", flush=True)
while True:
    bus.handle()
"""


@pytest.fixture(scope="module")
def programs(module_start, lcmtools_path, lcm_program):
    """A talker, a listener in a namespace, lcm-source, and a script that only listens."""
    started = {
        "plain": module_start(sys.executable, "-c", _LISTENER),
        "source": module_start(lcm_program("lcm-source"), "-m", "EXAMPLE"),
        "listener": module_start(lcmtools_path, "run", "listener", "__ns:=/r", "chatter:=/chatter"),
        "talker": module_start(lcmtools_path, "run", "talker"),
    }
    started["plain"].wait_for("ready")
    started["listener"].wait_for("I heard: [hello world")
    return started


@pytest.fixture
def on_bus(use_module_bus, programs):
    """The programs, with the commands looking at their bus."""
    del use_module_bus
    return programs


def test_text_shows_who_feeds_whom(cli, on_bus):
    result = cli("graph", env={"LC_ALL": "C.UTF-8"})
    source, plain = on_bus["source"].pid, on_bus["plain"].pid
    assert result.code == 0
    assert "/talker\n└─ /chatter [std_msgs/String]\n   └→ /r/listener\n" in result.out
    assert f"lcm-source -m EXAMPLE (no node, pid {source})\n└─ EXAMPLE [" in result.out
    assert re.search(
        rf"^python.* \(no node, pid {plain}, receives unknown channels\)$",
        result.out,
        re.MULTILINE,
    )


def test_a_looking_command_is_shown_by_tools(cli, on_bus, module_start, lcmtools_path):
    del on_bus
    echo = module_start(lcmtools_path, "echo", "/chatter")
    echo.wait_for("data:")
    try:
        assert "_lcmtools_echo" not in cli("graph").out
        assert_says(cli("graph").err, "1 command", "--tools")
        assert f"/_lcmtools_echo_{echo.pid} (observes)" in cli("graph", "--tools").out
    finally:
        echo.end()


def test_two_of_the_same_name_and_a_stale_one(cli, start, lcmtools_path, bus_url):
    one, other = (start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url) for _ in range(2))
    for talker in (one, other):
        talker.wait_for("hello world")
    other.send_signal(signal.SIGKILL)
    other.wait()
    text = cli("graph", env={"LCM_DEFAULT_URL": bus_url, "LC_ALL": "C"}).out
    assert f"/talker (pid {one.pid})\n" in text
    assert f"/talker (pid {other.pid}) (stale: " in text


def test_where_the_bus_tells_no_senders_programs_are_one(cli, start, lcmtools_path, tcpq_server):
    url = tcpq_server.url
    start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=url).wait_for("hello world")
    plain = (
        "import lcm, time\nbus = lcm.LCM()\n"
        "while True:\n    bus.publish('POSE', bytes(8))\n    print('sent', flush=True)\n"
        "    time.sleep(0.05)\n"
    )
    start(sys.executable, "-c", plain, LCM_DEFAULT_URL=url).wait_for("sent")
    text = cli("graph", "--wait", "1", env={"LCM_DEFAULT_URL": url, "LC_ALL": "C"}).out
    assert "/talker\n`- /chatter [std_msgs/String]\n" in text
    assert "a program (no node)\n`- POSE [unknown type]\n" in text
