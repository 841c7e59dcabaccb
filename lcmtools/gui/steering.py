"""Steering: velocity commands of pages, published while a page holds, then stops, then silence.

Each command is passed on to a process of its own with its stop and the end of its validity. That
process alone publishes, and its clock alone stops the robots (``steering_process``).
"""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.gui.dead_man import HOLD, STOP_GAP, STOPS, Command
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import PageRequest
from lcmtools.gui.steering_process import NoAnswer, SteeringProcess
from lcmtools.gui.velocity import VelocityCommand
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.names import check_channel

FASTEST = 10.0  # [m/s] and [rad/s] that a page can command


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """The largest velocity that pages can command."""

    linear: float = FASTEST  # [m/s]
    angular: float = FASTEST  # [rad/s]


@dataclass(frozen=True, slots=True)
class _Asked:
    """The values of a request to drive, release or stop."""

    topic: str
    type: str = ""
    forward: float = 0.0  # [m/s]
    turn: float = 0.0  # to the left [rad/s]


class Steering:
    """The commands of all pages, for any thread; ``start`` starts the process that publishes."""

    def __init__(
        self, publishers: Publishers, limits: SpeedLimits, start: Callable[[], SteeringProcess]
    ) -> None:
        self.limits = limits
        self.pids: set[int] = set()  # of the processes that have published
        self._publishers, self._start_process = publishers, start
        self._lock = threading.Lock()
        self._driven: dict[tuple[str, tuple[str, int]], Command] = {}  # by topic and type
        self._process: SteeringProcess | None = None
        self._is_over = False

    def prepare(self) -> None:
        """Start the process ahead of the first command."""
        with self._lock, suppress(LcmtoolsError):
            self._started()

    def execute(self, page: int, request: PageRequest, late: float = 0.0) -> str:
        """Execute "drive", "release" or "stop" of a page; return why it is ignored, else "".

        The velocity is "forward" [m/s], and the rate of the "turn" to the left [rad/s]; larger
        ones are limited. A command that came ``late`` [s] is valid for less time. Raises
        MalformedRequest.
        """
        asked, velocity = request.read(_Asked), None
        if request.op == "drive":
            forward = _within(self.limits.linear, asked.forward)
            velocity = forward, _within(self.limits.angular, asked.turn)
        try:
            command = _command(request.op, page, asked.topic, asked.type, velocity)
        except LcmtoolsError as error:
            return str(error)
        return self._execute(command._replace(until=time.monotonic() + HOLD - late))

    def leave(self, page: int) -> None:
        """Stop everything that a page drives, because the page is gone."""
        if self._process:
            self._execute(Command("release", page))

    def close(self) -> None:
        """Stop everything, and end."""
        with self._lock:
            self._is_over = True
            if self._process:
                self._process.close()
                self._process = None

    def _started(self) -> SteeringProcess:
        if self._process is None:
            self._process = self._start_process()
            self.pids.add(self._process.pid)
        return self._process

    def _execute(self, command: Command) -> str:
        with self._lock:
            if self._is_over:
                return "the server is ending"
            try:
                refusal = self._started().execute(command)
            except NoAnswer as error:
                self._stop_all(command)
                return str(error)
            if command.payload and not refusal:
                self._driven[command.topic, command.kind] = command
            for key, one in [*self._driven.items()]:
                if command.releases(one.page, one.topic):
                    del self._driven[key]
            return refusal

    def _stop_all(self, command: Command) -> None:
        """Stop what the process drove that is gone or stands still; the next command starts one."""
        if self._process:
            self._process.kill()
            self._process = None
        for one in (command, *self._driven.values()):
            for _ in range(STOPS if one.stop else 0):
                with suppress(LcmtoolsError):  # the network is gone: no robot hears it either
                    self._publishers.publish_payload(one.topic, one.kind, one.stop)
                time.sleep(STOP_GAP)
        self._driven.clear()


def _command(
    op: str, page: int, topic: str, kind: str, velocity: tuple[float, float] | None
) -> Command:
    """Return a command with its messages."""
    if op == "release":
        return Command(op, page, topic)
    cls, now = message_class(kind), time.time_ns()
    try:
        message = VelocityCommand(cls)
    except ValueError as error:
        raise UsageError(str(error)) from None
    payload = message.payload(*velocity, now) if velocity else b""
    stop = message.payload(0.0, 0.0, now)
    return Command(op, page, check_channel(topic), (kind, fingerprint(cls)), payload, stop)


def _within(limit: float, value: float) -> float:
    return max(-limit, min(limit, value))
