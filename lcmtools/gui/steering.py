"""Steering: velocity commands of pages, published while a page holds, then stops, then silence.

A separate thread sends the stops, so that no robot runs away if the server is busy.
"""

import threading
import time
from contextlib import suppress
from math import inf

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.gui.dead_man import DeadMansSwitch
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import PageRequest
from lcmtools.gui.velocity import VelocityCommand
from lcmtools.messages.registry import message_class

_STOPS = 3  # zero commands if datagrams may be lost
_END = 1.0  # [s] at most for the stops when the server ends


class Steering:
    """The commands of all pages, for any thread; on a lossy bus a command may be lost."""

    def __init__(self, publishers: Publishers, *, is_lossy: bool) -> None:
        self._publishers = publishers
        self._changed = threading.Condition()
        self._switch = DeadMansSwitch(_STOPS if is_lossy else 1)
        self._commands: dict[str, tuple[str, VelocityCommand]] = {}  # by topic, with its type
        self._thread: threading.Thread | None = None
        self._is_over = False

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

        The velocity is forward [m/s], and the turn rate to the left [rad/s].
        """
        with self._changed:
            try:
                self._prepare(topic, kind)
                refusal = self._switch.drive(page, topic, time.monotonic())
                if not refusal:
                    self._publish(topic, *velocity)
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

    def close(self) -> None:
        """Stop everything, and end."""
        with self._changed:
            self._is_over = True
            self._switch.end(time.monotonic())
            self._changed.notify()
            thread = self._thread
        if thread:
            thread.join(_END)

    def _prepare(self, topic: str, kind: str) -> None:
        if self._is_over:
            raise LcmtoolsError("the server is ending")
        if self._commands.get(topic, ("",))[0] != kind:
            try:
                self._commands[topic] = kind, VelocityCommand(message_class(kind))
            except ValueError as error:
                raise UsageError(str(error)) from None
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="steering", daemon=True)
            self._thread.start()

    def _run(self) -> None:
        with self._changed:
            while True:
                for topic in self._switch.stops_due(time.monotonic()):
                    with suppress(LcmtoolsError):  # the page learns of it by its own commands
                        self._publish(topic, 0.0, 0.0)
                pause = self._switch.next_time - time.monotonic()
                if self._is_over and pause == inf:
                    return
                self._changed.wait(None if pause == inf else max(0.0, pause))

    def _publish(self, topic: str, forward: float, turn: float) -> None:
        kind, command = self._commands[topic]
        payload = command.payload(forward, turn, time.time_ns())
        self._publishers.publish(topic, message_class(kind), payload)
