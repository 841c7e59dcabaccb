"""Times of callbacks: what info and wtf say of nodes that do not keep up."""

import json
import re

import pytest

_NODE = """
import sys, time
import lcmtools
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Empty

lcmtools.init()
node = lcmtools.Node("ear")
depth, callback, timer = int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
calls = 0

def hear(message):
    global calls
    calls += 1
    if calls == 10:
        print("hears", flush=True)
    time.sleep(callback)

def work():
    print("works", flush=True)
    time.sleep(timer)

node.create_subscription(String, "/chatter", hear, depth)
node.create_service(Empty, "/rest", lambda request, response: (time.sleep(0.05), response)[1])
if timer:
    node.create_timer(0.01, work)
if len(sys.argv) > 4:
    print("sleeps", flush=True)
    time.sleep(1000)
lcmtools.spin(node)
"""


@pytest.fixture(autouse=True)
def _bus(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.fixture(autouse=True)
def _talker(start, lcmtools_path):
    start(lcmtools_path, "pub", "-r", "20", "/chatter", "std_msgs/String", "hi")


@pytest.fixture
def findings(cli):
    """The findings of wtf that are more than notes, by the rule."""

    def look():
        found = json.loads(cli("wtf", "--json").out)
        return {one["rule"]: one for one in found if one["severity"] != "note"}

    return look


def test_a_callback_that_loses_messages_is_told_with_its_time(start_python, findings):
    start_python(_NODE, "4", "0.2", "0").wait_for("hears")
    (row,) = findings()["queue-drops"]["items"]
    assert re.fullmatch(
        r"/ear lost \d+ messages of /chatter \(depth 4\): its callback takes \d{3} ms,"
        r" messages come every \d+ ms",
        row,
    )


def test_a_node_that_does_not_spin_is_told(start_python, findings, wait_until):
    start_python(_NODE, "3", "0", "0", "never").wait_for("sleeps")
    wait_until(lambda: "queue-drops" in findings())
    found = findings()
    assert list(found) == ["queue-drops"]
    assert found["queue-drops"]["items"][0].endswith("(depth 3): no callback has run")
    assert "spin" in found["queue-drops"]["remedies"][0]


@pytest.mark.timing
def test_info_shows_how_long_callbacks_take(start_python, cli):
    start_python(_NODE, "10", "0.02", "0").wait_for("hears")
    assert " ms mean, 2" in cli("info", "/chatter").out
    assert " ms mean, 2" in cli("node", "info", "/ear").out
    assert re.search(r"\nIn callbacks: \d\d?\.\d % of that time\n", cli("node", "info", "/ear").out)
    for command in (("info", "/chatter"), ("node", "info", "/ear")):
        (document,) = json.loads(cli(*command, "--json").out)
        (ear,) = document.get("subscribers") or document["subscriptions"]
        assert ear["callbacks"] >= 10
        assert ear["longest_callback"] >= 20_000_000
        assert ear["callback_time"] >= 200_000_000


def test_service_info_shows_how_long_answers_take(start_python, cli):
    start_python(_NODE, "10", "0", "0").wait_for("hears")
    assert "Calls: 0\n" in cli("service", "info", "/rest").out
    assert cli("service", "call", "/rest").code == 0
    assert "Calls: 1, callbacks: " in cli("service", "info", "/rest").out
    (document,) = json.loads(cli("service", "info", "/rest", "--json").out)
    assert document["servers"][0]["longest_callback"] >= 50_000_000
