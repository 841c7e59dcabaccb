"""A relay and the tcpq server beside their rivals: latency, throughput, processor share.

Plain ``lcm`` programs send and receive: on one udpm bus, through a relay between two, through
``lcmtools relay --serve``, and through the server of lcm.jar, where Java is installed. Figures are
medians of the rounds, in which the ways take turns: messages of 100 bytes at 1000 Hz (one-way
latency, share of a core that the relay or server takes), and 20,000 at 10,000 Hz (share that
arrived). Both buffers are as large as the system grants.

A relay computes for some 60 us a message. Where sender, relay and receiver together want more than
the cores that there are, as at 10,000 Hz on two, a message waits for a processor, nearly all of its
time before the relay reads it: at 5,000 Hz, where they just fit, its median is a few times that at
1000 Hz, and neither batches nor the pause of the tap (0.2 ms) account for more.
"""

import shutil
import socket
import struct
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import NamedTuple

import lcm
from common import bus, child, every, isolate, processor_time, quantile, rounds_asked, show

_HERE, _THERE = bus(7801, recv_buf_size=4_000_000), bus(7802, recv_buf_size=4_000_000)
_OURS, _JAVA = 7803, 7804
_JAR = Path(sysconfig.get_path("purelib")) / "share/java/lcm.jar"
_STREAMS = ((1000.0, 2.0), (10_000.0, 2.0))  # rate [Hz], duration [s]
_BYTES = 100
_LAST = b"last"


class Way(NamedTuple):
    """A way from sender to receiver, and the program between them."""

    name: str
    sends_to: str
    receives_from: str
    command: Sequence[str] = ()


def _ways() -> list[Way]:
    lcmtools = [sys.executable, "-m", "lcmtools"]
    ours, java = f"tcpq://127.0.0.1:{_OURS}", f"tcpq://127.0.0.1:{_JAVA}"
    found = [
        Way("udpm", _HERE, _HERE),
        Way("udpm, relay, udpm", _HERE, _THERE, [*lcmtools, "relay", _HERE, _THERE]),
        Way("relay --serve tcpq", ours, ours, [*lcmtools, "relay", "--serve", f"tcpq://:{_OURS}"]),
    ]
    if shutil.which("java") and _JAR.exists():
        service = ["java", "-cp", str(_JAR), "lcm.lcm.TCPService", str(_JAVA)]
        found.append(Way("lcm.jar's tcpq server", java, java, service))
    return found


@contextmanager
def _running(command: Sequence[str]) -> Iterator[int]:
    """The process between sender and receiver; 0 for none."""
    if not command:
        yield 0
        return
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdout=quiet, stderr=quiet) as process:
        time.sleep(2.5)  # a relay listens for others before it carries
        try:
            yield process.pid
        finally:
            process.terminate()


def receive(connection: Connection, url: str) -> None:
    """Receive streams and report the latencies of each, for ever."""
    times: list[float] = []
    ends: list[bool] = []

    def take(_channel: str, payload: bytes) -> None:
        if payload == _LAST:
            ends.append(True)
        else:
            times.append(time.monotonic() - struct.unpack_from("8xd", payload)[0])

    instance = lcm.LCM(url)
    instance.subscribe("A", take).set_queue_capacity(0)
    connection.send("ready")
    while True:
        while not ends:
            instance.handle_timeout(1000)
        connection.send(times[:])
        times.clear()
        ends.clear()


def _measure(way: Way) -> list[float]:
    """The figures of one way: latencies [us], share of a core [%], share that arrived [%]."""
    figures: list[float] = []
    with ExitStack() as stack:
        pid = stack.enter_context(_running(way.command))
        receiver = stack.enter_context(child(receive, way.receives_from))
        receiver.wait()
        sender = lcm.LCM(way.sends_to)
        time.sleep(0.3)  # the server takes the subscription when it gets to it
        for rate, seconds in _STREAMS:
            before, begin = processor_time(pid) if pid else 0.0, time.monotonic()
            count = round(rate * seconds)
            for _ in every(1 / rate, seconds):
                sender.publish("A", struct.pack("8xd", time.monotonic()).ljust(_BYTES))
            spent = (processor_time(pid) - before if pid else 0.0) / (time.monotonic() - begin)
            time.sleep(0.3)
            sender.publish("A", _LAST)
            times = receiver.wait()
            assert isinstance(times, list)
            figures += [
                *(1e6 * quantile(times, share) for share in (0.5, 0.99)),
                100 * spent,
                100 * len(times) / count,
            ]
    return figures


def main() -> None:
    """Measure all ways in turns."""
    rounds = rounds_asked(__doc__, 5)
    isolate()
    ways = _ways()
    found: dict[str, list[list[float]]] = {way.name: [] for way in ways}
    for _ in range(rounds):
        for way in ways:
            found[way.name].append(_measure(way))
    columns = [
        "way",
        *(
            f"{one} at {r:g} Hz"
            for r, _ in _STREAMS
            for one in ("p50 us", "p99 us", "core %", "arrived %")
        ),
    ]
    rows = [[name, *map(median, zip(*figures, strict=True))] for name, figures in found.items()]
    show(f"{_BYTES} bytes, {rounds} rounds, {socket.gethostname()}", columns, rows)


if __name__ == "__main__":
    main()
