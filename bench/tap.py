"""The cost of watching a bus full of images.

1 kHz of small messages go beside 100 MB/s of images of 1 MB, in a network namespace of its own. The
tap watches them, and the graph is learned from what it sees, as ``lcmtools list`` and ``hz`` do it:
heads only with the kernel's filter, the same without the filter, and whole messages. The ways take
turns. Shown are the watcher's share of one core, the share of the small messages that it saw, and
how exactly it knew the images' bandwidth.
"""

import time
from multiprocessing.connection import Connection
from statistics import median

import lcm
from common import bus, child, every, isolate, parser, show

from lcmtools.bus import group_receiver
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.graph.builder import GraphBuilder
from lcmtools.wire.datagram import fragments

_URL = bus(7798)
_IMAGE_BYTES, _IMAGE_RATE = 1_000_000, 100.0
_SMALL_BYTES, _SMALL_RATE = 100, 1000.0
_SECONDS = 3.0
_UNFILTERED = "heads, no filter"
_WAYS = {
    "heads, kernel's filter": {},
    _UNFILTERED: {},
    "whole messages": {"whole": True},
}


def send_small(connection: Connection) -> None:
    """Child: small messages by the plain package until told to end."""
    instance, payload = lcm.LCM(_URL), bytes(_SMALL_BYTES)
    connection.send(None)
    for _ in every(1 / _SMALL_RATE, 1e6):
        if connection.poll():
            return
        instance.publish("SMALL", payload)


def send_images(connection: Connection) -> None:
    """Child: large messages, their fragments made once, until told to end."""
    import socket

    url = parse_url(_URL)
    parts = list(fragments(0, "IMAGE", bytes(_IMAGE_BYTES)))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        connection.send(None)
        for number in every(1 / _IMAGE_RATE, 1e6):
            if connection.poll():
                return
            for part in parts:
                numbered = part[:4] + number.to_bytes(4, "big") + part[8:]
                sender.sendto(numbered, (url.host, url.port))


def watch(connection: Connection, way: str) -> None:
    """Child: look for some seconds; the share of a core, and messages and bytes of both."""
    builder = GraphBuilder()
    if way == _UNFILTERED:
        group_receiver.attach = lambda *_: False  # type: ignore[attr-defined]
    with Tap(parse_url(_URL), **_WAYS[way]) as tap:
        start, used = time.monotonic(), time.process_time()
        while (left := start + _SECONDS - time.monotonic()) > 0:
            for packet in tap.receive(left):
                builder.add(packet)
        share = (time.process_time() - used) / (time.monotonic() - start)
    seen = {traffic.channel: traffic for traffic in builder.snapshot(0).traffic}
    small, images = seen["SMALL"].messages / (_SMALL_RATE * _SECONDS), seen["IMAGE"].bytes
    connection.send((share, small, images / (_IMAGE_BYTES * _IMAGE_RATE * _SECONDS)))


def main() -> None:
    """Measure the ways in turns and print a table."""
    arguments = parser(__doc__)
    arguments.add_argument("-r", "--runs", type=int, default=3, help="turns (3)")
    runs = arguments.parse_args().runs
    if not isolate():
        return  # such a load is for a network of one's own
    results: dict[str, list[tuple[float, float, float]]] = {way: [] for way in _WAYS}
    with child(send_small) as small, child(send_images) as images:
        small.wait()
        images.wait()
        for _ in range(runs):
            for way, found in results.items():
                with child(watch, way) as watcher:
                    found.append(watcher.wait())
        for sender in (small, images):
            sender.connection.send(None)
    rows = [
        [way, *(f"{100 * median(c):.1f} %" for c in zip(*found, strict=True))]
        for way, found in results.items()
    ]
    show(
        "1 kHz of small messages beside 100 MB/s of images",
        ("way", "of a core", "small seen", "image bytes"),
        rows,
    )


if __name__ == "__main__":
    main()
