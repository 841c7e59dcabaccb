"""The process that publishes the commands of pages, and stops them, whatever happens to the server.

The server tells it each command as a line on a socket, and waits for the answer. Its clock alone
stops robots: when the server is busy, suspended or killed. It has a session of its own, so that
Ctrl-C and Ctrl-Z at the server's terminal do not reach it.
"""

import json
import math
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing, suppress

from lcmtools.bus.url import BusUrl, parse_url
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.dead_man import STOPS, Command, DeadMansSwitch
from lcmtools.gui.page_publisher import Publishers

_LONGEST_START = 10.0  # [s] to the first answer, on a busy computer
_LONGEST = 0.25  # [s] to each later one; the server still stops robots in time if there is none
_END = 1.0  # [s] for the stops when the server ends


class NoAnswer(LcmtoolsError):  # noqa: N818 - named for what happened, as in errors.py
    """The process is gone, does not start or stands still."""

    def __init__(self, reason: object) -> None:
        super().__init__(f"the process that drives robots does not answer ({reason})")


class SteeringProcess:
    """The server's end of the socket; NoAnswer if the process cannot be started."""

    def __init__(self, url: BusUrl) -> None:
        self._socket, its_end = socket.socketpair()
        try:
            with its_end:
                self._process = subprocess.Popen(  # noqa: S603 - lcmtools' own program
                    [sys.executable, "-m", __name__, str(url)],
                    stdin=its_end.fileno(),
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,
                )
        except OSError as error:
            self._socket.close()
            raise NoAnswer(error.strerror) from error
        self.pid = self._process.pid
        self._socket.settimeout(_LONGEST_START)
        self._answers = self._socket.makefile("rb")
        self._has_started = False

    def execute(self, command: Command) -> str:
        """Execute a page's command; return why it is ignored, else ""; NoAnswer."""
        if not self._has_started:  # else a first command that drives could be waited for as long
            self._ask(Command("release", page=0))
            self._socket.settimeout(_LONGEST)
            self._has_started = True
        return self._ask(command)

    def _ask(self, command: Command) -> str:
        try:
            self._socket.sendall(command.line())
            answer = self._answers.readline()
        except OSError as error:
            raise NoAnswer(error) from error
        if not answer:
            raise NoAnswer("it has ended")
        return str(json.loads(answer))

    def close(self) -> None:
        """Let the process end; it first stops what is still driven."""
        self._answers.close()
        self._socket.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_END)
        self.kill()

    def kill(self) -> None:
        """End the process at once."""
        self._answers.close()
        self._socket.close()
        self._process.kill()
        self._process.wait()


def serve(lines: socket.socket, publish: Callable[[Command, bytes], None], stops: int) -> None:
    """Publish the commands that come, and their stops in time, until the socket ends."""
    switch, rest, is_open = DeadMansSwitch(stops), b"", True
    while is_open or switch.next_time < math.inf:
        pause = switch.next_time - time.monotonic()
        wait = None if pause == math.inf else max(0.0, pause)
        answers: list[str] = []
        if select.select([lines] if is_open else [], [], [], wait)[0]:
            piece = _received(lines)
            *whole, rest = (rest + piece).split(b"\n")
            answers = [_executed(Command.of(line), switch, publish) for line in whole]
            if not piece:
                is_open = False
                switch.end(time.monotonic())
        for command in switch.stops_due(time.monotonic()):
            with suppress(LcmtoolsError):  # the network is gone: no robot hears it either
                publish(command, command.stop)
        with suppress(OSError):  # the server is gone, which the next piece tells
            lines.sendall(b"".join(json.dumps(one).encode() + b"\n" for one in answers))


def _received(lines: socket.socket) -> bytes:
    try:
        return lines.recv(1 << 16)
    except OSError:  # the server has been killed before it read an answer
        return b""


def _executed(
    command: Command, switch: DeadMansSwitch, publish: Callable[[Command, bytes], None]
) -> str:
    """Execute a command; return the reason if it is ignored, else ""."""
    refusal = switch.take(command, time.monotonic())
    try:
        if command.payload and not refusal:
            publish(command, command.payload)
    except LcmtoolsError as error:
        return str(error)
    return refusal


def main(url: str) -> None:
    """Serve the server at the other end of standard input."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # it ends with the server, after the stops
    where = parse_url(url)
    with socket.socket(fileno=sys.stdin.fileno()) as lines, closing(Publishers(where)) as bus:
        with suppress(LcmtoolsError):  # the first command tells
            _ = bus.node
        serve(
            lines,
            lambda command, payload: bus.publish_payload(command.topic, command.kind, payload),
            STOPS if where.is_multicast else 1,
        )


if __name__ == "__main__":
    main(sys.argv[1])
