"""echo of several topics, patterns and types, on a bus where they come and go."""

import sys

import pytest
from fixtures.says import assert_says

pytestmark = pytest.mark.usefixtures("use_module_bus", "fleet")

# Two robots of a node that announces its types, and channels of a program that does not.
_FLEET = """
import time
import lcm
import lcmtools
from lcmtools.types.geometry_msgs import PointStamped
from lcmtools.types.std_msgs import Int32, String

lcmtools.init()
node = lcmtools.Node("fleet")
point = PointStamped()
point.point.x = 1.5
point.header.frame_id = "odom"
where = {f"/husky{n}/where": node.create_publisher(PointStamped, f"/husky{n}/where") for n in "01"}
names = node.create_publisher(String, "/husky1/name")
name = String()
name.data = "one"
bus = lcm.LCM()
number = Int32()
print("ready", flush=True)
while True:
    for publisher in where.values():
        publisher.publish(point)
    names.publish(name)
    bus.publish("NUMBER", number.encode())
    time.sleep(0.02)
"""

_LATER = """
import time
import lcm
from lcmtools.types.std_msgs import Int32

bus = lcm.LCM()
while True:
    bus.publish("/later/number", Int32().encode())
    time.sleep(0.02)
"""


@pytest.fixture(scope="module")
def fleet(module_start, tmp_path_factory):
    """The robots, publishing."""
    script = tmp_path_factory.mktemp("fleet") / "fleet.py"
    script.write_text(_FLEET)
    module_start(sys.executable, str(script)).wait_for("ready")


@pytest.mark.parametrize("command", ["echo", "bag record"])
def test_one_of_several_topics_is_named_while_nothing_comes_on_it(
    command, start, lcmtools_path, module_bus_url, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    words = *command.split(), "/husky1/name", "/husky1/nam"
    process = start(lcmtools_path, *words, LCM_DEFAULT_URL=module_bus_url)
    line = f"lcmtools {command}: no message on /husky1/nam yet; did you mean /husky1/name?"
    assert process.wait_for("no message") == line


def test_a_topic_that_a_log_has_only_announced_is_told_from_what_it_has(cli, tmp_path):
    log = str(tmp_path / "a.lcmlog")
    cli("bag", "record", "/husky0/where", "-n", "1", "-o", log)
    result = cli("echo", "-b", log, "/husky0/where", "/husky1/where")
    assert result.code == 0
    line = "lcmtools echo: the log has no message on /husky1/where; did you mean /husky0/where?\n"
    assert result.err == line


def test_topics_that_come_later_are_taken_too(start, lcmtools_path, tmp_path, module_bus_url):
    later = tmp_path / "later.py"
    later.write_text(_LATER)
    echo = start(lcmtools_path, "echo", "/later/*", "-1", LCM_DEFAULT_URL=module_bus_url)
    line = echo.wait_for("no message")
    assert_says(line, "lcmtools echo: ", "no message", "/later/*", "; on the bus: ")
    start(sys.executable, str(later), LCM_DEFAULT_URL=module_bus_url)
    assert echo.wait() == 0
    assert echo.lines[-3:] == ["# /later/number", "data: 0", "---"]


def test_a_pattern_is_announced_as_a_subscription_to_what_it_matches(
    start, lcmtools_path, cli, module_bus_url
):
    echo = start(lcmtools_path, "echo", "/husky*/where", LCM_DEFAULT_URL=module_bus_url)
    echo.wait_for("# /husky1/where")
    for topic in ("/husky0/where", "/husky1/where"):
        assert f"/_lcmtools_echo_{echo.pid}" in cli("info", topic).out


def test_nothing_within_the_timeout_names_all_that_was_waited_for(cli):
    result = cli("echo", "/nope/*", "/nothing", "--timeout", "300ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, "lcmtools echo: ", "/nope/*, /nothing", "0.3 s; on the bus: ")


def test_timeout_is_for_messages_that_meet_the_filter(cli):
    result = cli("echo", "NUMBER", "--filter", "data > 99", "--timeout", "500ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, "lcmtools echo: nothing", "NUMBER", "0.5 s; ")
