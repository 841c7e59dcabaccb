"""Times of callbacks, as info shows them."""

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
callback, calls = float(sys.argv[1]), 0

def hear(message):
    global calls
    calls += 1
    if calls == 10:
        print("hears", flush=True)
    time.sleep(callback)

node.create_subscription(String, "/chatter", hear, 10)
node.create_service(Empty, "/rest", lambda request, response: (time.sleep(0.05), response)[1])
lcmtools.spin(node)
"""


@pytest.fixture(autouse=True)
def _bus(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.fixture(autouse=True)
def _talker(start, lcmtools_path):
    start(lcmtools_path, "pub", "-r", "20", "/chatter", "std_msgs/String", "hi")


@pytest.mark.timing
def test_info_shows_how_long_callbacks_take(start_python, cli):
    start_python(_NODE, "0.02").wait_for("hears")
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
    start_python(_NODE, "0").wait_for("hears")
    assert "Calls: 0\n" in cli("service", "info", "/rest").out
    assert cli("service", "call", "/rest").code == 0
    assert "Calls: 1, callbacks: " in cli("service", "info", "/rest").out
    (document,) = json.loads(cli("service", "info", "/rest", "--json").out)
    assert document["servers"][0]["longest_callback"] >= 50_000_000
