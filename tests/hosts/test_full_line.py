"""A line that takes a fifth of what is sent: commands pass in time, images are the newest."""

import json
import re
import signal
import time
from statistics import median
from typing import NamedTuple

import pytest

from lcmtools.relay.fair_queue import LATE

_ROBOT = "udpm://239.255.76.67:7668?ttl=0"
_OFFICE = "udpm://239.255.76.67:7667?ttl=0"
_MEGABIT = 1e6 / 8  # [byte/s]
_SECONDS = 8
_FAULTS = ("error", "warning")

# BUS SIZE PERIOD SECONDS: a plain LCM program that sends commands and images, each with its time
_SENDER = """
import json, lcm, struct, sys, threading, time
bus, other = lcm.LCM(sys.argv[1]), lcm.LCM(sys.argv[1])
size, period, seconds = int(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
end = time.monotonic() + seconds
counts = {}
def send(bus, channel, size, period):
    due = time.monotonic()
    while due < end:
        time.sleep(max(0.0, due - time.monotonic()))
        bus.publish(channel, struct.pack("8xd", time.monotonic()).ljust(size, b"1"))
        counts[channel] = counts.get(channel, 0) + 1
        due += period
images = threading.Thread(target=send, args=(other, "/camera/image", size, period))
images.start()
send(bus, "/cmd_vel", 64, 0.05)
images.join()
print("sent", json.dumps(counts), flush=True)
"""
_RECEIVER = """
import json, lcm, select, struct, sys, time
bus = lcm.LCM(sys.argv[1])
found = {"/cmd_vel": [], "/camera/image": []}
def take(channel, payload):
    now = time.monotonic()
    found[channel].append((now, now - struct.unpack_from("d", payload, 8)[0], len(payload)))
for channel in found:
    bus.subscribe(channel, take).set_queue_capacity(0)
print("listens", flush=True)
last = time.monotonic()
while not found["/cmd_vel"] or time.monotonic() - found["/cmd_vel"][-1][0] < 4:
    if select.select([bus.fileno()], [], [], 0.5)[0]:
        bus.handle()
print("found", json.dumps(found), flush=True)
"""


class _Flow(NamedTuple):
    """What arrived of a flow of messages."""

    share: float  # of the messages sent
    median: float  # age [s]
    oldest: float  # [s]
    bytes_per_second: float


def _flow(arrived, sent):
    ages = [age for _, age, _ in arrived] or [99.0]
    size = sum(size for _, age, size in arrived if age < 2)
    return _Flow(len(arrived) / sent, median(ages), max(ages), size / _SECONDS)


class _FullLine:
    """A robot and an office, with relays on both and a line of so many bytes a second."""

    def __init__(self, network, lcmtools_path, meeting, rate):
        self.robot, self.office = network.hosts
        network.stretch(self.robot, 10.0, 1_000_000, rate)
        self._path = lcmtools_path
        if meeting == "tcpq":
            served = self.office.start(lcmtools_path, "relay", "--serve", "tcpq://0.0.0.0:7700")
            served.wait_for("serves")
            here, there = "tcpq://127.0.0.1:7700", f"tcpq://{self.office.address}:7700"
        else:
            here, there = "zenoh://?listen=0.0.0.0:7447", f"zenoh://{self.office.address}:7447"
        self._buses = {self.office: (_OFFICE, here), self.robot: (_ROBOT, there)}
        self.relays = {host: self.relay(host) for host in self._buses}

    def relay(self, host, *options):
        """Start the relay of a host."""
        allowed = ("--allow", "**", "--allow", "/cmd_vel", *options)
        relay = host.start(self._path, "relay", *self._buses[host], *allowed)
        relay.wait_for("carries messages")
        return relay

    def losses(self):
        """Return what ``wtf`` says of full lines on each of the hosts; nothing else is a fault."""
        found = []
        for host, (bus, _) in self._buses.items():
            shown = host.lcmtools("wtf", "--json", LCM_DEFAULT_URL=bus).stdout
            faults = {x["rule"]: x for x in json.loads(shown) if x["severity"] in _FAULTS}
            assert faults.keys() <= {"relay-losses"}, faults
            found += [json.dumps(fault) for fault in faults.values()]
        return found

    def run(self, size, period, *, back=False):
        """Send commands and images from the robot, or back to it; return what arrived of them."""
        ends = [(self.robot, _ROBOT), (self.office, _OFFICE)]
        (one, bus), (other, far) = reversed(ends) if back else ends
        receiver = other.python(_RECEIVER, far)
        receiver.wait_for("listens")
        sender = one.python(_SENDER, bus, str(size), str(period), str(_SECONDS))
        counts = json.loads(sender.wait_for("sent ").partition(" ")[2])
        found = json.loads(receiver.wait_for("found").partition(" ")[2])
        commands, images = (_flow(found[name], counts[name]) for name in found)
        return commands, images


@pytest.mark.parametrize("meeting", ["tcpq", "zenoh"])
@pytest.mark.parametrize(
    ("size", "period", "way"),
    [(20_000, 1 / 30, "out"), (100_000, 1 / 6, "out"), (100_000, 1 / 6, "back")],
)
def test_commands_pass_a_full_line_in_time(network, lcmtools_path, meeting, size, period, way):
    line = _FullLine(network("robot", "office"), lcmtools_path, meeting, _MEGABIT)
    commands, images = line.run(size, period, back=way == "back")
    print(meeting, size, way, commands, images)  # noqa: T201 - the figures, where it fails
    assert commands.share > 0.98
    assert commands.median < 0.5
    assert commands.oldest < 1.2
    assert images.bytes_per_second > 0.6 * _MEGABIT


@pytest.mark.parametrize("meeting", ["tcpq", "zenoh"])
def test_nothing_is_lost_on_a_line_that_takes_all(network, lcmtools_path, meeting):
    line = _FullLine(network("robot", "office"), lcmtools_path, meeting, 10 * _MEGABIT)
    commands, images = line.run(20_000, 1 / 30)
    print(meeting, commands, images)  # noqa: T201 - the figures, where it fails
    # on a computer that stood still, a relay drops what is late; what just passed shows that
    is_late = max(commands.oldest, images.oldest) > LATE
    assert is_late or commands.share == images.share == 1.0
    assert images.median < 0.3


@pytest.mark.parametrize("meeting", ["tcpq", "zenoh"])
@pytest.mark.parametrize("way", ["out", "back"])
def test_wtf_names_a_full_line_on_both_sides_and_the_rate_that_it_takes(
    network, lcmtools_path, meeting, way
):
    line = _FullLine(network("robot", "office"), lcmtools_path, meeting, _MEGABIT)
    for host, bus in ((line.robot, _ROBOT), (line.office, _OFFICE)):  # its clocks are compared
        node = ("run", "talker", f"__name:=at_{host.name}", f"chatter:=/of_{host.name}")
        host.start(lcmtools_path, *node, LCM_DEFAULT_URL=bus).wait_for("hello")
    host, bus = (line.robot, _ROBOT) if way == "out" else (line.office, _OFFICE)
    host.python(_SENDER, bus, "20000", str(1 / 30), "200")
    time.sleep(3)  # of a full line
    found = line.losses()
    assert len(found) == 2, found
    (option,) = {one for text in found for one in re.findall(r"--rate (/camera/image)=", text)}
    rate = min(float(one) for text in found for one in re.findall(r"image=([0-9.]+)", text))
    assert rate * 20_000 > 0.3 * _MEGABIT
    line.relays[host].send_signal(signal.SIGINT)
    line.relays[host].wait()
    line.relay(host, "--rate", f"{option}={rate:g}")
    time.sleep(6)  # what was dropped before is forgotten
    assert line.losses() == []
