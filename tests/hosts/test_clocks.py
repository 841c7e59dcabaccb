"""Computers whose clocks differ: what is told of the other one's nodes is right all the same."""

import json

import pytest

_SHIFT = """
import os, time
_seconds = float(os.environ["CLOCK_SHIFT"])
_time, _time_ns = time.time, time.time_ns
time.time = lambda: _time() + _seconds
time.time_ns = lambda: _time_ns() + int(_seconds * 1e9)
"""
_STAMPED = """
import time, lcmtools
from lcmtools.types.nav_msgs import Odometry
lcmtools.init()
publisher = lcmtools.Node("robot").create_publisher(Odometry, "/odometry")
message = Odometry()
message.pose.pose.orientation.w = 1.0
while True:
    message.header.stamp.sec, message.header.stamp.nsec = divmod(time.time_ns(), 1_000_000_000)
    publisher.publish(message)
    print("sends", flush=True)
    time.sleep(0.02)
"""


_PLAIN = """
import time, lcm
from lcmtools.types.nav_msgs import Odometry
bus, message = lcm.LCM(), Odometry()
message.pose.pose.orientation.w = 1.0
while True:
    message.header.stamp.sec, message.header.stamp.nsec = divmod(time.time_ns(), 1_000_000_000)
    bus.publish("/odometry", message.encode())
    print("sends", flush=True)
    time.sleep(0.02)
"""


@pytest.fixture
def shift(tmp_path):
    """The environment of a program whose clock is ahead by CLOCK_SHIFT seconds."""
    (tmp_path / "sitecustomize.py").write_text(_SHIFT)
    return {"PYTHONPATH": str(tmp_path)}


@pytest.fixture
def shifted(pair, shift):
    """``shifted(100)``: a node on ada, whose clock is ahead by so many seconds; bob."""

    def run(seconds):
        ada, bob = pair
        node = ada.python(_STAMPED, **shift, CLOCK_SHIFT=str(seconds))
        node.wait_for("sends")
        return bob

    return run


@pytest.mark.parametrize("ahead", [100.0, -100.0])
def test_times_of_the_other_computer_are_read_by_its_clock(shifted, ahead):
    bob = shifted(ahead)
    measured = json.loads(bob.out("delay", "/odometry", "-n", "1", "--json").splitlines()[0])
    assert measured["delay"] == pytest.approx(-ahead, abs=1.0)
    (row,) = bob.out("node", "list", "-a", "--wait", "0s").splitlines()
    assert 0 < float(row.rpartition("up ")[2].partition(" s")[0]) < 60
    (row,) = [row for row in bob.out("info", "/odometry").splitlines() if "messages: " in row]
    assert float(row.partition("last: ")[2].partition(" s ago")[0]) < 2
    (record,) = json.loads(bob.out("node", "info", "robot", "--json"))
    assert 0 < record["up_time"] < 60


@pytest.mark.parametrize(("ahead", "how"), [(100.0, "ahead of"), (-100.0, "behind")])
def test_wtf_names_the_clock_and_calls_nobody_stale_or_silent(shifted, ahead, how):
    bob = shifted(ahead)
    found = {
        one["rule"]: one
        for one in json.loads(bob.lcmtools("wtf", "--json", "--wait", "0.7s").stdout)
    }
    assert "ada (10.76.0.1)" in found["clocks"]["text"]
    assert f" {how} " in found["clocks"]["text"]
    assert found["clocks"]["items"] == ["/robot"]
    assert not set(found) & {"stale-nodes", "silent", "slow-rate"}


def test_stamps_of_a_plain_program_show_its_clock(pair, shift):
    ada, bob = pair
    ada.python(_PLAIN, **shift, CLOCK_SHIFT="100").wait_for("sends")
    found = json.loads(bob.lcmtools("wtf", "--json", "--wait", "0.7s").stdout)
    (finding,) = [one for one in found if one["rule"] == "stamps"]
    assert "10.76.0.1:" in finding["items"][0]


def test_wtf_names_the_clock_of_a_computer_behind_relays(pair, shift, lcmtools_path):
    """One that is ahead: the stamps of ada's kernel are not shifted, and its relay uses both."""
    ada, bob = pair
    apart = "udpm://239.255.76.67:7668?ttl=0"
    served = bob.start(lcmtools_path, "relay", "--serve", "tcpq://0.0.0.0:7700")
    served.wait_for("serves")
    bob.start(lcmtools_path, "relay", apart, "tcpq://127.0.0.1:7700").wait_for("carries")
    shifted = {**shift, "CLOCK_SHIFT": "100"}
    there = f"tcpq://{bob.address}:7700"
    ada.start(lcmtools_path, "relay", apart, there, **shifted).wait_for("carries")
    ada.python(_STAMPED, LCM_DEFAULT_URL=apart, **shifted).wait_for("sends")
    told = json.loads(bob.lcmtools("wtf", "--json", "--wait", "2s", "--lcm-url", apart).stdout)
    found = {one["rule"]: one for one in told if one["severity"] != "unchecked"}
    assert " ahead of " in found["clocks"]["text"], told
    assert "/robot" in found["clocks"]["items"]
    assert "stamps" not in found
