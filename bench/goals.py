"""The goals that lcmtools holds itself to, in one table: what, ours, anchor, ratio, goal.

All are measured in one run. Commands run on a bus of 20 nodes, beside ``python -c 'import click'``,
the least that any of them takes: wall time and processor time (CPU); ``pub -1`` is timed until its
message has arrived at a tap. Commands that go on, and a node that follows the graph of a bus with
199 others, are given in percent of a core: beside a plain LCM program in Python that decodes the
same Twists, or beside the same node alone. Messages from process to process and codecs are beside
plain ``lcm`` with lcm-gen's code. A ratio is ours by the anchor's; a goal is one of ours or, with
an "x", of the ratio. ``echo``'s is a third of what rostopic took (10.1 %).
"""

import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from functools import partial
from math import nan
from multiprocessing.connection import Connection
from statistics import median

import announce
import completion
import graph
import lcm
import transport
from codec import measure, samples
from commands import TOOL, Environment, child_environment, end, in_turn, middle, run, start, watch
from common import bus, child, every, isolate, rounds_asked, show

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import decode, encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

_GRAPH_PORT, _PORT = 7793, 7788  # the first is graph's
_BURST = 0.001  # [s] between the bursts of a fast stream
_SECONDS = 3.0  # that a command which goes on is watched
_LEAST = [sys.executable, "-c", "import click"]
_PLAIN = """
import lcm, sys
from itertools import count
from lcmtools.types.geometry_msgs import Twist
bus, numbers = lcm.LCM(sys.argv[1]), count()
def take(_, data):
    Twist.decode(data)
    if next(numbers) % 100 == 0:
        print("taken", flush=True)
bus.subscribe("/stream", take).set_queue_capacity(10_000)
while True:
    bus.handle()
"""
_ENDED = {
    "--help": (80, None),
    "list": (150, 100),
    "node list": (150, 100),
    "type /robot1/odometry": (150, 100),
    "info /robot1/odometry": (250, None),
    "node info /robot1/node_1": (250, None),
    "wtf": (1000, 200),
}
"""Commands that end, with the goals of wall and processor time [ms]."""

_DECODED = {
    "LaserScan 360": 4,
    "JointState 12": 3,
    "PointCloud2 1 MB": 100,
    "OccupancyGrid 200x200": 20,
}
"""Messages, and how many times as fast as by lcm-gen's code they are to be decoded."""

Row = Sequence[object]


def row(what: str, ours: float, anchor: float, goal: object) -> Row:
    """A line of the table."""
    return what, ours, anchor, ours / anchor, goal


def stream(connection: Connection, rate: float) -> None:
    """Child: a plain LCM program that sends Twists, in bursts where the rate [Hz] is high."""
    instance, payload = lcm.LCM(bus(_PORT)), encode(Twist())
    burst = max(1, round(rate * _BURST))
    connection.send(None)
    with suppress(KeyboardInterrupt):
        for _ in every(burst / rate, 3600.0):
            for _ in range(burst):
                instance.publish("/stream", payload)


def ended(environment: Environment, rounds: int) -> Iterator[Row]:
    """Commands that end, and completions."""
    commands = {line: partial(run, [TOOL, *line.split()], environment) for line in _ENDED}
    with graph.nodes():
        found = in_turn({"least": partial(run, _LEAST, environment), **commands}, rounds)
        asked = [completion.ask("lcmtools info /robot1/o", environment) for _ in range(5 * rounds)]
    wall, cpu = (
        {label: 1000 * median(times) for label, times in table.items()}
        for table in (
            {label: [one.wall for one in runs] for label, runs in found.items()},
            {label: [one.processor for one in runs] for label, runs in found.items()},
        )
    )
    for line, (goal, cpu_goal) in _ENDED.items():
        yield row(f"{line}, ms", wall[line], wall["least"], goal)
        if cpu_goal:
            yield row(f"{line}, ms of CPU", cpu[line], cpu["least"], cpu_goal)
    walls = [1000 * one.wall for one in asked]
    yield row("one completion, ms", median(walls), wall["least"], 100)
    yield row("the slowest completion, ms", max(walls), wall["least"], 150)
    yield row("pub -1 to delivered, ms", delivered(environment, rounds), wall["least"], 250)


def delivered(environment: Environment, rounds: int) -> float:
    """The time from the start of ``pub -1`` until its message has arrived [ms]."""
    words, times = [TOOL, "pub", "-1", "/said", "std_msgs/String", "data: hello"], []
    with Tap(parse_url(environment["LCM_DEFAULT_URL"])) as tap:
        for _ in range(rounds):
            begin, pid = time.perf_counter(), start(words, environment)
            while all(packet.channel != "/said" for packet in tap.receive(5.0)):
                pass
            times.append(1000 * (time.perf_counter() - begin))
            end(pid)
    return median(times)


def going_on(environment: Environment, rounds: int) -> Iterator[Row]:
    """Commands that go on."""
    plain = [sys.executable, "-c", _PLAIN, environment["LCM_DEFAULT_URL"]]
    rate = "average rate"
    wanted = (
        (1000.0, {"hz": (rate, 1.0), "bw": ("average:", 1.0)}),
        (10_000.0, {"hz": (rate, 6.0), "bw": ("average:", 6.0)}),
        (500.0, {"echo": ("^---$", 3.4)}),
    )
    for hertz, commands in wanted:
        sides = {
            label: partial(watch, [TOOL, label, "/stream"], environment, mark, _SECONDS)
            for label, (mark, _) in commands.items()
        }
        sides["plain"] = partial(watch, plain, environment, "taken", _SECONDS)
        with child(stream, hertz) as sender:
            sender.wait()
            found = in_turn(sides, rounds)
        share = {label: middle(flows, lambda flow: flow.share) for label, flows in found.items()}
        for label, (_, goal) in commands.items():
            yield row(f"{label} of {hertz:g} Hz, % of a core", share[label], share["plain"], goal)
    with child(stream, 20_000.0) as sender:
        sender.wait()
        flow = watch([TOOL, "echo", "/stream"], environment, "^---$", _SECONDS)
    yield row("echo flat out, us a Twist", flow.cost, nan, 20)


def following() -> Row:
    """A node that follows 199 others."""
    with ExitStack() as stack:
        crowded = bus(_PORT + 1)
        stack.enter_context(child(announce.announce, crowded, 199)).wait()
        nodes = [
            stack.enter_context(child(announce.node, "once", url)) for url in (bus(_PORT), crowded)
        ]
        for one in nodes:
            one.wait()
        time.sleep(3.0)  # until every node has been heard
        alone, busy = announce.shares(nodes, 5.0)
    return row("following 199 nodes, % of a core more", busy - alone, alone, 0.5)


def travelling(rounds: int) -> Iterator[Row]:
    """Messages from process to process at 1 kHz."""
    for kind in (Twist, Odometry):
        one = transport.Stream(kind, 1000, 1000.0)
        sides = {side: partial(transport.run, side, one) for side in ("lcmtools", "plain lcm")}
        results = in_turn(sides, rounds)
        ours, theirs = (transport.summary(one, found) for found in results.values())
        yield row(f"{kind.__name__} at 1 kHz, median us", ours[2], theirs[2], "1.1x")
        yield row(f"{kind.__name__} at 1 kHz, p99 us", ours[3], theirs[3], "1.0x")


def coding(rounds: int) -> Iterator[Row]:
    """Decoding, and encoding what was decoded."""
    found = samples()
    for label, times in _DECODED.items():
        cls, payload = type(found[label]), encode(found[label])
        ways = measure(
            rounds,
            partial(decode, cls, payload),
            partial(cls.decode, payload),
            partial(encode, decode(cls, payload)),
            cls.decode(payload).encode,
        )
        yield row(f"decode {label}, us", ways[0], ways[1], f"{1 / times:.2g}x")
        yield row(f"encode {label}, us", ways[2], ways[3], "0.33x")


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 11)
    few = min(rounds, 3)
    if not isolate():
        return  # such streams are for a network of one's own
    with tempfile.TemporaryDirectory() as cache:
        environment = {**child_environment(cache, _GRAPH_PORT), "XDG_CACHE_HOME": f"{cache}/user"}
        rows = [*ended(environment, rounds), *going_on({**environment, **_on_stream()}, few)]
    rows += [following(), *travelling(few), *coding(few)]
    show(f"Medians of {rounds} runs", ["what", "ours", "anchor", "ratio", "goal"], rows)


def _on_stream() -> dict[str, str]:
    return {"LCM_DEFAULT_URL": bus(_PORT)}


if __name__ == "__main__":
    main()
