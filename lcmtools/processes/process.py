"""One node's process: started, listened to, asked to end.

Belongs here: what is known of one, and the ladder of signals that ends it. When to do what is the
supervisor's business.
"""

import contextlib
import os
import signal
import subprocess
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import IO

from lcmtools.launch.executables import startable
from lcmtools.launch.plan import NodePlan
from lcmtools.processes.groups import is_gone, send
from lcmtools.processes.lines import Lines

_PIECE = 65_536
_MOST_PIECES = 100
"""What is left in a pipe is less."""


@dataclass(frozen=True, slots=True)
class Times:
    """How long each signal is given, in seconds.

    Attributes:
        interrupt: From SIGINT to SIGTERM.
        terminate: From SIGTERM to SIGKILL.
    """

    interrupt: float = 15.0
    terminate: float = 2.0


class Process:
    """A node that runs, or has run.

    Attributes:
        plan: What was asked for.
        number: Its place among the nodes, from 1.
        pid: Its process; its group has the same number. 0 before the first start.
        code: The exit code of the last run, negative for a signal; None while it runs.
        starts: How often it was started.
        started_at: When it was started last.
        was_asked: Whether it was asked to end.
    """

    def __init__(self, plan: NodePlan, number: int, times: Times) -> None:
        self.plan = plan
        self.number = number
        self.pid = 0
        self.code: int | None = None
        self.starts = 0
        self.started_at = 0.0
        self.was_asked = False
        self.was_killed = False
        self._times = times
        self._popen: subprocess.Popen[bytes] | None = None
        self._lines: dict[int, tuple[IO[bytes], Lines, bool]] = {}
        self._ladder: list[tuple[signal.Signals, float]] = []
        self._next_step = float("inf")

    def start(self, environment: Mapping[str, str], bind: Callable[[], None], now: float) -> None:
        """Start it, in a group and session of its own.

        Raises:
            OSError: The system does not start it.
        """
        plan = self.plan
        takes_input = plan.takes_input or plan.takes_terminal
        self._popen = subprocess.Popen(  # noqa: S603 - the user's own
            startable(plan.command),
            env={**environment, **plan.environment},
            cwd=plan.directory or None,
            stdin=None if takes_input else subprocess.DEVNULL,
            stdout=None if plan.takes_terminal else subprocess.PIPE,
            stderr=None if plan.takes_terminal else subprocess.PIPE,
            start_new_session=True,
            preexec_fn=bind,  # noqa: PLW1509 - there is one thread
        )
        self.pid, self.code = self._popen.pid, None
        self.starts += 1
        self.started_at = now
        for stream, is_error in ((self._popen.stdout, False), (self._popen.stderr, True)):
            if stream is not None:
                os.set_blocking(stream.fileno(), False)
                self._lines[stream.fileno()] = (stream, Lines(), is_error)

    @property
    def is_running(self) -> bool:
        """Whether its own process runs."""
        return self._popen is not None and self.code is None

    def streams(self) -> list[int]:
        """The descriptors that it writes into."""
        return list(self._lines)

    def read(self, stream: int) -> Iterator[tuple[bool, str]]:
        """The lines that have come, each with whether it is of the error stream."""
        _, lines, is_error = self._lines[stream]
        try:
            piece = os.read(stream, _PIECE)
        except BlockingIOError:
            return
        for line in lines.take(piece) if piece else lines.end():
            yield is_error, line
        if not piece:
            self._close(stream)

    def rest(self) -> Iterator[tuple[bool, str]]:
        """What is left to read; what it has started and left behind may still hold the streams."""
        for stream in self.streams():
            _, lines, is_error = self._lines[stream]
            with contextlib.suppress(BlockingIOError):
                for _ in range(_MOST_PIECES):
                    yield from ((is_error, line) for line in lines.take(os.read(stream, _PIECE)))
            yield from ((is_error, line) for line in lines.end())
            self._close(stream)

    def poll(self) -> bool:
        """Look whether its own process has ended just now."""
        if self._popen is None or self.code is not None or self._popen.poll() is None:
            return False
        self.code = self._popen.returncode
        return True

    def group_is_gone(self) -> bool:
        """Whether nothing of its group is left."""
        return is_gone(self.pid)

    def ask_to_end(self, now: float) -> None:
        """Begin with the signals that end it, or go on to the next one at once."""
        if not self._ladder and self._next_step == float("inf"):
            times = self._times
            self._ladder = [
                (signal.SIGINT, times.interrupt),
                (signal.SIGTERM, times.terminate),
                (signal.SIGKILL, float("inf")),
            ]
        self._step(now)

    def tick(self, now: float) -> signal.Signals | None:
        """Send the next signal if it is time for it; which."""
        return self._step(now) if now >= self._next_step else None

    def settle(self) -> None:
        """Forget the signals: it is gone."""
        self._ladder, self._next_step = [], float("inf")

    @property
    def next_step(self) -> float:
        """When the next signal is due."""
        return self._next_step

    def _step(self, now: float) -> signal.Signals | None:
        if not self._ladder:
            return None
        number, patience = self._ladder.pop(0)
        self._next_step = now + patience
        self.was_killed = self.was_killed or number is signal.SIGKILL
        send(self.pid, number)
        return number

    def _close(self, stream: int) -> None:
        self._lines.pop(stream)[0].close()
