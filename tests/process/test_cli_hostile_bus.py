"""Whatever comes over the bus, nodes do not end from it, and commands go on.

In a network of its own: such datagrams end any program of the lcm package that hears them.
"""

import json
import random
import re
import signal
import socket
import struct
import sys
import threading
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools.messages.codec import encode
from lcmtools.types import lcmtools_msgs
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.std_msgs import String

GROUP = ("239.255.76.67", 7667)
CHANNELS = [
    b"/chatter",
    b"/odometry",
    b"/desired_velocity",
    b"/rosout",
    b"/_lcmtools/node",
    b"/_lcmtools/probe",
]

pytestmark = pytest.mark.usefixtures("private_network")


def short(channel, payload):
    return b"LC02" + struct.pack(">I", 0) + channel + b"\0" + payload


def fragment(seqno, size, place, channel, part):
    """A fragment; ``place`` is its offset, its number and how many there are."""
    name = b"" if channel is None else channel + b"\0"
    return b"LC03" + struct.pack(">IIIHH", seqno, size, *place) + name + part


def payloads():
    """Payloads of wrong types, cut short, and with lengths that cannot be."""
    string = encode(String())
    announcement = encode(lcmtools_msgs.Announcement())
    return [
        b"",
        b"x",
        b"\0" * 8,
        b"\xff" * 100,
        string[:-1],
        string[:9],
        string[:8] + b"\x7f\xff\xff\xff" + b"abc",
        string[:8] + b"\xff\xff\xff\xff" + b"abc",
        string[:8] + b"\0\0\0\3\xff\xfe\0",
        encode(Odometry())[:50],
        encode(Twist())[:-3],
        encode(Twist()),
        announcement,
        announcement[:20],
        announcement[:8] + b"\x7f\xff\xff\xff" * 20,
        encode(lcmtools_msgs.Probe())[:10],
    ]


def malformed():
    """Datagrams that are none of LCM's."""
    return [
        b"",
        b"x",
        b"LC02",
        b"LC02\0\0\0\0",
        b"LC02\0\0\0\0chatter",
        b"LC02\0\0\0\0" + b"a" * 70 + b"\0x",
        b"GET / HTTP/1.1\r\n",
        b"LC03",
        b"LC03\0\0\0\0\0",
        fragment(1, 10, (0, 0, 0), b"/chatter", b""),
        fragment(1, 10, (0, 5, 3), None, b"x"),
        fragment(2, 1 << 31, (0, 0, 2), b"/chatter", b"a"),
        fragment(3, 100, (200, 1, 2), None, b"zz"),
        fragment(4, 10, (0, 0, 2), b"/chatter", b"12345"),
        fragment(4, 10, (3, 1, 2), None, b"12345"),
        fragment(5, 10, (0, 0, 1), b"a" * 80, b"1"),
        fragment(6, 0xFFFFFFFF, (0, 0, 65535), b"/chatter", b""),
    ]


def hostile(seed):
    """Every kind of bad datagram, and any of them with a byte changed."""
    kinds = malformed() + [short(c, p) for c in [*CHANNELS, b"\xff\xfe", b""] for p in payloads()]
    yield from kinds
    chance = random.Random(seed)  # noqa: S311 - the same bytes each time
    for _ in range(400):
        datagram = bytearray(chance.choice(kinds) or b"y")
        datagram[chance.randrange(len(datagram))] = chance.randrange(256)
        yield bytes(datagram)


@pytest.fixture
def attack():
    """``attack(datagrams)`` sends each, slowly enough that nothing is lost; in this network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:

        def send(datagrams):
            pause = threading.Event()
            for datagram in datagrams:
                sender.sendto(datagram, GROUP)
                pause.wait(0.0003)

        yield send


@pytest.fixture
def running(start, lcmtools_path):
    """The nodes and commands that have to live through it."""
    programs = {
        "talker": start(lcmtools_path, "run", "talker"),
        "listener": start(lcmtools_path, "run", "listener"),
        "controller": start(lcmtools_path, "run", "simple_controller"),
        "latch": start(lcmtools_path, "pub", "/latched", "std_msgs/String", "stay"),
        "echo": start(lcmtools_path, "echo", "--json", "chatter"),
        "hz": start(lcmtools_path, "hz", "chatter"),
    }
    programs["listener"].wait_for("I heard")
    programs["latch"].wait_for("publishing and latching")
    programs["echo"].wait_for("hello world")
    programs["hz"].wait_for("average rate")
    return programs


def test_nodes_and_commands_live_through_all_of_it(running, attack, cli):
    # liblcm reads the channel of the message that was in the same buffer before
    attack(d for c in CHANNELS for _ in range(50) for d in (short(c, b""), b"LC02\xe5\0\0\0"))
    for seed in range(3):
        attack(hostile(seed))

    number = int(running["talker"].lines[-1].rpartition(" ")[2]) + 3
    running["listener"].wait_for(f"I heard: [hello world {number}]")
    running["echo"].wait_for(f"hello world {number}")
    running["hz"].wait_for("average rate")
    assert cli("echo", "-1", "/latched").out == 'data: "stay"\n---\n'
    nodes = cli("node", "list").out.splitlines()
    assert {"/talker", "/listener", "/simple_controller"} <= set(nodes)
    for name in ("talker", "listener", "controller"):
        running[name].send_signal(signal.SIGINT)
        assert running[name].wait() == 0
    for name in ("latch", "echo", "hz"):
        running[name].send_signal(signal.SIGINT)
        assert running[name].wait() == 130
    assert not any("Traceback" in program.output for program in running.values())


def test_wrong_types_and_truncated_payloads_are_warnings_of_the_node(
    start, attack, lcmtools_path, cli, wait_until
):
    listener = start(lcmtools_path, "run", "listener")
    wait_until(lambda: cli("node", "list").out == "/listener\n")
    good = String()
    good.data = "still here"
    attack([short(b"/chatter", payload) for payload in payloads()])
    attack([short(b"/chatter", encode(good))])
    listener.wait_for("I heard: [still here]")
    assert re.search(r"\[WARN\] .*: /chatter: .*expected std_msgs/String, got", listener.output)


_SENDER = """
import socket, sys, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
print("ready", flush=True)
while True:
    sender.sendto(b"LC02" + bytes(4) + b"a" * 80, ("239.255.76.67", 7667))
    print(sender.getsockname()[1], flush=True)
    time.sleep(0.02)
"""


def test_wtf_names_the_sender_of_malformed_datagrams(start_python, start, cli, lcmtools_path):
    start(lcmtools_path, "run", "talker")
    start(lcmtools_path, "run", "listener").wait_for("I heard")
    sender = start_python(_SENDER)
    sender.wait_for("ready")
    port = int(sender.wait_for(""))
    result = cli("wtf", "--json", "--wait", "0.3s")
    findings = {finding["rule"]: finding for finding in json.loads(result.out)}
    assert result.code == 1
    assert set(findings) <= {"malformed", "irregular"}  # what the nodes' filters drop is no fault
    (item,) = findings["malformed"]["items"]
    assert item.startswith(f"0.0.0.0:{port}, ")
    assert f"script_0.py (pid {sender.pid})" in item
    assert_says(item, ": short message", "channel name", "63 bytes")


def test_commands_look_at_a_hostile_bus(cli, start, lcmtools_path):
    start(lcmtools_path, "pub", "-r", "50", "/a", "std_msgs/String", "x").wait_for("no node")
    flood = start(sys.executable, __file__, PYTHONPATH=str(Path(__file__).parents[1]))
    flood.wait_for("round 1")
    for command in ("list", "list --json", "node list", "wtf --wait 0.3", "echo -1 /a"):
        result = cli(*command.split())
        assert result.code in ((0, 1, 2) if "wtf" in command else (0,))
        assert "Traceback" not in result.err
        assert "fault of lcmtools" not in result.err
        shown = result.out.replace("\n", "").replace("\t", "")
        # no escape sequence reaches the terminal
        assert shown.isprintable() or "\\ud" in ascii(shown), command


def _flood():
    """Runs as a program of its own: sends everything, again and again."""
    pause = threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for seed in range(1_000):
            for datagram in hostile(seed):
                sender.sendto(datagram, GROUP)
                pause.wait(0.0005)
            print(f"round {seed}", flush=True)  # noqa: T201 - tells the test


if __name__ == "__main__":
    _flood()
