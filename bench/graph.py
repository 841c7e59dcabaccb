"""The time until the graph is complete, after asking for it, on a bus of 20 nodes in 5 processes.

Two clocks run from the probe on: until the last node's answer has arrived at a tap (what the bus
needs), and until ``Watch.settle`` returns (what ``lcmtools list`` waits). Answers are told from the
announcements of each second by the probe's nonce. A row counts how often all nodes were there; the
ratio is to the first row's median. The second half is measured while two processes keep the
processors busy.
"""

import os
import random
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from multiprocessing.connection import Connection
from statistics import median

from common import bus, child, isolate, rounds_asked, show

import lcmtools
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Probe,
    decode_announcement,
    encode_probe,
)
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

_URL = bus(7793)
_PROCESSES = 5
_NODES = 4  # in each process
_TIMEOUT = 1.0  # [s] that answers are waited for
_BUSY = 2  # processes


def host(connection: Connection, first: int) -> None:
    """Child: some nodes that spin."""
    lcmtools.init([], url=_URL)
    nodes = [
        lcmtools.Node(f"node_{first + i}", namespace=f"/robot{first + i}") for i in range(_NODES)
    ]
    for node in nodes:
        node.create_publisher(Odometry, "odometry")
        node.create_subscription(Twist, "cmd_vel", lambda _: None)
    connection.send(None)
    lcmtools.spin(*nodes)
    lcmtools.shutdown()


def busy(connection: Connection) -> None:
    """Child: keep a processor busy."""
    connection.send(None)
    while True:
        sum(range(100_000))


def last_answer(tap: Tap, nonce: int) -> tuple[float, int]:
    """Seconds until the last node's answer to a probe, and how many answered."""
    tap.receive(0.0)
    tap.send(PROBE_CHANNEL, encode_probe(Probe(nonce=nonce)))
    start = last = time.perf_counter()
    names: set[str] = set()
    while len(names) < _PROCESSES * _NODES and time.perf_counter() < start + _TIMEOUT:
        for packet in tap.receive(0.1):
            answer = decode_announcement(packet.payload) if packet.channel == NODE_CHANNEL else None
            if answer is not None and answer.answers == nonce:
                names.add(answer.node.name)
                last = time.perf_counter()
    return last - start, len(names)


def settled() -> tuple[float, int]:
    """Seconds that ``settle`` takes, and how many nodes are in its graph."""
    with BusMonitor(parse_url(_URL), "bench", os.environ) as watch:
        start = time.perf_counter()
        graph = watch.settle(foreign=False)
        taken = time.perf_counter() - start
    return taken, sum(not node.stale for node in graph.nodes)


def row(label: str, rounds: int, measure: Callable[[], tuple[float, int]]) -> list[object]:
    """One line of the table."""
    found: list[tuple[float, int]] = []
    for _ in range(rounds):
        time.sleep(random.uniform(0.1, 0.3))  # noqa: S311 - at any point of the nodes' period
        found.append(measure())
    times = [seconds * 1000 for seconds, _ in found]
    complete = sum(count == _PROCESSES * _NODES for _, count in found)
    return [label, f"{complete}/{rounds}", median(times), max(times)]


def rows(suffix: str, rounds: int) -> Iterator[list[object]]:
    """The two lines of one half."""
    with Tap(parse_url(_URL)) as tap:
        yield row(
            f"last answer{suffix}",
            rounds,
            lambda: last_answer(tap, random.getrandbits(32)),
        )
    yield row(f"settle() returns{suffix}", rounds, settled)


@contextmanager
def nodes() -> Iterator[None]:
    """The bus with its nodes, while the block runs."""
    with ExitStack() as stack:
        for number in range(_PROCESSES):
            stack.enter_context(child(host, number * _NODES)).wait()
        time.sleep(1.0)
        yield


@contextmanager
def load() -> Iterator[None]:
    """Busy processors, while the block runs."""
    with ExitStack() as stack:
        for _ in range(_BUSY):
            stack.enter_context(child(busy)).wait()
        yield


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 20)
    isolate()
    table: list[list[object]] = []
    with nodes():
        table += rows("", rounds)
        with load():
            table += rows(f", {_BUSY} busy processes", rounds)
    show(
        f"A bus of {_PROCESSES * _NODES} nodes in {_PROCESSES} processes, {rounds} rounds",
        ["from the probe until", "complete", "median ms", "worst ms", "ratio"],
        [[*row, float(str(row[2])) / float(str(table[0][2]))] for row in table],
    )


if __name__ == "__main__":
    main()
