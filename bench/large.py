"""The arrival of large messages at receivers that have the system's own receive buffer.

Messages of 1 MB at 30 Hz go to two receivers of the plain ``lcm`` package, opened as its users do:
sent by the plain package (liblcm sends all fragments in one burst) and by an lcmtools node (which
paces them). The senders take turns. Shown is the share that arrived, over both receivers, and how
much of one core the sender used.
"""

import os
import time
from collections.abc import Callable
from contextlib import ExitStack
from multiprocessing.connection import Connection
from statistics import median

import lcm
from common import bus, child, every, isolate, rounds_asked, show

import lcmtools
from lcmtools.types.sensor_msgs import Image

_URL = bus(7797)
_TOPIC = "/measured"
_SIZE = 1_000_000  # [bytes]
_RATE = 30.0  # [Hz]
_MODEST_RATE = 5.0  # [Hz] on a network that is not this script's own
_SECONDS = 2.0  # that a run lasts
_RECEIVERS = 2
_GAP = 0.3  # [s] between the last large message and the small one that ends a run


def receive(connection: Connection) -> None:
    """Child: the plain package, as it is, counts large messages until a small one."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # liblcm's warning about the buffer, each time
    sizes: list[int] = []
    instance = lcm.LCM(_URL)
    instance.subscribe(_TOPIC, lambda _, data: sizes.append(len(data)))
    connection.send(None)
    while not sizes or sizes[-1] == _SIZE:
        instance.handle_timeout(1000)
    connection.send(sizes.count(_SIZE))


def send_plainly(connection: Connection, rate: float) -> None:
    """Child: the plain package sends."""
    instance = lcm.LCM(_URL)
    connection.send(send_all(lambda payload: instance.publish(_TOPIC, payload), rate))


def send_as_node(connection: Connection, rate: float) -> None:
    """Child: an lcmtools node sends."""
    lcmtools.init([], url=_URL)
    publisher = lcmtools.Node("sender").create_publisher(Image, _TOPIC)
    connection.send(send_all(publisher.publish_payload, rate))
    lcmtools.shutdown()


def send_all(send: Callable[[bytes], None], rate: float) -> float:
    """Send large messages, then the small one; return the share of a core that it took."""
    payload = bytes(_SIZE)
    before = time.process_time()
    for _ in every(1 / rate, _SECONDS):
        send(payload)
    time.sleep(_GAP)
    used = time.process_time() - before
    for _ in range(3):  # one may be lost
        send(b"end")
        time.sleep(_GAP / 3)
    return used / _SECONDS


def run(sender: Callable[[Connection, float], None], rate: float) -> tuple[float, float]:
    """Send once; the share that arrived, and the sender's share of a core."""
    with ExitStack() as stack:
        receivers = [stack.enter_context(child(receive)) for _ in range(_RECEIVERS)]
        for one in receivers:
            one.wait()
        used = stack.enter_context(child(sender, rate)).wait()
        arrived = sum(int(str(one.wait())) for one in receivers)
    return arrived / (_RECEIVERS * round(_SECONDS * rate)), float(str(used))


def main() -> None:
    """Measure and print."""
    runs = rounds_asked(__doc__, 5)
    rate = _RATE if isolate() else _MODEST_RATE
    senders = {"plain lcm": send_plainly, "lcmtools": send_as_node}
    found: dict[str, list[tuple[float, float]]] = {label: [] for label in senders}
    for _ in range(runs):
        for label, sender in senders.items():
            found[label].append(run(sender, rate))
    rows: list[list[object]] = []
    for label, results in found.items():
        arrived = [100 * share for share, _ in results]
        rows.append([label, median(arrived), min(arrived), median(100 * cpu for _, cpu in results)])
    show(
        f"{_SIZE / 1e6:g} MB at {rate:g} Hz to {_RECEIVERS} default receivers, {runs} runs",
        ["sender", "arrived %", "worst %", "sender's CPU %"],
        rows,
    )


if __name__ == "__main__":
    main()
