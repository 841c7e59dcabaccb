"""The window's server: processor time and memory while pages look at a robot.

A child publishes, at 30 Hz, the odometry (Odometry), the laser (LaserScan of 360 beams) and the
camera of a robot. Pages plot four numbers of the first two and show the camera: as files of 20 kB,
as raw depth of 614 kB, or as colour of 8 MB, of which a page of this size is given every third
pixel. A page is a WebSocket client that reads all; a slow one reads nothing for the whole while.
Shown is the share of a core that the server takes, images per second at a page, and how much its
memory grows from one half of the while to the other.
"""

import asyncio
import json
import os
import re
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path

from commands import TOOL, child_environment, end, start
from common import bus, child, every, isolate, processor_time, rounds_asked, show
from websockets.asyncio.client import connect
from websockets.typing import Origin, Subprotocol

from lcmtools.bus.open import open_bus
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import encode
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import CompressedImage, Image, LaserScan

_PORT = 7794
_RATE = 30.0  # [Hz]
_GOAL = 15.0  # [% of a core] with one page and the camera's files
_SECONDS = 4.0  # that a load is measured
_SETTLING = 2.0  # [s]
_WINDOW_PIXELS = 300_000  # that a page shows
_FIELDS = (
    "/odometry/twist.twist.linear.x",
    "/odometry/pose.pose.position",
)
_CAMERAS = {"file, 20 kB": 20_000, "depth, 614 kB": 614_400, "colour, 8 MB": 8_294_400}


def robot(connection: Connection, camera: str) -> None:
    """Child: publishes a robot's messages until it is ended."""
    bus_ = open_bus(parse_url(bus(_PORT)))
    scan = LaserScan()
    scan.ranges, scan.ranges_length = [1.0] * 360, 360
    fixed = {"/scan": encode(scan), "/camera": encode(_image(camera))}
    odometry = Odometry()
    connection.send(None)
    for count in every(1 / _RATE, 3600):
        odometry.twist.twist.linear.x = count / 100
        for topic, payload in {**fixed, "/odometry": encode(odometry)}.items():
            bus_.publish(topic, payload)


def _image(camera: str) -> Image | CompressedImage:
    size = _CAMERAS[camera]
    if camera.startswith("file"):
        file = CompressedImage()
        file.format, file.data, file.data_length = "jpeg", b"\xff\xd8\xff" + bytes(size), size + 3
        return file
    image = Image()
    image.encoding, pixel = ("16UC1", 2) if camera.startswith("depth") else ("rgb8", 3)
    image.height = {614_400: 480, 8_294_400: 1440}[size]
    image.width = size // pixel // image.height
    image.step = image.width * pixel
    image.data, image.data_length = bytes(size), size
    return image


def page(connection: Connection, port: int, *, is_slow: bool) -> None:
    """Child: a page, which reads all, or nothing; tells how many images have come, when asked."""
    asyncio.run(_page(connection, port, is_slow=is_slow))


async def _page(connection: Connection, port: int, *, is_slow: bool) -> None:
    address = f"127.0.0.1:{port}"
    async with connect(
        f"ws://{address}/socket",
        origin=Origin(f"http://{address}"),
        subprotocols=[Subprotocol("lcmtools.1")],
        compression=None,
        max_size=None,
    ) as socket:
        plot = {"stream": "plot", "fields": _FIELDS}
        laser = {"stream": "plot", "fields": ["/scan/ranges[0:5]"]}
        image = {"stream": "image", "topic": "/camera", "pixels": _WINDOW_PIXELS}
        for number, stream in enumerate((plot, laser, image)):
            await socket.send(json.dumps({"op": "open", "id": number, **stream}))
        connection.send(None)
        count = 0
        while not connection.poll():
            if is_slow:
                await asyncio.sleep(0.1)
                continue
            frame = await socket.recv()
            count += isinstance(frame, bytes) and b'"encoding"' in frame[:400]
        connection.send(count)


@contextmanager
def server() -> Iterator[tuple[int, int]]:
    """The window's server, while the block runs: its process and its TCP port."""
    with tempfile.TemporaryDirectory() as folder:
        output = f"{folder}/output"
        words = [TOOL, "gui", "all", "--port", "0", "--no-open", "--json"]
        pid = start(words, child_environment(folder, _PORT), output)
        try:
            while not (found := re.search(r":(\d+)/", Path(output).read_text())):
                time.sleep(0.01)
            yield pid, int(found[1])
        finally:
            end(pid)


def measure(camera: str, *, pages: int, is_slow: bool = False) -> tuple[float, float, float]:
    """Return the share of a core [%], images per second at a page, and growth of memory [MB]."""
    with child(robot, camera) as sender, server() as (pid, port):
        sender.wait()
        time.sleep(_SETTLING)
        with _pages(port, pages, is_slow=is_slow) as opened:
            time.sleep(_SETTLING)
            begin, before = time.monotonic(), processor_time(pid)
            time.sleep(_SECONDS / 2)
            half = _memory(pid)
            time.sleep(_SECONDS / 2)
            growth = _memory(pid) - half
            share = (processor_time(pid) - before) / (time.monotonic() - begin)
            opened.send(None)
            received = opened.recv()
    return 100 * share, received / (_SECONDS + _SETTLING), growth


@contextmanager
def _pages(port: int, count: int, *, is_slow: bool) -> Iterator[Connection]:
    """Open pages; yield the connection to the last one."""
    with child(page_of, port, is_slow) as one:
        one.wait()
        if count == 1:
            yield one.connection
        else:
            with _pages(port, count - 1, is_slow=is_slow) as last:
                yield last


def page_of(connection: Connection, port: int, is_slow: bool) -> None:  # noqa: FBT001 - child's
    """Child: as ``page``."""
    page(connection, port, is_slow=is_slow)


def _memory(pid: int) -> float:
    """The memory that a process holds [MB]."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6


def main() -> None:
    """Print the table."""
    rounds = rounds_asked(__doc__, 3)
    isolate()
    loads = [(camera, 1, False) for camera in _CAMERAS]
    loads += [("file, 20 kB", 10, False), ("depth, 614 kB", 1, True)]
    rows = []
    for camera, pages, is_slow in loads:
        found = [measure(camera, pages=pages, is_slow=is_slow) for _ in range(rounds)]
        share, rate, growth = min(found)
        goal = f"{_GOAL:.0f}" if (camera, pages) == ("file, 20 kB", 1) else ""
        what = f"{camera}; {pages} {'slow ' * is_slow}page{'s' * (pages > 1)}"
        rows.append((what, share, goal, rate, growth))
    columns = ("camera", "server [% of a core]", "goal", "images [Hz]", "memory grows [MB]")
    show("odometry, laser and camera at 30 Hz; the best of the rounds", columns, rows)


if __name__ == "__main__":
    main()
