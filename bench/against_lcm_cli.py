"""The command line beside lcm-cli 0.2.0 (PyPI), the other one for LCM, in one run.

lcm-cli is installed into a virtual environment of its own, which is thrown away at the end; where
it cannot be installed, one line says so, and the exit code is 0. Both look at the same bus, in a
network namespace: ten channels at 10 Hz from a plain LCM program, one message type each.

Commands that end run in turn, round after round: medians of wall and processor time. ``list`` is
run as typed: lcm-cli listens for 5 s unless told otherwise, so it is run with ``-d 1`` too, and
"found" is how many of the ten channels the command named. Commands that go on are watched once they
run smoothly: ``echo`` prints decoded messages into a file, from a channel of so many a second,
"flat out" from one with more than anybody can print; "us" is processor time for one message.
``hz`` is lcm-cli's ``topic stats``; "off by" is how far the rate it told is from the true one.
A ratio is lcm-cli's figure by ours (for messages a second ours by lcm-cli's): above 1, ours is
better.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from functools import partial
from itertools import count
from multiprocessing.connection import Connection
from pathlib import Path

import lcm
from commands import TOOL, Environment, child_environment, in_turn, run, watch
from common import bus, child, isolate, rounds_asked, show
from compared import ENDED, FLOWING, RATES, ended_cells, flow_cells, rate_cells

from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import LaserScan

_REQUIREMENT = "lcm-cli==0.2.0"
_HOME = "LCMTOOLS_BENCH_LCM_CLI"  # where it is, for this script when it starts again in a namespace
_PORT = 7790
_CHANNELS = 10
_SECONDS = 2.0  # that a command which goes on is watched
_STEADY = 500.0  # [Hz]
_FLAT_OUT = 20_000.0  # [Hz], more than any of them prints
_BURST = 0.002  # [s] between the bursts of a stream that is faster
_TYPE = "lcmtools.types.geometry_msgs.Twist", "lcmtools.types.sensor_msgs.LaserScan"
_MARKS = r"^---$", r"^╭.* #\d"
_RATE = r"average rate: ([\d.]+)", r"STREAM\s*│\s*\d+\s*│\s*([\d.]+)"
_READY = "average rate", "Collecting"  # theirs draws its table at the end only, where in a file


def publish(connection: Connection) -> None:
    """Child: the channels that ``list`` finds."""
    instance = lcm.LCM(bus(_PORT))
    payload = encode(Twist())
    connection.send(None)
    for number in count():
        instance.publish(f"CHANNEL_{number % _CHANNELS}", payload)
        time.sleep(0.1 / _CHANNELS)


def stream(connection: Connection, payload: bytes, rate: float) -> None:
    """Child: one channel at a rate [Hz], in bursts where that is high."""
    instance = lcm.LCM(bus(_PORT))
    burst = max(1, round(rate * _BURST))
    connection.send(None)
    start = time.monotonic()
    for number in count():
        for _ in range(burst):
            instance.publish("STREAM", payload)
        time.sleep(max(0.0, start + number * burst / rate - time.monotonic()))


def payloads() -> dict[str, bytes]:
    """The messages that are echoed: a small one and a larger one."""
    twist, scan = Twist(), LaserScan()
    twist.linear.x, twist.angular.z = 0.5, 0.3
    scan.header.frame_id = "laser"
    scan.ranges = [1.0 + number / 360 for number in range(360)]
    return {"Twist": encode(twist), "LaserScan 360": encode(scan)}


def install(home: str) -> str:
    """Install lcm-cli; return what went wrong, "" where nothing did."""
    pip = [f"{home}/bin/python", "-m", "pip", "install", "--quiet", _REQUIREMENT]
    for command in ([sys.executable, "-m", "venv", home], pip):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            return (done.stderr.strip() or "no reason given").splitlines()[-1]
    return ""


def ended(environment: Environment, home: str, rounds: int) -> list[list[object]]:
    """The table of commands that end."""
    lcm_cli, port = f"{home}/bin/lcm", f"--lcm-port={_PORT}"
    theirs_slow = [lcm_cli, "topic", "list", port]
    theirs = {
        "--help": [lcm_cli, "--help"],
        "list": theirs_slow,
        "list, -d 1": [*theirs_slow, "-d", "1"],
        "node list": [lcm_cli, "node", "list", port],
        "echo -n 1": [lcm_cli, "topic", "echo", "CHANNEL_1", "-n", "1", port, "--type", _TYPE[0]],
    }
    ours = {
        "--help": [TOOL, "--help"],
        "list": [TOOL, "list"],
        "list, -d 1": [TOOL, "list"],
        "node list": [TOOL, "node", "list", "-a"],
        "echo -n 1": [TOOL, "echo", "CHANNEL_1", "-n", "1"],
    }
    rows = []
    for label, command in ours.items():
        pair = {
            "ours": partial(run, command, environment),
            "theirs": partial(run, theirs[label], environment),
        }
        found = in_turn(pair, min(rounds, 3) if label in ("list", "node list") else rounds)
        rows.append([label, *ended_cells(found["ours"], found["theirs"], r"CHANNEL_\d")])
    return rows


def echoed(environment: Environment, home: str, rounds: int, seconds: float) -> list[list[object]]:
    """The table of echo."""
    rows = []
    for (label, payload), type_ in zip(payloads().items(), _TYPE, strict=True):
        theirs = [f"{home}/bin/lcm", "topic", "echo", "STREAM", f"--lcm-port={_PORT}"]
        commands = [TOOL, "echo", "STREAM"], [*theirs, "--type", type_]
        for rate, speed in ((_STEADY, f"{_STEADY:g} Hz"), (_FLAT_OUT, "flat out")):
            with child(stream, payload, rate) as publisher:
                publisher.wait()
                found = in_turn(
                    {
                        command[0]: partial(watch, command, environment, mark, seconds)
                        for command, mark in zip(commands, _MARKS, strict=True)
                    },
                    rounds,
                )
            rows.append([f"{label}, {speed}", *flow_cells(*found.values())])
    return rows


def measured(
    environment: Environment, home: str, rounds: int, seconds: float
) -> list[list[object]]:
    """The table of hz."""
    theirs = [f"{home}/bin/lcm", "topic", "stats", "STREAM", f"--lcm-port={_PORT}"]
    commands = [TOOL, "hz", "STREAM"], theirs
    rows = []
    for rate in (100.0, 1000.0, 5000.0):
        with child(stream, payloads()["Twist"], rate) as publisher:
            publisher.wait()
            found = in_turn(
                {
                    command[0]: partial(watch, command, environment, mark, seconds, ready)
                    for command, mark, ready in zip(commands, _RATE, _READY, strict=True)
                },
                rounds,
            )
        rows.append([f"{rate:g} Hz", *rate_cells(rate, tuple(found.values()), _RATE)])
    return rows


def compare(home: str, rounds: int, seconds: float) -> None:
    """Measure and print all tables."""
    with tempfile.TemporaryDirectory() as cache, child(publish) as publisher:
        publisher.wait()
        root = str(Path(__file__).resolve().parents[1])  # lcm-cli takes lcm-gen's classes from it
        environment = {**child_environment(cache, _PORT), "PYTHONPATH": root}
        both = "lcmtools and lcm-cli 0.2.0"
        show(
            f"Commands that end, {both}, medians of {rounds} runs (of 5 s: {min(rounds, 3)})",
            ENDED,
            ended(environment, home, rounds),
        )
        few = min(rounds, 3)
        show(
            f"echo, {both}, medians of {few} times {seconds:g} s",
            FLOWING,
            echoed(environment, home, few, seconds),
        )
        show(
            f"hz, {both}, medians of {few} times {seconds:g} s",
            RATES,
            measured(environment, home, few, seconds),
        )


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 11)
    home = os.environ.get(_HOME) or tempfile.mkdtemp()
    try:
        if _HOME not in os.environ:
            if reason := install(home):
                print(f"lcm-cli cannot be installed, so there is nothing to compare: {reason}")
                return
            os.environ[_HOME] = home
        isolate()
        compare(home, rounds, _SECONDS)
    finally:
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    main()
