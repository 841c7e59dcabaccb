"""The processor share of the window's server, and the time to a page's first picture.

A robot sends its odometry, frames, a laser scan of 640 beams and a raw camera image of 320x240 at
30 Hz. One page after the other is added until there are ten; each has what a view has open: the
topics, three curves, the image, the scan and the frames. Shown are the share of a core that the
server takes beside its share without a page, the frames that a page gets a second, and how long it
takes from the connection to the first rows of the topics. The goal is 15 % with one page. Then the
share of a core that the lab's simulator takes more while a page shows its world; the goal is 10 %.
"""

import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing.connection import Connection
from urllib.parse import urlsplit

import lcm
from common import bus, child, every, isolate, parser, processor_time, show
from websockets.sync.client import ClientConnection, connect

from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import Image, LaserScan
from lcmtools.types.tf2_msgs import TFMessage

PORT = 7803
_URL = bus(PORT)
_RATE, _WIDTH, _HEIGHT, _BEAMS = 30.0, 320, 240, 640
_SECONDS = 5.0
_STREAMS = (
    ("topics", {}),
    ("plot", {"fields": [f"/odom/pose.pose.position.{axis}" for axis in "xyz"]}),
    ("image", {"topic": "/camera"}),
    ("newest", {"topic": "/scan"}),
    ("frames", {"topic": "/tf"}),
)
_WORLD = (
    ("drawable", {}),
    ("frames", {"topic": "/morse/poses"}),
    ("markers", {"topic": "/morse/world"}),
    ("newest", {"topic": "/husky0/odometry"}),
)


def robot(connection: Connection) -> None:
    """Child: the robot."""
    image = draft(Image, {"height": _HEIGHT, "width": _WIDTH, "encoding": "rgb8"}).message
    image.step, image.data = 3 * _WIDTH, os.urandom(3 * _WIDTH * _HEIGHT)
    scan = draft(LaserScan, {"ranges": [2.0] * _BEAMS, "range_max": 9.0}).message
    frame = draft(TransformStamped, {"header": {"frame_id": "odom"}, "child_frame_id": "base"})
    frames = TFMessage()
    frames.transforms = [frame.message]
    payloads = {
        "/camera": encode(image),
        "/scan": encode(scan),
        "/tf": encode(frames),
        "/odom": encode(Odometry()),
    }
    instance = lcm.LCM(_URL)
    connection.send(None)
    for _ in every(1 / _RATE, 1e6):
        for channel, payload in payloads.items():
            instance.publish(channel, payload)


Streams = Sequence[tuple[str, Mapping[str, object]]]


class Viewer:
    """A page that reads what comes, on a thread of its own."""

    def __init__(self, socket: ClientConnection, streams: Streams) -> None:
        self.frames: Counter[int] = Counter()
        self.first_picture = 0.0
        self._socket = socket
        self._start = time.monotonic()
        for number, (stream, parameters) in enumerate(streams):
            request = {"op": "open", "id": number, "stream": stream, **parameters}
            socket.send(json.dumps(request))
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for data in self._socket:
            if isinstance(data, bytes):
                length = int.from_bytes(data[:4], "little")
                self.frames[json.loads(data[4 : 4 + length])["id"]] += 1
            elif "id" in (frame := json.loads(data)) and "data" in frame:
                self.frames[frame["id"]] += 1
                if not self.first_picture and frame["data"].get("rows"):
                    self.first_picture = time.monotonic() - self._start


@contextmanager
def view(address: str, streams: Streams) -> Iterator[Viewer]:
    """A page at a window's address, for a moment already."""
    parts = urlsplit(address)
    with connect(
        f"ws://{parts.netloc}/socket?{parts.query}",
        origin=f"http://{parts.netloc}",  # type: ignore[arg-type] # a str by another name
        subprotocols=["lcmtools.1"],  # type: ignore[list-item]
        compression=None,
        max_size=None,
        close_timeout=0.1,
    ) as socket:
        viewer = Viewer(socket, streams)
        time.sleep(1.0)
        yield viewer


@contextmanager
def server() -> Iterator[tuple[int, str]]:
    """The window's process, and its address."""
    with running("gui", "--port", "0", "--no-open", "--json", until="}") as (pid, text):
        yield pid, json.loads(text)["command"]


@contextmanager
def running(*words: str, until: str) -> Iterator[tuple[int, str]]:
    """A command on the bus, and what it has written until it is ready."""
    command = (sys.executable, "-m", "lcmtools", *words, "--lcm-url", _URL)
    piped, errors = subprocess.PIPE, subprocess.STDOUT
    process = subprocess.Popen(command, stdout=piped, stderr=errors, text=True)
    try:
        text = ""
        while until not in text:
            assert process.stdout is not None
            text += process.stdout.readline()
        yield process.pid, text
    finally:
        process.terminate()
        process.wait(10)


def share(pid: int) -> float:
    """The share of a core that a process takes for some seconds [%]."""
    start, used = time.monotonic(), processor_time(pid)
    time.sleep(_SECONDS)
    return 100 * (processor_time(pid) - used) / (time.monotonic() - start)


def with_a_page() -> tuple[float, float]:
    """The server's share with one page of the robot, and without [%]."""
    with child(robot) as sender, server() as (pid, address):
        sender.wait()
        alone = share(pid)
        with view(address, _STREAMS):
            return share(pid), alone


def simulated() -> tuple[float, float]:
    """The simulator's share while a page shows its world, and without [%]."""
    with running("run", "sim", until="simulating") as (pid, _), server() as (_, address):
        alone = share(pid)
        with view(address, _WORLD):
            return share(pid), alone


def main() -> None:
    """Measure and print."""
    parser(__doc__).parse_args()
    isolate()
    rows: list[list[object]] = []
    with child(robot) as sender, server() as (pid, address), ExitStack() as stack:
        sender.wait()
        rows.append(["without a page", share(pid), "", ""])
        viewers: list[Viewer] = []
        for count in (1, 2, 5, 10):
            while len(viewers) < count:
                viewers.append(stack.enter_context(view(address, _STREAMS)))
            viewers[0].frames.clear()
            taken = share(pid)
            frames = "/".join(
                f"{viewers[0].frames[n] / _SECONDS:.0f}" for n in range(len(_STREAMS))
            )
            slowest = max(viewer.first_picture for viewer in viewers)
            rows.append([f"{count} pages" if count > 1 else "1 page", taken, frames, slowest])
    streams = "/".join(name for name, _ in _STREAMS)
    show(
        f"lcmtools gui at {_RATE:g} Hz", ["", "% of a core", f"Hz of {streams}", "first [s]"], rows
    )
    shown, alone = simulated()
    show("The simulator", ["", "% of a core"], [["alone", alone], ["with a page", shown]])


if __name__ == "__main__":
    main()
