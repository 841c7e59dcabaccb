"""Costs and losses of recording, beside lcm-logger.

10 kHz of small messages go beside 100 MB/s of images of 1 MB, all sent by the plain package as fast
as liblcm does, in a network namespace of its own. The ways to record take turns: bag record with
the buffers that this system grants, the same with those that Linux grants everywhere (208 KiB), and
lcm-logger, which asks for no more. Shown are the share of one core and the messages that are in the
log of those that were sent.
"""

import os
import signal
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median

import lcm
from common import bus, child, isolate, parser, processor_time, show

from lcmtools.observe.reading.log_file import LogFile

_URL = bus(7799)
_IMAGE_BYTES, _IMAGE_RATE, _SMALL_BYTES, _SMALL_RATE = 1_000_000, 100, 100, 10_000
_TOGETHER = 10  # small messages at a time: a program in Python keeps up so
_USUAL = """
import sys
from lcmtools.bus import multicast
multicast.receive_buffer_bytes = lambda: 212_992
from lcmtools.__main__ import run
run()
"""
_LOGGER = str(Path(sysconfig.get_path("purelib")) / "bin" / "lcm-logger")
_RECORD = ("bag", "record", "--lcm-url", _URL, "-o")
_WAYS = {
    "bag record": (sys.executable, "-m", "lcmtools", *_RECORD),
    "bag record, 208 KiB": (sys.executable, "-c", _USUAL, *_RECORD),
    "lcm-logger": (_LOGGER, "-q", "-l", _URL),
}


def send(connection: Connection, channel: str, size: int, rate: int, together: int) -> None:
    """Child: messages until told to end; sends back how many they were."""
    instance, payload, count = lcm.LCM(_URL), bytes(size), 0
    connection.recv()
    start = time.monotonic()
    while not connection.poll():
        for _ in range(together):
            instance.publish(channel, payload)
        count += together
        time.sleep(max(0.0, start + count / rate - time.monotonic()))
    connection.send(count)


@contextmanager
def recording(command: tuple[str, ...], path: Path) -> Iterator[int]:
    """Record into a file while the block runs; yields the process's number."""
    with subprocess.Popen([*command, str(path)], stderr=subprocess.DEVNULL) as recorder:
        while not path.exists():
            time.sleep(0.01)
        time.sleep(0.5)
        try:
            yield recorder.pid
        finally:
            recorder.send_signal(signal.SIGINT)


def measure(command: tuple[str, ...], seconds: float, folder: Path) -> tuple[float, float, float]:
    """Return the share of a core, and those of the small messages and images in the log."""
    path = folder / "bench.lcmlog"
    with (
        child(send, "SMALL", _SMALL_BYTES, _SMALL_RATE, _TOGETHER) as small,
        child(send, "IMAGE", _IMAGE_BYTES, _IMAGE_RATE, 1) as images,
        recording(command, path) as pid,
    ):
        used, start = processor_time(pid), time.monotonic()
        for sender in (small, images):
            sender.connection.send(None)
        time.sleep(seconds)
        share = (processor_time(pid) - used) / (time.monotonic() - start)
        for sender in (small, images):
            sender.connection.send(None)
        sent = {"SMALL": small.wait(), "IMAGE": images.wait()}
        time.sleep(0.5)
    counts = dict.fromkeys(sent, 0)
    with LogFile(path) as log:
        for event in log.events():
            counts[event.channel] = counts.get(event.channel, 0) + 1
    for file in folder.iterdir():
        file.unlink()
    small_share, image_share = (counts[name] / int(str(sent[name])) for name in sent)
    return share, small_share, image_share


def main() -> None:
    """Measure the ways in turns and print a table."""
    arguments = parser(__doc__)
    arguments.add_argument("-r", "--runs", type=int, default=3, help="turns (3)")
    arguments.add_argument("-s", "--seconds", type=float, default=4.0, help="of each turn (4)")
    chosen = arguments.parse_args()
    if not isolate():
        return  # such a load is for a network of one's own
    found: dict[str, list[tuple[float, float, float]]] = {way: [] for way in _WAYS}
    os.environ.pop("LCM_DEFAULT_URL", None)
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(chosen.runs):
            for way, command in _WAYS.items():
                found[way].append(measure(command, chosen.seconds, Path(folder)))
    rows = [
        [way, *(f"{100 * median(column):.2f} %" for column in zip(*one, strict=True))]
        for way, one in found.items()
    ]
    show(
        "10 kHz of small messages beside 100 MB/s of images",
        ("way", "of a core", "small recorded", "images recorded"),
        rows,
    )


if __name__ == "__main__":
    main()
