"""The goals that lcmtools holds itself to, in one table: what, ours, anchor, ratio, goal.

All are measured in one run. Commands run on a bus of 20 nodes, a talker and a listener, beside
``python -c 'import click'``, the least that any of them takes: wall time and processor time (CPU).
``wtf`` looks at a talker and a listener only; ``pub -1`` is timed until its message has arrived at
a tap. Commands that go on, and a node that follows the graph of a bus with 199 others, are given in
percent of a core: beside a plain LCM program in Python that decodes the same messages, or beside
the same node alone; ``spy`` runs in a terminal. The window's server with a page of odometry,
curves, laser and camera is beside itself without one, and so is the simulator. A tree of users'
types costs the difference to ``echo`` without it. Messages between processes and codecs are beside
plain ``lcm`` with lcm-gen's code. A ratio is ours by the anchor's; a goal is one of ours or, with
an "x", of the ratio. ``echo``'s is a third of rostopic's, where that is installed, else of the
10.1 % that it took elsewhere. ``--write`` keeps the table in RESULTS.md, with machine and versions.
"""

import os
import platform
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from importlib.metadata import version
from math import isnan, nan
from pathlib import Path
from statistics import median

import announce
import completion
import graph
import gui
import transport
import type_tree
from codec import measure, samples
from commands import TOOL, Environment, child_environment, end, in_turn, run, start, talking
from common import bus, cells, child, isolate, parser, show
from going_on import PORT, echoed, rostopic, shares, spying

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import decode, encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

_GRAPH_PORT, _TALK_PORT = 7793, 7787  # the first is graph's
_THIRD = 3.4  # [% of a core] of what rostopic's echo took where it was installed
_WTF = "wtf"
_LEAST = [sys.executable, "-c", "import click"]
_ENDED = {
    "--help": (80, None),
    "list": (150, 100),
    "node list": (150, 100),
    "type /robot1/odometry": (150, 100),
    "info /chatter": (250, None),
    "node info /talker": (250, None),
    _WTF: (1000, 200),
}
"""Commands that end, with the goals of wall and processor time [ms]."""

_DECODED = {
    "LaserScan 360": 4,
    "JointState 12": 3,
    "PointCloud2 1 MB": 100,
    "OccupancyGrid 200x200": 20,
}
"""Messages, and how many times as fast as by lcm-gen's code they are to be decoded."""

_TREE = {"first use": 2000, "use after": 100, "use of": 100}
"""The goals of a look-up in a tree of users' types [ms], by how its description starts."""

Row = Sequence[object]
_COLUMNS = ["what", "ours", "anchor", "ratio", "goal"]


def row(what: str, ours: float, anchor: float, goal: object) -> Row:
    """A line of the table."""
    return what, ours, anchor, ours / anchor, goal


def ended(environment: Environment, rounds: int) -> Iterator[Row]:
    """Commands that end, and completions."""
    healthy = {**environment, "LCM_DEFAULT_URL": bus(_TALK_PORT)}
    commands = {
        line: partial(run, [TOOL, *line.split()], healthy if line == _WTF else environment)
        for line in _ENDED
    }
    with graph.nodes(), talking(environment), talking(healthy):
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


def going_on(environment: Environment, cache: str, rounds: int) -> Iterator[Row]:
    """Commands that go on."""
    measuring = ("hz", "bw", "delay")
    for hertz, labels, goal in ((1000.0, measuring, 1.0), (10_000.0, measuring, 6.0)):
        found = shares(environment, hertz, labels, rounds)
        for label in labels:
            what = f"{label} of {hertz:g} Hz, % of a core"
            yield row(what, found[label], found["plain"], goal)
        spied = median(spying(environment, hertz) for _ in range(rounds))
        yield row(f"spy of {hertz:g} Hz, % of a core", spied, nan, goal)
    hertz = 500.0
    found, theirs = shares(environment, hertz, ("echo",), rounds), rostopic(cache, hertz, rounds)
    what = f"echo of {hertz:g} Hz, % of a core"
    yield row(what, found["echo"], found["plain"], _THIRD if isnan(theirs) else "-")
    if not isnan(theirs):
        yield row(f"{what}, beside rostopic's", found["echo"], theirs, "0.33x")
    cost, lost = echoed(environment)
    yield row("echo of 30000 Hz, us a Twist", cost, nan, 20)
    yield row("echo of 30000 Hz, Twists lost", lost, nan, 0)


def following() -> Row:
    """A node that follows 199 others."""
    with ExitStack() as stack:
        crowded = bus(PORT + 1)
        stack.enter_context(child(announce.announce, crowded, 199)).wait()
        nodes = [
            stack.enter_context(child(announce.node, "once", url)) for url in (bus(PORT), crowded)
        ]
        for one in nodes:
            one.wait()
        time.sleep(3.0)  # until every node has been heard
        alone, busy = announce.shares(nodes, 10.0)
    return row("following 199 nodes, % of a core more", busy - alone, alone, 0.5)


def viewed() -> Iterator[Row]:
    """The window's server with a page, and what a page costs the simulator."""
    yield row("gui at 30 Hz with a page, % of a core", *gui.with_a_page(), 15)
    shown, alone = gui.simulated()
    yield row("run sim with a page, % of a core more", shown - alone, alone, 10)


def travelling(rounds: int) -> Iterator[Row]:
    """Messages from process to process at 1 kHz.

    Many short streams: the processors that the threads of a stream wake up on decide between 60 and
    100 us, whoever sends it.
    """
    for kind in (Twist, Odometry):
        one = transport.Stream(kind, 1000, 1000.0)
        sides = {side: partial(transport.run, side, one) for side in ("lcmtools", "plain lcm")}
        results = in_turn(sides, rounds)
        ours, theirs = (transport.summary(one, found) for found in results.values())
        yield row(f"{kind.__name__} at 1 kHz, median us", ours[2], theirs[2], "0.8x")
        yield row(f"{kind.__name__} at 1 kHz, p99 us", ours[3], theirs[3], "1.0x")
        yield row(f"{kind.__name__} at 1 kHz, CPU us of the sender", ours[4], theirs[4], "1.0x")
        yield row(f"{kind.__name__} at 1 kHz, CPU us of the receiver", ours[5], theirs[5], "1.0x")


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


def own_types(environment: Environment, rounds: int) -> Iterator[Row]:
    """Commands that find a user's own types in a large tree."""
    for what, ours, anchor in type_tree.costs(environment, rounds):
        goal = next(goal for start, goal in _TREE.items() if what.startswith(start))
        yield row(f"{what}, ms of CPU more", 1000 * (ours - anchor), 1000 * anchor, goal)


def machine() -> str:
    """The computer and the versions that were measured."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    model = next((line.partition(": ")[2] for line in lines if line.startswith("model name")), "")
    return (
        f"{os.cpu_count()} processors ({model or platform.machine()}), {platform.system()}"
        f" {platform.release().partition('-')[0]}, Python {platform.python_version()},"
        f" lcm {version('lcm')}, lcmtools {version('lcmtools-robotics')}"
    )


def write(title: str, rows: Sequence[Row]) -> None:
    """Keep the table in RESULTS.md."""
    path = Path(__file__).with_name("RESULTS.md")
    table = [_COLUMNS, ["---", *["---:"] * (len(_COLUMNS) - 1)], *map(cells, rows)]
    text = "\n".join(f"| {' | '.join(line)} |" for line in table)
    path.write_text(
        f"# Measured\n\n`make bench ARGS=--write`, {time.strftime('%Y-%m-%d')}: {machine()}.\n"
        f"{title}; what is measured, and how, is in `goals.py`.\n\n{text}\n"
    )


def main() -> None:
    """Measure and print."""
    options = parser(__doc__)
    options.add_argument("--rounds", type=int, default=11, help="default: %(default)s")
    options.add_argument("--write", action="store_true", help="keep the table in RESULTS.md")
    arguments = options.parse_args()
    rounds, few = arguments.rounds, min(arguments.rounds, 3)
    if not isolate():
        return  # such streams are for a network of one's own
    with tempfile.TemporaryDirectory() as cache:
        environment = {**child_environment(cache, _GRAPH_PORT), "XDG_CACHE_HOME": f"{cache}/user"}
        rows = [*ended(environment, rounds)]
        rows += going_on({**environment, "LCM_DEFAULT_URL": bus(PORT)}, cache, few)
        rows += own_types(environment, few)
    rows += [following(), *viewed(), *travelling(rounds), *coding(few)]
    title = f"Medians of {rounds} runs, {few} of what goes on or is coded"
    show(title, _COLUMNS, rows)
    if arguments.write:
        write(title, rows)


if __name__ == "__main__":
    main()
