"""Nodes on a computer that is cut off, or that are killed there: stale for who goes on looking."""

import json
import signal

import pytest

_WATCHER = """
import lcm
bus = lcm.LCM()
bus.subscribe("/_lcmtools/probe", lambda _, __: print("question", flush=True))
bus.subscribe("/_lcmtools/node", lambda _, data: print(data[:100], flush=True))
print("listens", flush=True)
while True:
    bus.handle()
"""
_STALE = "no longer announces itself"


@pytest.fixture
def looking(lcmtools_path):
    """``looking(host, "wtf", ...)``: a command that has heard of the talker, and still looks."""

    def run(host, *command):
        watcher = host.python(_WATCHER)
        watcher.wait_for("listens")
        started = host.start(lcmtools_path, *command)
        watcher.wait_for("question")
        watcher.wait_for("/talker")
        watcher.end()
        return started

    return run


def test_a_node_behind_a_pulled_cable_is_stale_until_it_is_plugged_in_again(
    network, looking, lcmtools_path
):
    net = network("ada", "bob")
    ada, bob = net.hosts
    talker = ada.start(lcmtools_path, "run", "talker")
    talker.wait_for("hello")
    echo, hz = (bob.start(lcmtools_path, verb, "/chatter") for verb in ("echo", "hz"))
    echo.wait_for("hello")
    hz.wait_for("average rate")
    listing = looking(bob, "node", "list", "-a", "--wait", "4.5s")
    net.unplug(ada)
    assert listing.wait() == 0
    (row,) = [row for row in listing.lines if "/talker" in row]
    assert row.endswith(f"stale: {_STALE}")
    assert ada.out("node", "list") == "/talker\n"
    hz.wait_for("no new messages")
    assert len(echo.lines) > 1
    del echo.lines[:]
    net.plug(ada)
    echo.wait_for("hello")
    hz.wait_for("average rate")
    assert bob.out("node", "list") == "/talker\n"
    for program in (echo, hz):
        program.send_signal(signal.SIGINT)
        assert program.wait() == 130
        assert "Traceback" not in program.output


def test_wtf_names_a_node_that_is_killed_elsewhere_while_it_looks(pair, looking, lcmtools_path):
    ada, bob = pair
    talker = ada.start(lcmtools_path, "run", "talker")
    talker.wait_for("hello")
    doctor = looking(bob, "wtf", "--json", "--wait", "4.5s")
    talker.send_signal(signal.SIGKILL)
    assert doctor.wait() == 2
    (finding,) = [one for one in json.loads(doctor.output) if one["rule"] == "stale-nodes"]
    assert finding["items"][0].startswith("/talker ")
    assert finding["items"][0].endswith(_STALE)
    # where it ran its record tells more, and at once
    found = json.loads(ada.lcmtools("wtf", "--json", "--wait", "0.2s").stdout)
    (finding,) = [one for one in found if one["rule"] == "stale-nodes"]
    assert finding["items"][0].endswith("ended without saying goodbye")


def test_a_node_that_says_goodbye_is_gone_for_who_looks_elsewhere(pair, looking, lcmtools_path):
    ada, bob = pair
    talker = ada.start(lcmtools_path, "run", "talker")
    talker.wait_for("hello")
    listing = looking(bob, "node", "list", "-a", "--wait", "1s")
    talker.send_signal(signal.SIGINT)
    assert talker.wait() == 0
    assert listing.wait() == 0
    assert "/talker" not in listing.output
