"""A robot, an office and a third computer, with a long line in between.

The robot's bus stays on the robot; office and third computer share one. A relay on the robot and
one in the office meet at a server of the office, or on a bus of Zenoh. The line delays, loses and
has little room.
"""

import json
import signal
import time

import pytest

ROBOT = "udpm://239.255.76.67:7668?ttl=0"
OFFICE = "udpm://239.255.76.67:7667?ttl=1"
LARGE = 8_000_000
"""Bytes of a message."""

SENDER = """
import lcm, sys, time
bus = lcm.LCM(sys.argv[1])
rate, count, large = float(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
begin = time.monotonic()
for number in range(count):
    time.sleep(max(0.0, begin + number / rate - time.monotonic()))
    bus.publish("/numbers", b"%d" % number)
if large:
    bus.publish("/large", bytes(large))
while True:
    time.sleep(0.01)
    number += 1
    bus.publish("/numbers", b"%d" % number)
"""
RECEIVER = """
import lcm, sys
bus = lcm.LCM("udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4000000")
last = [-1, 0]
def take(channel, payload):
    number = int(payload)
    if number <= last[0]:
        print("is not in order:", number, "after", last[0], flush=True)
    last[1] += number - last[0] - 1
    last[0] = number
    if number % 100 == 99:
        print("got", number, "without", last[1], flush=True)
bus.subscribe("/numbers", take).set_queue_capacity(0)
bus.subscribe("/large", lambda _, payload: print("got large", len(payload), flush=True))
print("listens", flush=True)
while True:
    bus.handle()
"""
TIMES = """
import lcm, sys, time
bus = lcm.LCM(sys.argv[1])
while True:
    bus.publish("/times", b"%f" % time.monotonic())
    time.sleep(0.02)
"""
HEARS_TIMES = """
import lcm
bus = lcm.LCM("udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4000000")
bus.subscribe("/times", lambda _, payload: print("sent at", float(payload), flush=True))
bus.subscribe("/map", lambda _, payload: print("map", payload, flush=True))
print("listens", flush=True)
while True:
    bus.handle()
"""
TYPED = """
import lcm, sys, time
from lcmtools.types.nav_msgs import Odometry
bus = lcm.LCM(sys.argv[1])
while True:
    bus.publish("SLOW", Odometry().encode())
    print("sends", flush=True)
    time.sleep(float(sys.argv[2]))
"""
IMAGES = """
import lcm, sys, time
bus = lcm.LCM(sys.argv[1])
while True:  # several times what the line takes
    bus.publish("/camera/image", bytes(100_000))
    time.sleep(0.005)
"""
SILENT = """
import socket, sys, threading
from lcmtools.wire.tcpq import CLIENT_GREETING, SERVER_GREETING
server = socket.create_server(("0.0.0.0", 7700))
print("serves", flush=True)
def attend(client):
    client.recv(len(CLIENT_GREETING), socket.MSG_WAITALL)
    client.sendall(SERVER_GREETING)
    while client.recv(65536):
        pass
while True:
    threading.Thread(target=attend, args=server.accept()[:1], daemon=True).start()
"""
KEEPING = """
import socket, threading
from lcmtools.wire import tcpq
server = socket.create_server(("0.0.0.0", 7700))
print("serves", flush=True)
clients, lock = [], threading.Lock()
def attend(client):
    reader = tcpq.FrameReader()
    client.sendall(tcpq.SERVER_GREETING)
    while data := client.recv(65536):
        for frame in reader.read(data):
            with lock:
                if frame.name == ".*":
                    clients.append(client)
                for one in list(clients) if frame.kind == tcpq.PUBLISH else ():
                    try:
                        one.sendall(frame.data)
                    except OSError:
                        clients.remove(one)
while True:
    threading.Thread(target=attend, args=server.accept()[:1], daemon=True).start()
"""
HOSTILE = """
import os, socket, struct, sys
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
group = ("239.255.76.67", int(sys.argv[1]))
for name in (b"/_lcmtools/node", b"/_lcmtools/relay", b"/_lcmtools/probe", b"/x", b"\\xff" * 63):
    for size in (0, 7, 8, 100, 5000):
        sender.sendto(b"LC02" + bytes(4) + name + b"\\0" + os.urandom(size), group)
long = b"LC02" + bytes(4) + b"a" * 70
for data in (b"", b"LC02", long, b"LC03" + b"\\xff" * 16, b"LC03" + bytes(30)):
    sender.sendto(data, group)
for number in range(200):
    sender.sendto(b"LC03" + struct.pack(">IIIHH", number, 1 << 28, 0, 0, 5000) + b"/x\\0", group)
print("has sent", flush=True)
"""


class Line:
    """The computers, with the relays on them that have begun to work.

    Attributes:
        meeting: The kind of bus that the relays meet on.
    """

    def __init__(self, network, lcmtools_path, meeting):
        self.robot, self.office, self.third = network.hosts
        self.path, self.meeting = lcmtools_path, meeting
        self.cable = network.stretch(self.robot, 10.0, 500, 4e6)
        if meeting == "tcpq":
            served = self.office.start(lcmtools_path, "relay", "--serve", "tcpq://0.0.0.0:7700")
            served.wait_for("serves tcpq://0.0.0.0:7700 to everyone who can reach this computer")
            there = "tcpq://127.0.0.1:7700"
        else:
            there = "zenoh://?listen=0.0.0.0:7447"
        self.office.start(lcmtools_path, "relay", OFFICE, there).wait_for("carries messages")
        self.relays = [self.relay("carries"), self.relay("stands by")]
        self.receiver = self.third.python(RECEIVER)
        self.receiver.wait_for("listens")

    def relay(self, state, *words):
        """One more relay on the robot, which carries or stands by."""
        port = 7700 if self.meeting == "tcpq" else 7447
        there = f"{self.meeting}://{self.office.address}:{port}"
        relay = self.robot.start(self.path, "relay", ROBOT, there, *words)
        relay.wait_for(state)
        return relay

    def send(self, rate, count, large=0):
        """A program on the robot that sends so many numbers, and then a hundred a second."""
        return self.robot.python(SENDER, ROBOT, str(rate), str(count), str(large))


@pytest.fixture(params=["tcpq", "zenoh"])
def line(network, lcmtools_path, request):
    """The computers, joined by a server or by Zenoh."""
    return Line(network("robot", "office", "third"), lcmtools_path, request.param)


def _in_order(receiver):
    return not any("is not in order" in row for row in receiver.lines)


def test_everything_arrives_once_and_in_order_over_a_bad_line(line):
    line.send(500.0, 1000, LARGE)
    line.receiver.wait_for("got 999 without 0")
    line.receiver.wait_for(f"got large {LARGE}")


def test_a_storm_of_messages_arrives_in_order_and_what_follows_it_too(line):
    """A bad line stalls for longer than messages may wait: some of them are dropped."""
    line.send(10_000.0, 10_000)
    while int(line.receiver.wait_for("got").split()[1]) < 10_000:
        pass
    assert _in_order(line.receiver)


def test_another_relay_takes_over_and_nothing_comes_twice(line):
    line.send(200.0, 6000)
    line.receiver.wait_for("got 199 without 0")
    line.relays[0].send_signal(signal.SIGKILL)
    line.relays[1].wait_for("carries messages")
    line.relay("stands by")
    after = line.receiver.wait_for("got")
    for _ in range(10):
        after = line.receiver.wait_for("got")
    lost = int(after.split()[-1])
    assert 0 < lost < 2000  # while none of them carried, and no longer
    assert _in_order(line.receiver)


def test_a_line_that_was_cut_carries_again(line):
    line.send(100.0, 6000)
    line.receiver.wait_for("got 99 without 0")
    line.cable.send_signal(signal.SIGUSR1)
    time.sleep(10.0)  # the cut itself
    line.cable.send_signal(signal.SIGUSR1)
    before = len(line.receiver.lines)
    while len(line.receiver.lines) < before + 5:
        line.receiver.wait_for("got")
    assert _in_order(line.receiver)


def test_a_relay_beside_another_one_waits_for_reports_over_the_line(network, lcmtools_path):
    """As while the line comes back, when both have their connection and hear nobody yet."""
    robot, office = network("robot", "office").hosts
    office.python(SILENT).wait_for("serves")
    words = (lcmtools_path, "relay", ROBOT, f"tcpq://{office.address}:7700")
    robot.start(*words).wait_for("carries")
    begin = time.monotonic()
    robot.start(*words).wait_for("carries")
    assert time.monotonic() - begin > 4.0  # before, the connection would be found dead


def test_no_message_that_waited_for_the_line_arrives_late_but_what_is_latched(line):
    """All computers of the test have one clock, which the programs under test do not know."""
    hears = line.third.python(HEARS_TIMES)
    hears.wait_for("listens")
    line.robot.python(TIMES, ROBOT)
    hears.wait_for("sent at")
    cut = _toggle(line.cable)
    words = ("pub", "--latch", "/map", "std_msgs/String", "data: hall", "--lcm-url", ROBOT)
    line.robot.start(line.path, *words).wait_for("latching")
    time.sleep(max(0.0, cut + 2.5 - time.monotonic()))  # shorter than what counts as an outage
    mended = _toggle(line.cable)
    hears.wait_for("map")
    while (newest := hears.wait_for("sent at")) and float(newest.split()[-1]) < mended:
        pass
    times = [float(row.split()[-1]) for row in hears.lines if row.startswith("sent at")]
    late = [time for time in times if cut + 0.3 < time < mended - 1.2]
    assert not late
    assert line.meeting == "tcpq" or _lost(line) > 0  # a connection's own buffer is not counted


@pytest.mark.parametrize("way", ["out", "back"])
def test_what_another_server_keeps_during_a_cut_does_not_arrive(network, lcmtools_path, way):
    """A server like lcm.jar, whose system keeps for a client whatever it has buffers for."""
    net = network("robot", "office")
    robot, office = net.hosts
    office.python(KEEPING).wait_for("serves")
    for host, bus, server in ((office, OFFICE, "127.0.0.1"), (robot, ROBOT, office.address)):
        relay = host.start(lcmtools_path, "relay", bus, f"tcpq://{server}:7700")
        relay.wait_for("carries messages")
    ends = [(robot, ROBOT), (office, OFFICE)]
    (one, bus), (other, far) = ends if way == "out" else reversed(ends)
    hears = other.python(HEARS_TIMES.replace(OFFICE, far))
    hears.wait_for("listens")
    one.python(TIMES, bus)
    hears.wait_for("sent at")
    net.unplug(robot)
    cut = time.monotonic()
    time.sleep(2.5)
    mended = time.monotonic()
    net.plug(robot)
    while float(hears.wait_for("sent at").split()[-1]) < mended + 1:
        pass
    times = [float(row.split()[-1]) for row in hears.lines if row.startswith("sent at")]
    assert not [one for one in times if cut + 0.3 < one < mended - 1.2]


def _toggle(cable):
    """Cut the line, or mend it; return the time."""
    cable.send_signal(signal.SIGUSR1)
    return float(cable.wait_for("is ").split()[-1])


def _lost(line):
    shown = [
        *json.loads(line.robot.out("relay", "--status", "--json", LCM_DEFAULT_URL=ROBOT)),
        *json.loads(line.office.out("relay", "--status", "--json", LCM_DEFAULT_URL=OFFICE)),
    ]
    return sum(end["lost"] + end["dropped"] for link in shown for end in link["ends"])


def test_a_relay_that_drops_what_its_line_does_not_take(network, lcmtools_path):
    line = Line(network("robot", "office", "third"), lcmtools_path, "tcpq")
    line.robot.python(IMAGES, ROBOT)
    look = ("wtf", "--rule", "relay-losses", "--json", "--wait", "4s")
    found = line.robot.lcmtools(*look, LCM_DEFAULT_URL=ROBOT)
    assert found.returncode == 1
    assert "messages for tcpq://10.76.0.2:7700" in found.stdout
    for relay in line.relays:
        relay.end()
    line.relay("carries", "--rate", "/camera/**=1")
    assert line.robot.lcmtools(*look, LCM_DEFAULT_URL=ROBOT).stdout == "[]\n"


@pytest.mark.parametrize("period", ["0.5", "3"])
def test_a_slow_plain_program_behind_relays_is_known_at_once(line, period):
    sender = line.robot.python(TYPED, ROBOT, period)
    sender.wait_for("sends")
    bus = "udpm://239.255.76.67:7668 on robot"
    for host in (line.office, line.third):

        def out(*words, host=host):
            return host.out(*words, LCM_DEFAULT_URL=OFFICE)

        assert out("list") == "SLOW\n"
        assert out("type", "SLOW") == "nav_msgs/Odometry\n"
        assert out("list", "--host") == f"Host [robot ({bus})]:\n  SLOW\n"
        (topic,) = json.loads(out("info", "SLOW", "--json"))
        (seen,) = topic["other_publishers"]
        assert seen["program"].startswith("a program at robot:")
        assert seen["messages"]
        programs = json.loads(out("node", "list", "-a", "--json"))
        (program,) = (one for one in programs if one.get("publications"))
        assert (program["host"], program["bus"]) == ("robot", bus)
        assert [one["topic"] for one in program["publications"]] == ["SLOW"]


def test_hostile_datagrams_on_both_sides_change_nothing(line):
    for host, port in ((line.robot, "7668"), (line.third, "7667")):
        host.python(HOSTILE, port).wait_for("has sent")
    line.send(200.0, 400)
    line.receiver.wait_for("got 399 without 0")
    assert _in_order(line.receiver)
    for host, bus in ((line.robot, ROBOT), (line.office, OFFICE)):
        assert "carries" in host.out("relay", "--status", LCM_DEFAULT_URL=bus)
