"""Computers of the same name, one with two interfaces, and a simulator across the network."""

import json

import pytest

_PLAIN_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("/chatter", lambda *_: None)
print("listens", flush=True)
while True:
    bus.handle()
"""


def test_computers_of_one_name_are_told_apart_by_address(network, lcmtools_path):
    one, other, bob = network("robot", "robot", "bob").hosts
    talkers = []
    for host in (one, other):
        host.next_pid(700)
        talkers.append(host.start(lcmtools_path, "run", "talker"))
        talkers[-1].wait_for("hello")
    rows = bob.out("list", "--host").splitlines()
    hosts = [row for row in rows if row.startswith("Host")]
    assert hosts == ["Host [robot (10.76.0.1)]:", "Host [robot (10.76.0.2)]:"]
    rows = one.out("list", "--host").splitlines()
    hosts = [row for row in rows if row.startswith("Host")]
    assert hosts == ["Host [robot]:", "Host [robot (10.76.0.2)]:"]
    machines = ["robot (10.76.0.1)", "robot (10.76.0.2)"]
    assert bob.out("node", "machine").splitlines() == machines
    assert bob.out("node", "machine", "10.76.0.2") == "/talker\n"

    # the record of its own, and what the system tells of a process, is the own one's only
    told = json.loads(one.out("node", "info", "talker", "--json"))
    assert sorted(node["memory_bytes"] is not None for node in told) == [False, True]
    found = json.loads(bob.lcmtools("wtf", "--json", "--wait", "0.2s").stdout)
    assert "duplicate-names" in [finding["rule"] for finding in found]

    refused = bob.lcmtools("node", "kill", "talker")
    assert refused.returncode == 1
    assert "write HOST:PID: 10.76.0.1:700, 10.76.0.2:700" in refused.stderr
    assert bob.out("node", "kill", "10.76.0.2:700") == "killing /talker\nkilled\n"
    assert talkers[1].wait() == 0
    assert one.out("node", "list") == "/talker\n"


def test_a_listener_on_the_wrong_interface_is_named(network):
    net = network("ada", "bob")
    _, bob = net.hosts
    net.connect(bob, "eth1", "10.77.0.2")
    bob.ip("route", "replace", "224.0.0.0/4", "dev", "eth1")
    listener = bob.python(_PLAIN_LISTENER)
    listener.wait_for("listens")
    bob.ip("route", "replace", "224.0.0.0/4", "dev", "eth0")
    found = json.loads(bob.lcmtools("wtf", "--json", "--wait", "0.2s").stdout)
    (finding,) = [one for one in found if one["rule"] == "interfaces"]
    assert "eth0" in finding["text"]
    assert any("eth1" in item for item in finding["items"])


def test_a_controller_on_one_computer_drives_the_robot_on_another(pair, lcmtools_path):
    pytest.importorskip("pybullet")
    ada, bob = pair
    ada.start(lcmtools_path, "run", "sim", "husky")
    controller = ("simple_controller", "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    bob.start(lcmtools_path, "run", *controller)
    bob.start(
        *(lcmtools_path, "pub", "/husky0/desired_velocity", "geometry_msgs/Twist"),
        *("linear: {x: 0.5}", "-r", "10"),
    )
    driven = ("echo", "/husky0/odometry", "-n", "1", "--timeout", "15s", "--json")
    shown = bob.out(*driven, "--filter", "m.twist.twist.linear.x > 0.4")
    assert json.loads(shown)["twist"]["twist"]["linear"]["x"] > 0.4
    assert "/husky0/simple_controller" in ada.out("info", "/husky0/velocity_cmd")
