"""Faults of relays: what they say of themselves, and what is to be done."""

import signal
import time

_SUBSCRIBES = """
import lcmtools
from lcmtools.types.geometry_msgs import Twist
lcmtools.init()
node = lcmtools.Node("base")
node.create_subscription(Twist, "/cmd_vel", lambda _: None)
lcmtools.spin(node)
"""
_THERE = {"LCMTOOLS_DOMAIN": "1"}
_WAIT = "1.5s"  # a relay reports each second


def _found(world, rule):
    found = world.look("--rule", rule, wait=_WAIT)
    return found


def _relay(world, *words):
    relay = world.tool("relay", *words)
    relay.wait_for("carries messages")
    return relay


def test_a_relay_whose_server_has_ended(world):
    server = world.start(world.command, "relay", "--serve", "tcpq://127.0.0.1:7700")
    server.wait_for("serves")
    relay = _relay(world, "tcpq://127.0.0.1:7700")
    world.end(server)
    relay.wait_for("is lost")
    (found,) = _found(world, "relay-bus")
    assert found.kinds == ["mend-line"]
    world.start(world.command, "relay", "--serve", "tcpq://127.0.0.1:7700")
    relay.wait_for("is back")
    assert _found(world, "relay-bus") == []


def test_a_command_that_a_relay_does_not_let_pass(world):
    node = world.script(_SUBSCRIBES, **_THERE)
    world.until(lambda: node.pid in world.pids(**_THERE))
    relay = _relay(world, "0", "1")
    world.sends("bus.publish('/cmd_vel', Twist().encode())")
    world.until(lambda: node.pid in world.pids())  # the relay knows what it subscribes to
    (found,) = _found(world, "relay-commands")
    assert found.facts[0]["topic"] == "/cmd_vel"
    assert found.kinds == ["allow-command"]
    world.again(relay, "--allow", found.actions[0]["topic"], "--allow", "**").wait_for("carries")
    assert _found(world, "relay-commands") == []


def test_a_relay_beside_another_one(world):
    _relay(world, "0", "1")
    second = world.tool("relay", "0", "1")
    second.wait_for("stands by")
    (found,) = _found(world, "relay-standby")
    assert found.severity == "note"
    world.obey(found, "end-standby")
    second.wait()
    assert _found(world, "relay-standby") == []


_FORWARDS = """
import lcm, sys
here, there = lcm.LCM(sys.argv[1]), lcm.LCM(sys.argv[2])
here.subscribe(".*", there.publish)
print("forwards", flush=True)
while True:
    here.handle()
"""


def test_a_relay_that_is_heard_on_both_buses_and_killed(world):
    """By a plain program that forwards all, reports too; the other relay goes on."""
    urls = [f"udpm://239.255.76.67:{port}?ttl=0" for port in (7667, 7672)]
    relay = _relay(world, "0", "5")
    world.script(_FORWARDS, *urls, ready="forwards")
    killed = world.tool("relay", "0", "6")
    world.until(lambda: len(_relays(world)) == 2)
    time.sleep(2.5)  # each has reported on both
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    (found,) = _found(world, "stale-nodes")
    assert found.facts[0]["pid"] == killed.pid
    time.sleep(6.0)  # until it is forgotten
    assert relay.pid in world.pids(), relay.output
    assert "Traceback" not in relay.output


def _relays(world):
    return {node.pid for node in world.graph().nodes if node.name.startswith("/relay")}
