"""Faults in who listens: stopped, with a small buffer, too slow."""

import signal
from typing import Any

import pytest

LARGE = ("00", "1500000", "5")
BURSTS = "[bus.publish('A', bytes(1000)) for _ in range(150)]"
SLOW = """
import sys, time
import lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("slow")
node.create_subscription(String, "/chatter", lambda _: time.sleep(float(sys.argv[1])), 10)
lcmtools.spin(node)
"""
HANGS = """
import socket, struct, time
ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 5000)
ear.bind(("239.255.76.67", 7667))
group = socket.inet_aton("239.255.76.67")
ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + socket.inet_aton("0.0.0.0"))
print("listens", flush=True)
time.sleep(1000)
"""


@pytest.mark.parametrize("kind", ["java", "lcm-sink"])
def test_a_stopped_listener(world: Any, kind: str) -> None:
    listener = world.lcm(kind) if kind == "lcm-sink" else world.java("Listens", "A")
    world.sends("bus.publish('A', bytes(5000))", 0.005)
    listener.send_signal(signal.SIGSTOP)
    found = world.finds("stuck-listeners", f"(pid {listener.pid}): it is stopped")
    assert found.commands == [f"kill -CONT {listener.pid}", f"kill {listener.pid}"]
    world.type(found.commands[0])
    world.is_silent()


def test_a_listener_that_hangs(world: Any) -> None:
    world.sends("bus.publish('A', bytes(5000))", 0.005)
    listener = world.script(HANGS, ready="listens")
    world.finds("stuck-listeners", listener.pid, "bytes wait", f"py-spy dump --pid {listener.pid}")
    world.end(listener)
    world.hears("A")
    world.is_silent()


def test_a_message_that_no_usual_buffer_takes(world: Any) -> None:
    sink = world.lcm("lcm-sink")
    sender = world.c("sends", "CAM", *LARGE)
    found = world.finds("small-buffer", sender.pid, f"(pid {sink.pid}): holds ", "1500000 bytes")
    world.again(sink, **found.variables)
    world.is_silent()


def test_a_listener_with_a_tiny_buffer(world: Any) -> None:
    url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=30000"
    sink = world.lcm("lcm-sink", LCM_DEFAULT_URL=url)
    world.c("sends", "CAM", "00", "120000", "10")
    found = world.finds("small-buffer", sink.pid, "CAM")
    world.again(sink, **found.variables)
    world.is_silent()


def test_bursts_that_a_small_buffer_does_not_take(world: Any) -> None:
    url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2500"
    sink = world.hears("A", LCM_DEFAULT_URL=url)
    sender = world.sends(BURSTS, 0.05)
    found = world.finds("kernel-drops", f"(pid {sink.pid})", "recv_buf_size=")
    world.again(sink, **found.variables)
    world.is_silent()
    assert sender.pid


def test_a_callback_that_loses_messages(world: Any) -> None:
    slow = world.script(SLOW, "0.2")
    world.tool("pub", "-r", "100", "/chatter", "std_msgs/String", "x")
    world.until(lambda: _drops(world) > 0)
    world.finds("queue-drops", "/slow", "messages of /chatter (depth 10)", wait="1s")
    world.end(slow)
    world.script(SLOW, "0")
    world.until(lambda: any(node.name == "/slow" for node in world.graph().nodes))
    world.is_silent()


def _drops(world: Any) -> int:
    return max((end.drops for node in world.graph().nodes for end in node.endpoints), default=0)


def test_a_callback_that_takes_all_the_time(world: Any) -> None:
    slow = world.script(SLOW, "0.098")
    world.tool("pub", "-r", "10", "/chatter", "std_msgs/String", "x")
    world.until(lambda: _calls(world) > 8)
    world.finds("slow-callbacks", "/slow", "/chatter", wait="1.2s")
    world.end(slow)
    world.script(SLOW, "0.01")
    world.until(lambda: any(node.name == "/slow" for node in world.graph().nodes))
    world.is_silent()


def _calls(world: Any) -> int:
    ends = [end for node in world.graph().nodes if node.name == "/slow" for end in node.endpoints]
    return max((end.messages for end in ends if end.topic == "/chatter"), default=0)
