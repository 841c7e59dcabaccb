"""Programs do not grow in months: a healthy bus a hundred times faster, names without end.

Each test takes some seconds; ENDURE_SECONDS=600 makes the first one take ten minutes.
"""

import os
import pty
import signal
import socket
import struct
import subprocess
import termios
import threading
import time
from contextlib import contextmanager, suppress
from fcntl import ioctl
from itertools import count
from pathlib import Path

import pytest

from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import Imu, LaserScan
from lcmtools.types.std_msgs import String
from lcmtools.wire.datagram import datagrams

SECONDS = float(os.environ.get("ENDURE_SECONDS", "20"))
_GROUP = ("239.255.76.67", 7667)
_RATE = 3000  # messages per second, a hundred times those of a robot
_MOST_OF_NAMES = 20_000_000  # bytes
_MOST_OF_TIME = 6_000_000  # bytes between two times; a buffer for many datagrams has 4 MB
_READER = """
from lcmtools import Node, init, ok, spin_once
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import String
init()
node = Node("reader")
node.create_subscription(String, "/chatter", lambda message: None)
node.create_subscription(LaserScan, "/scan", lambda message: None)
while ok():
    spin_once(node)
"""


def _memory(pid):
    text = Path(f"/proc/{pid}/statm").read_text(encoding="ascii")
    return int(text.split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _healthy():
    """Datagrams of a robot, without end."""
    text = String()
    text.data = "hello world"
    values = [
        ("/chatter", encode(text)),
        ("/scan", encode(LaserScan())),
        ("/imu", encode(Imu())),
        ("/cmd_vel", encode(Twist())),
    ]
    for number in count():
        channel, payload = values[number % len(values)]
        yield from datagrams(number, channel, payload)


def _names(most):
    """Datagrams on so many channels in turn, without end."""
    for number in count():
        yield from datagrams(number, f"/svc/reply_{number % most}", bytes(40))


def _send(source, seconds):
    start = time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for number, datagram in enumerate(source):
            sender.sendto(datagram, _GROUP)
            if (late := number / _RATE - (time.monotonic() - start)) > 0.002:
                time.sleep(late)
            if time.monotonic() - start > seconds:
                return


@contextmanager
def spy(command):
    """A spy in a terminal of 40 lines: its process, and what it has written."""
    screen, end = pty.openpty()
    ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
    program = subprocess.Popen(
        ["setsid", "--ctty", command, "spy"],  # noqa: S607
        stdin=end,
        stdout=end,
        stderr=end,
        env={**os.environ, "TERM": "xterm-256color"},
    )
    os.close(end)
    written = bytearray()
    reader = threading.Thread(target=_read_all, args=[screen, written])
    reader.start()
    try:
        yield program.pid, written
        program.send_signal(signal.SIGINT)
        assert program.wait(10) == 130
    finally:
        program.kill()
        program.wait()
        reader.join()
        os.close(screen)


def _read_all(screen, written):
    with suppress(OSError):  # the program has ended
        while data := os.read(screen, 1 << 16):
            written += data


@pytest.mark.usefixtures("private_network")
def test_programs_of_a_healthy_bus_stay_as_they_are(start, start_python, lcmtools_path, tmp_path):
    log = str(tmp_path / "a.lcmlog")
    programs = {
        "node": start_python(_READER),
        "record": start(lcmtools_path, "bag", "record", "-o", log, "--split", "20MB"),
        "sim": start(lcmtools_path, "run", "sim", "--rate", "5"),
        "wtf": start(lcmtools_path, "wtf", "--watch"),
    }
    with spy(lcmtools_path) as (pid, _):
        pids = {name: program.pid for name, program in programs.items()} | {"spy": pid}
        source = _healthy()
        _send(source, SECONDS)  # each imports, and fills its bounded windows
        before = {name: _memory(one) for name, one in pids.items()}
        _send(source, SECONDS)
        grown = {name: _memory(one) - before[name] for name, one in pids.items()}
    assert {name: size for name, size in grown.items() if size > _MOST_OF_TIME} == {}
    for name, program in programs.items():
        program.send_signal(signal.SIGINT)
        assert program.wait() in (0, 1, 130), name
        assert "Traceback" not in program.output, name


@pytest.mark.usefixtures("private_network")
def test_names_without_end_cost_a_view_little(lcmtools_path, wait_until):
    few = _names(500)
    with spy(lcmtools_path) as (pid, written):

        def is_seen():
            _send(few, 0.2)
            return b"500 channels" in written

        wait_until(is_seen)
        _send(few, 4.0)  # it draws a few times, and fills its caches
        before = _memory(pid)
        _send(_names(25_000), 25_000 / _RATE)
        assert _memory(pid) - before < _MOST_OF_NAMES
