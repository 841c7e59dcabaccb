"""A process that stops the driven robots when the server itself cannot: killed, or suspended.

The server tells it each driven topic with the message that stops it, by a pipe that ends with the
server. A topic that is told neither again nor as stopped in time is stopped here. It has a session
of its own, so that Ctrl-C and Ctrl-Z at the server's terminal do not reach it.
"""

import json
import math
import os
import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, suppress

from lcmtools.bus.open import open_bus
from lcmtools.bus.udp_sender import UdpSender
from lcmtools.bus.url import BusUrl, parse_url
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.dead_man import HOLD, STOP_GAP, STOPS

_LIMIT = HOLD + 0.05  # [s] after a command; a running server stops a topic before
_LONGEST_LINE = select.PIPE_BUF  # bytes that the pipe takes whole or not at all


class Watchdog:
    """The server's end of the pipe; does nothing if the process cannot be started."""

    def __init__(self, url: BusUrl) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        with suppress(OSError):  # no process or descriptor is left: robots are driven all the same
            self._process = subprocess.Popen(  # noqa: S603 - lcmtools' own program
                [sys.executable, "-m", __name__, str(url)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
                bufsize=0,
            )
            assert self._process.stdin is not None, "it is a pipe"
            os.set_blocking(self._process.stdin.fileno(), False)  # it must not hold up the server

    def watch(self, topic: str, stop: bytes) -> None:
        """Tell that a topic is driven now, and the message that stops it."""
        self._tell({"topic": topic, "stop": stop.hex()})

    def release(self, topic: str) -> None:
        """Tell that a topic has been stopped."""
        self._tell({"topic": topic, "stop": ""})

    def close(self) -> None:
        """Let the process end; it first stops what is still driven."""
        if self._process and self._process.stdin:
            self._process.stdin.close()
            self._process.wait()

    def _tell(self, values: dict[str, str]) -> None:
        line = json.dumps(values).encode() + b"\n"
        if self._process and self._process.stdin and len(line) <= _LONGEST_LINE:
            with suppress(OSError, ValueError):  # it was killed, or has ended
                self._process.stdin.write(line)


def keep_watch(stream: int, publish: Callable[[str, bytes], None]) -> None:
    """Stop the driven topics that a pipe tells, each when its time is over, until the pipe ends."""
    driven: dict[str, tuple[float, bytes]] = {}
    lines = _lines(stream, lambda: min((end for end, _ in driven.values()), default=math.inf))
    for line in lines:
        if line:
            values = json.loads(line)
            driven.pop(values["topic"], None)
            if values["stop"]:
                until = time.monotonic() + _LIMIT
                driven[values["topic"]] = until, bytes.fromhex(values["stop"])
        for topic, (until, stop) in list(driven.items()):
            if until <= time.monotonic():
                del driven[topic]
                _stop(topic, stop, publish)
    for topic, (_, stop) in driven.items():
        _stop(topic, stop, publish)


def _lines(stream: int, next_time: Callable[[], float]) -> Iterator[bytes]:
    """Yield the lines of a pipe as they come, and an empty one at ``next_time`` [s]."""
    rest = b""
    while True:
        pause = next_time() - time.monotonic()
        ready, _, _ = select.select([stream], [], [], None if pause == math.inf else max(0, pause))
        if not ready:
            yield b""
            continue
        piece = os.read(stream, 1 << 16)
        if not piece:
            return
        *lines, rest = (rest + piece).split(b"\n")
        yield from lines


def _stop(topic: str, stop: bytes, publish: Callable[[str, bytes], None]) -> None:
    for _ in range(STOPS):
        with suppress(
            LcmtoolsError, OSError
        ):  # the network is gone, and the robot does not hear it either
            publish(topic, stop)
        time.sleep(STOP_GAP)


def main(url: str) -> None:
    """Keep watch on standard input."""
    where = parse_url(url)
    with ExitStack() as stack:
        publish: Callable[[str, bytes], None]
        if where.is_multicast:  # without a socket that receives, which would count as a listener
            sender = stack.enter_context(closing(UdpSender(where)))
            publish = sender.send_at_once
        else:
            publish = stack.enter_context(closing(open_bus(where))).publish
        keep_watch(sys.stdin.fileno(), publish)


if __name__ == "__main__":
    main(sys.argv[1])
