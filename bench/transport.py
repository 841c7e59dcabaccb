"""Latency and throughput: lcmtools' nodes beside the plain ``lcm`` package with lcm-gen's code.

Each stream goes from one process to another, timed from before a message is encoded until after it
is decoded: at a fixed rate (share that arrived, one-way latency, processor time for a message on
each side), then as fast as it can be published. All sides keep up to 1000 messages waiting, and
open the bus as they do by themselves (lcmtools asks for a larger receive buffer). The sides take
turns; figures are medians of the rounds, ratios are lcmtools' figure by the plain package's, and
that on Zenoh by that on udpm. Flat out, a node shares the processors with its own ear: it listens
to its bus, while a plain publisher does not.
"""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from statistics import median

import lcm
from common import bus, child, every, isolate, quantile, rounds_asked, show

import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan

Sample = Twist | Odometry | LaserScan

_URL = bus(7796)
_ZENOH = "zenoh://224.0.0.224:7796"
_TOPIC = "/measured"
_WAITING = 1000  # messages
_SECONDS = 1.0  # that a stream lasts
_FLAT_OUT = 100_000  # messages
_MODEST_RATE = 100.0  # [Hz]: the most, on a network that is not this script's own
_GAP = 0.15  # [s] between a stream and the message that ends it


@dataclass(frozen=True, slots=True)
class Stream:
    """A stream: its type, number of messages, and rate [Hz], None for flat out."""

    kind: type[Sample]
    messages: int
    rate: float | None

    def __str__(self) -> str:
        """As the table names it."""
        return f"{self.kind.__name__} {f'at {self.rate:g} Hz' if self.rate else 'flat out'}"

    def turns(self) -> Iterable[int]:
        """The turns to publish, at the stream's rate."""
        if self.rate is None:
            return range(self.messages)
        return every(1 / self.rate, self.messages / self.rate)


@dataclass(frozen=True, slots=True)
class Result:
    """The outcome of a stream: messages a second as published, share arrived, costs [s]."""

    rate: float
    arrived: float
    latencies: list[float]
    sent_in: float  # processor time of the sender for a message, without the loop's own [s]
    received_in: float  # processor time of the receiver for a message [s]


class Ear:
    """Takes messages until the one that ends the stream."""

    def __init__(self) -> None:
        self.latencies: list[float] = []
        self.ended = False
        self._began = 0.0

    def hear(self, message: Sample) -> None:
        """Note how old a message is."""
        sent = time_in(message)
        if sent:
            self._began = self._began or time.process_time()
            self.latencies.append(time.monotonic() - sent)
        else:
            self.ended = True

    def result(self) -> tuple[list[float], float]:
        """The latencies, and the processor time for each message but the first."""
        return self.latencies, (time.process_time() - self._began) / max(1, len(self.latencies) - 1)


def set_time(message: Sample, now: int) -> None:
    """Note a time [ns] in a message; 0 ends the stream."""
    if isinstance(message, Twist):
        message.linear.x = now / 1e9
    else:
        stamp = message.header.stamp
        stamp.sec, stamp.nsec = divmod(now, 1_000_000_000)


def time_in(message: Sample) -> float:
    """The time in a message [s]."""
    if isinstance(message, Twist):
        return message.linear.x
    return message.header.stamp.sec + message.header.stamp.nsec / 1e9


def receive_as_node(connection: Connection, kind: type[Sample], url: str = _URL) -> None:
    """Child: an lcmtools node receives a stream."""
    lcmtools.init([], url=url)
    ear = Ear()
    node = lcmtools.Node("receiver")
    node.create_subscription(kind, _TOPIC, ear.hear, _WAITING)  # type: ignore[arg-type] # its kind
    connection.send(None)
    while not ear.ended:
        lcmtools.spin_once(node, 1.0)
    connection.send(ear.result())
    lcmtools.shutdown()


def receive_plainly(connection: Connection, kind: type[Sample]) -> None:
    """Child: the plain package receives a stream."""
    ear = Ear()
    instance = lcm.LCM(_URL)
    subscription = instance.subscribe(_TOPIC, lambda _, data: ear.hear(kind.decode(data)))
    subscription.set_queue_capacity(_WAITING)
    connection.send(None)
    while not ear.ended:
        instance.handle_timeout(1000)
    connection.send(ear.result())


def receive_on_zenoh(connection: Connection, kind: type[Sample]) -> None:
    """Child: the same on Zenoh."""
    receive_as_node(connection, kind, _ZENOH)


def send_as_node(connection: Connection, stream: Stream, url: str = _URL) -> None:
    """Child: an lcmtools node publishes a stream."""
    lcmtools.init([], url=url)
    publisher = lcmtools.Node("sender").create_publisher(stream.kind, _TOPIC)
    connection.send(publish(stream, publisher.publish))
    lcmtools.shutdown()


def send_on_zenoh(connection: Connection, stream: Stream) -> None:
    """Child: the same on Zenoh."""
    send_as_node(connection, stream, _ZENOH)


def send_plainly(connection: Connection, stream: Stream) -> None:
    """Child: the plain package publishes a stream."""
    instance = lcm.LCM(_URL)
    connection.send(publish(stream, lambda message: instance.publish(_TOPIC, message.encode())))


def publish(stream: Stream, send: Callable[[Sample], None]) -> tuple[float, float]:
    """Publish a stream and the message that ends it.

    Returns the messages a second, and the processor time for each, without that of waiting [s].
    """
    message = stream.kind()
    if isinstance(message, LaserScan):
        message.ranges, message.ranges_length = [1.0] * 360, 360  # lcm-gen's encoder needs both
    loop = time.process_time()
    for _ in stream.turns() if stream.rate else ():
        set_time(message, time.monotonic_ns())
    begun = time.process_time()
    start = time.monotonic()
    for _ in stream.turns():
        set_time(message, time.monotonic_ns())
        send(message)
    rate = stream.messages / (time.monotonic() - start)
    cost = (time.process_time() - begun - (begun - loop)) / stream.messages
    set_time(message, 0)
    for _ in range(3 if stream.rate else 40):  # some may be lost, or come late behind a flood
        time.sleep(_GAP)
        send(message)
    return rate, cost


_SIDES = {
    "lcmtools": (send_as_node, receive_as_node),
    "plain lcm": (send_plainly, receive_plainly),
    "zenoh": (send_on_zenoh, receive_on_zenoh),
}


def run(side: str, stream: Stream) -> Result:
    """Send a stream once."""
    sender, receiver = _SIDES[side]
    with child(receiver, stream.kind) as receiving:
        receiving.wait()
        with child(sender, stream) as sending:
            sent, received = sending.wait(), receiving.wait()
    assert isinstance(sent, tuple)
    assert isinstance(received, tuple)
    (rate, sent_in), (latencies, received_in) = sent, received
    return Result(rate, len(latencies) / stream.messages, latencies, sent_in, received_in)


def rows(stream: Stream, rounds: int) -> list[list[object]]:
    """The table's lines of one stream: the sides take turns."""
    results: dict[str, list[Result]] = {side: [] for side in _SIDES}
    for _ in range(rounds):
        for side, found in results.items():
            found.append(run(side, stream))
    figures = {side: summary(stream, found) for side, found in results.items()}
    lines = {
        **figures,
        "ratio": ratios(figures["lcmtools"], figures["plain lcm"]),
        "zenoh by udpm": ratios(figures["zenoh"], figures["lcmtools"]),
    }
    return [[f"{stream}, {side}", *values] for side, values in lines.items()]


def ratios(one: list[float], other: list[float]) -> list[float]:
    """One side's figures by those of another."""
    return [a / b for a, b in zip(one, other, strict=True)]


def summary(stream: Stream, results: list[Result]) -> list[float]:
    """Medians: published a second, percent arrived; latencies and CPU [us] at a fixed rate."""
    values = [[result.rate, 100 * result.arrived] for result in results]
    if stream.rate is not None:
        for result, row in zip(results, values, strict=True):
            row += [1e6 * quantile(result.latencies, share) for share in (0.5, 0.99)]
            row += [1e6 * result.sent_in, 1e6 * result.received_in]
    medians = [median(column) for column in zip(*values, strict=True)]
    return medians + [float("nan")] * (6 - len(medians))


def streams(*, fast: bool) -> list[Stream]:
    """The messages that are sent."""
    wanted = ((Twist, 1000.0), (Odometry, 1000.0), (LaserScan, 100.0))
    rates = [(kind, rate if fast else min(rate, _MODEST_RATE)) for kind, rate in wanted]
    fixed = [Stream(kind, round(_SECONDS * rate), rate) for kind, rate in rates]
    return [*fixed, Stream(Twist, _FLAT_OUT, None)] if fast else fixed


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 3)
    fast = isolate()
    show(
        f"From process to process, medians of {rounds} rounds",
        [
            "stream",
            "published/s",
            "arrived %",
            "median us",
            "p99 us",
            "sender us",
            "receiver us",
        ],
        [row for stream in streams(fast=fast) for row in rows(stream, rounds)],
    )


if __name__ == "__main__":
    main()
