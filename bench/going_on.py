"""Commands that go on, beside a plain LCM program in Python that decodes the same messages.

Belongs here: streams, and the processor time of who reads them. The goals are in ``goals``.
"""

import os
import pty
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib.util import find_spec
from itertools import pairwise, repeat
from math import nan
from multiprocessing.connection import Connection
from threading import Thread

import against_ros
import lcm
from commands import TOOL, Environment, Flow, in_turn, middle, running, watch
from common import bus, child, every, processor_time

from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist, TwistStamped

PORT = 7788
_TOPIC = "/stream"
_BURST = 0.001  # [s] between the bursts of a fast stream
_SECONDS = 3.0  # that a command is watched
_SETTLING = 3.0  # [s] for a terminal's first pictures
_FAST = 30_000.0  # [Hz]
_NUMBER = re.compile(r"^linear:\n  x: (\d+)", re.MULTILINE)
_PLAIN = """
import lcm, sys
from itertools import count
from lcmtools.types.geometry_msgs import Twist, TwistStamped
bus, numbers = lcm.LCM(sys.argv[1]), count()
kinds = {kind._get_packed_fingerprint(): kind for kind in (Twist, TwistStamped)}
def take(_, data):
    kinds[data[:8]].decode(data)
    if next(numbers) % 100 == 0:
        print("taken", flush=True)
bus.subscribe("/stream", take).set_queue_capacity(10_000)
while True:
    bus.handle()
"""
_MARKS = {
    "hz": "average rate",
    "bw": "average:",
    "delay": "average delay",
    "echo": "^---$",
}
"""Matches once in each report, or message, of a command."""


def stream(connection: Connection, rate: float) -> None:
    """Child: a plain LCM program that sends Twists with a stamp, in bursts where it is fast."""
    message = TwistStamped()
    message.header.stamp.sec = int(time.time())
    _send(connection, rate, repeat(encode(message)))


def numbered(connection: Connection, rate: float) -> None:
    """Child: the same with Twists, each with its number."""
    _send(connection, rate, _numbered())


def _numbered() -> Iterator[bytes]:
    message = Twist()
    while True:
        yield encode(message)
        message.linear.x += 1.0


def _send(connection: Connection, rate: float, payloads: Iterator[bytes]) -> None:
    instance, burst = lcm.LCM(bus(PORT)), max(1, round(rate * _BURST))
    connection.send(None)
    with suppress(KeyboardInterrupt):
        for _ in every(burst / rate, 3600.0):
            for _ in range(burst):
                instance.publish(_TOPIC, next(payloads))


def shares(
    environment: Environment, hertz: float, labels: Sequence[str], rounds: int
) -> dict[str, float]:
    """The shares of a core [%] of commands on a stream [Hz], and of "plain"."""
    plain = [sys.executable, "-c", _PLAIN, environment["LCM_DEFAULT_URL"]]
    sides = {
        label: partial(watch, [TOOL, label, _TOPIC], environment, _MARKS[label], _SECONDS)
        for label in labels
    }
    sides["plain"] = partial(watch, plain, environment, "taken", _SECONDS)
    with child(numbered if "echo" in labels else stream, hertz) as sender:
        sender.wait()
        found = in_turn(sides, rounds)
    return {label: middle(flows, lambda flow: flow.share) for label, flows in found.items()}


def spying(environment: Environment, hertz: float) -> float:
    """The share of a core [%] of ``spy``, in a terminal, on a stream [Hz]; nan without textual."""
    if find_spec("textual") is None:
        return nan
    terminal, inside = pty.openpty()
    words, where = [TOOL, "spy"], {**environment, "TERM": "xterm-256color"}
    with (
        child(stream, hertz) as sender,
        subprocess.Popen(words, stdin=inside, stdout=inside, stderr=inside, env=where) as spy,
    ):
        sender.wait()
        Thread(target=_look_away, args=(terminal,), daemon=True).start()
        time.sleep(_SETTLING)
        before, begin = processor_time(spy.pid), time.perf_counter()
        time.sleep(_SECONDS)
        used = processor_time(spy.pid) - before
        taken = time.perf_counter() - begin
        spy.terminate()
    os.close(inside)
    return 100 * used / taken


def _look_away(terminal: int) -> None:
    with suppress(OSError):  # it ends
        while os.read(terminal, 65_536):
            pass


def echoed(environment: Environment) -> tuple[float, int]:
    """The processor time of ``echo`` for a Twist of a fast stream [us], and how many it lost."""
    with child(numbered, _FAST) as sender:
        sender.wait()
        flow: Flow = watch([TOOL, "echo", _TOPIC], environment, _MARKS["echo"], _SECONDS)
    numbers = [int(number) for number in _NUMBER.findall(flow.output)]
    return flow.cost, sum(later - number - 1 for number, later in pairwise(numbers))


def rostopic(cache: str, hertz: float, rounds: int) -> float:
    """The share of a core [%] of ``rostopic echo`` on a stream [Hz]; nan if not installed."""
    if absent := against_ros.missing(("rostopic", "roscore")):
        print(f"(no anchor: {', '.join(absent)} not installed, see against_ros.py --help)")
        return nan
    environment = {**os.environ, **against_ros.ros_environment(cache)}
    with _ros_stream(environment, hertz):
        words = ["/usr/bin/rostopic", "echo", _TOPIC]
        flows = [watch(words, environment, _MARKS["echo"], _SECONDS) for _ in range(rounds)]
    return middle(flows, lambda flow: flow.share)


@contextmanager
def _ros_stream(environment: Environment, hertz: float) -> Iterator[None]:
    with running([["/usr/bin/roscore"]], environment):
        time.sleep(_SETTLING)  # until the master answers
        with running([against_ros.ros_node("streamer", hertz)], environment):
            yield
