"""Programs hear each other whatever happens to the computer's interfaces and routes."""

import signal
import sys

import pytest

from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.std_msgs import UInt32

pytestmark = pytest.mark.usefixtures("bare_network")


_URL = "udpm://239.255.76.67:7667?ttl=0"
_COUNTS = """
import itertools, lcmtools
from lcmtools.types.std_msgs import UInt32

lcmtools.init()
node = lcmtools.Node("counter")
publisher, numbers = node.create_publisher(UInt32, "/count", 10), itertools.count()
node.create_timer(0.01, lambda: publisher.publish(UInt32(next(numbers))))
lcmtools.spin(node)
"""
_TALK = ("pub", "/chatter", "std_msgs/String", "data: hello", "-r", "20")


@pytest.fixture
def laptop(ip):
    """``ip``, on a laptop with Wi-Fi (v0), and a socket for a cable (w0) that is not plugged in."""
    ip("link", "set", "lo", "up")
    for name, number in (("v", 0), ("w", 1)):
        ip("link", "add", f"{name}0", "type", "veth", "peer", "name", f"{name}1")
        ip("addr", "add", f"10.0.{number}.1/24", "dev", f"{name}0")
        ip("link", "set", f"{name}1", "up")
    _connect(ip, "v0", 600)
    return ip


def _connect(ip, interface, metric):
    gateway = {"v0": "10.0.0.2", "w0": "10.0.1.2"}[interface]
    ip("link", "set", interface, "up")
    ip("route", "add", "default", "via", gateway, "dev", interface, "metric", str(metric))


def _plug_in(ip):
    _connect(ip, "w0", 100)


def _plug_in_and_go_away(ip):
    _connect(ip, "w0", 1000)
    ip("link", "set", "v0", "down")


def _lose_everything(ip):
    ip("link", "set", "v0", "down")


def _replace(ip):
    _lose_everything(ip)
    ip("link", "del", "v0")
    _connect(ip, "w0", 600)


CHANGES = [_plug_in, _plug_in_and_go_away, _lose_everything, _replace]
_NO_NETLINK = """
import socket


class Socket(socket.socket):
    def __init__(self, family=-1, *arguments, **named):
        if family == socket.AF_NETLINK:
            raise PermissionError(1, "Operation not permitted")
        super().__init__(family, *arguments, **named)


socket.socket = Socket
"""
"""A ``sitecustomize`` as of a sandbox."""


@pytest.fixture
def begin(start, lcmtools_path, tmp_path):
    """Starts a command on a bus, in a Python that begins with some code."""

    def begin(url, python, *words):
        (tmp_path / "sitecustomize.py").write_text(python)
        return start(lcmtools_path, *words, LCM_DEFAULT_URL=url, PYTHONPATH=str(tmp_path))

    return begin


@pytest.mark.parametrize(
    ("url", "change", "python"),
    [
        *((_URL, change, "") for change in CHANGES),
        (f"mp{_URL}", _plug_in, ""),  # liblcm sends no other way
        (_URL, _replace, _NO_NETLINK),
        (f"mp{_URL}", _plug_in, _NO_NETLINK),
    ],
)
def test_programs_go_on_hearing_each_other(laptop, begin, url, change, python):
    talker = begin(url, python, *_TALK)
    listener = begin(url, python, "run", "listener")
    echo = begin(url, python, "echo", "/chatter")
    for program in (listener, echo):
        program.wait_for("hello")
    change(laptop)
    for program in (listener, echo):
        program.wait_for("239.255.76.67")  # the line that tells the change
        for _ in range(5):
            program.wait_for("hello")
    talker.end()


def test_programs_that_start_without_a_route_hear_each_other_and_follow_the_network(laptop, begin):
    _lose_everything(laptop)
    programs = [begin(_URL, "", *words) for words in (("run", "listener"), ("echo", "/chatter"))]
    begin(_URL, "", *_TALK)
    for program in programs:
        program.wait_for("there is no route to 239.255.76.67")
        program.wait_for("hello")
    begin(_URL, "", "node", "list").wait_for("lcmtools node list: there is no route to")
    _connect(laptop, "w0", 600)
    for program in programs:
        program.wait_for("now go over w0")
        for _ in range(5):
            program.wait_for("hello")


def test_a_recorder_counts_what_a_change_has_cost(
    laptop, start, lcmtools_path, tmp_path, wait_until
):
    script, log = tmp_path / "count.py", tmp_path / "drive.lcm"
    script.write_text(_COUNTS)
    start(sys.executable, str(script), LCM_DEFAULT_URL=_URL)
    record = ("bag", "record", "/count", "-o", str(log))
    recorder = start(lcmtools_path, *record, LCM_DEFAULT_URL=_URL)
    echo = start(lcmtools_path, "echo", "/count", LCM_DEFAULT_URL=_URL)
    echo.wait_for("data")
    wait_until(lambda: log.exists() and log.stat().st_size > 0)
    _replace(laptop)
    echo.wait_for("239.255.76.67")
    for _ in range(20):
        echo.wait_for("data")
    recorder.send_signal(signal.SIGINT)
    assert recorder.wait() in (0, 130), recorder.output
    with LogFile(log) as file:
        packets = [packet for packet in file.packets() if packet.channel == "/count"]
    numbers = [UInt32.decode(packet.payload).data for packet in packets]
    assert len(numbers) > 20
    # a lost announcement counts too
    assert "; lost" in recorder.output or numbers[-1] - numbers[0] + 1 == len(numbers)
