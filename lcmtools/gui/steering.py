"""Steering: velocity commands of pages, published while a page holds, then stops, then silence.

A separate thread sends the stops, so that no robot runs away if the server is busy, and a separate
process if the server is suspended or killed.
"""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from math import inf

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.gui.dead_man import STOPS, DeadMansSwitch
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import PageRequest
from lcmtools.gui.velocity import VelocityCommand
from lcmtools.gui.watchdog import Watchdog
from lcmtools.messages.registry import message_class

FASTEST = 10.0  # [m/s] and [rad/s] that a page can command
_END = 1.0  # [s] at most for the stops when the server ends
_SUSPENSION = 0.2  # [s] the same when it is suspended


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """The largest velocity that pages can command."""

    linear: float = FASTEST  # [m/s]
    angular: float = FASTEST  # [rad/s]


class Steering:
    """The commands of all pages, for any thread; on a lossy bus a command may be lost.

    ``watchdog`` returns the process that stops topics in the server's place; None for none.
    """

    def __init__(
        self,
        publishers: Publishers,
        limits: SpeedLimits,
        *,
        is_lossy: bool,
        watchdog: Callable[[], Watchdog] | None = None,
    ) -> None:
        self.limits = limits
        self._publishers = publishers
        self._changed = threading.Condition()
        self._switch = DeadMansSwitch(STOPS if is_lossy else 1)
        self._start_watchdog = watchdog
        self._watchdog: Watchdog | None = None
        self._commands: dict[str, tuple[str, VelocityCommand]] = {}  # by topic, with its type
        self._thread: threading.Thread | None = None
        self._is_over = False

    def prepare(self) -> None:
        """Start the thread and the process that stop topics, ahead of the first command."""
        with self._changed:
            self._start()

    def execute(self, page: int, request: PageRequest) -> str:
        """Execute "drive", "release" or "stop"; return as ``drive``; else MalformedRequest."""
        topic = request.text("topic")
        if request.op == "release":
            self.release(page, topic)
            return ""
        if request.op == "stop":
            return self.stop(page, topic, request.text("type"))
        velocity = request.number("forward"), request.number("turn")
        return self.drive(page, topic, request.text("type"), velocity)

    def drive(self, page: int, topic: str, kind: str, velocity: tuple[float, float]) -> str:
        """Publish a page's command; return the reason if it is ignored, else "".

        The velocity is forward [m/s], and the turn rate to the left [rad/s]; larger ones are
        limited.
        """
        with self._changed:
            try:
                self._prepare(topic, kind)
                refusal = self._switch.drive(page, topic, time.monotonic())
                if not refusal:
                    self._command(topic, *velocity)
            except LcmtoolsError as error:
                return str(error)
            self._changed.notify()
            return refusal

    def release(self, page: int, topic: str) -> None:
        """Stop a topic that the page drives."""
        with self._changed:
            self._switch.release(page, topic, time.monotonic())
            self._changed.notify()

    def stop(self, page: int, topic: str, kind: str) -> str:
        """Stop a topic, whoever drives it; return the reason if that is impossible, else ""."""
        with self._changed:
            try:
                self._prepare(topic, kind)
            except LcmtoolsError as error:
                return str(error)
            self._switch.stop(page, topic, time.monotonic())
            self._changed.notify()
            return ""

    def leave(self, page: int) -> None:
        """Stop everything that a page drives, because the page is gone."""
        with self._changed:
            self._switch.leave(page, time.monotonic())
            self._changed.notify()

    def stop_all(self) -> None:
        """Stop everything, and wait until that has been sent."""
        with self._changed:
            self._switch.end(time.monotonic())
            self._changed.notify()
            if self._thread:
                self._changed.wait_for(lambda: self._switch.next_time == inf, _SUSPENSION)

    def close(self) -> None:
        """Stop everything, and end."""
        with self._changed:
            self._is_over = True
            self._switch.end(time.monotonic())
            self._changed.notify()
            thread = self._thread
        if thread:
            thread.join(_END)
        if self._watchdog:
            self._watchdog.close()

    def _prepare(self, topic: str, kind: str) -> None:
        if self._is_over:
            raise LcmtoolsError("the server is ending")
        if self._commands.get(topic, ("",))[0] != kind:
            try:
                self._commands[topic] = kind, VelocityCommand(message_class(kind))
            except ValueError as error:
                raise UsageError(str(error)) from None
        self._start()

    def _start(self) -> None:
        if self._thread is None and not self._is_over:
            self._thread = threading.Thread(target=self._run, name="steering", daemon=True)
            self._thread.start()
            self._watchdog = self._start_watchdog() if self._start_watchdog else None

    def _run(self) -> None:
        with self._changed:
            while True:
                for topic in self._switch.stops_due(time.monotonic()):
                    with suppress(LcmtoolsError):  # the page learns of it by its own commands
                        self._publish(topic, self._payload(topic, 0.0, 0.0))
                        if self._watchdog:
                            self._watchdog.release(topic)
                pause = self._switch.next_time - time.monotonic()
                if pause == inf:
                    self._changed.notify_all()
                if self._is_over and pause == inf:
                    return
                self._changed.wait(None if pause == inf else max(0.0, pause))

    def _command(self, topic: str, forward: float, turn: float) -> None:
        if self._watchdog:
            self._watchdog.watch(topic, self._payload(topic, 0.0, 0.0))
        forward = _within(self.limits.linear, forward)
        turn = _within(self.limits.angular, turn)
        self._publish(topic, self._payload(topic, forward, turn))

    def _publish(self, topic: str, payload: bytes) -> None:
        self._publishers.publish(topic, message_class(self._commands[topic][0]), payload)

    def _payload(self, topic: str, forward: float, turn: float) -> bytes:
        return self._commands[topic][1].payload(forward, turn, time.time_ns())


def _within(limit: float, value: float) -> float:
    return max(-limit, min(limit, value))
