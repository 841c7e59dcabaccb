"""A node of a plan with the process that runs it: its runs so far, its log, and how it ended."""

import math
import signal
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from lcmtools.launch.plan import NodePlan, Output
from lcmtools.packages.programs import RUN, startable
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_LONG_LIFE = 5.0  # [s]; a node that repeatedly dies sooner is restarted after increasing delays
_SLOWEST = 10.0  # [s], the longest of these


@dataclass(slots=True, eq=False)
class NodeProcess:
    """A node that runs, or has run."""

    plan: NodePlan
    number: int  # its position among the nodes, from 1
    folder: Path  # for its log file
    child: ChildProcess | None = None  # the process of its last run; None before the first
    code: int | None = None  # exit code of its last run, negative for a signal; None while it runs
    starts: int = 0  # number of starts
    started_at: float = 0.0  # monotonic time of the last start
    short_lives: int = 0  # number of latest runs in a row that ended soon
    due: float = math.inf  # monotonic time of the next start; infinity if none is planned
    is_draining: bool = False  # True if its process has ended, but perhaps not its whole group
    was_asked: bool = False  # True if it was asked to end
    failure: str = ""  # the reason why it could not be started, or ""
    _file: TextIO | None = None

    @property
    def label(self) -> str:
        """Its name in front of shown lines: ``husky0/driver-1``."""
        return f"{self.plan.name.strip('/')}-{self.number}"

    @property
    def log(self) -> str:
        """The path of its log file, ``husky0-driver-1.log``; "" if it has none."""
        if self.plan.output is Output.SCREEN or self.plan.takes_terminal:
            return ""
        return str(self.folder / f"{self.label.replace('/', '-')}.log")

    @property
    def is_running(self) -> bool:
        """True while its own process runs."""
        return self.child is not None and self.code is None

    @property
    def has_failed(self) -> bool:
        """True if it failed, was not asked to end, and will not be started again."""
        died = self.code not in (0, None) and not self.was_asked
        return bool(self.failure) or (died and not self.plan.respawn)

    def open_log(self) -> str:
        """Open its log file, once for all runs; return the error, or ""."""
        if self.log and not self.starts:
            try:
                self._file = Path(self.log).open("a", encoding="utf-8")  # noqa: SIM115 - see close_log
            except OSError as error:
                return f"cannot write {self.log}: {error.strerror}"
        return ""

    def write(self, text: str) -> str:
        """Write a line into its log file; return the first error, or ""."""
        try:
            if self._file:
                self._file.write(f"{text}\n")
                self._file.flush()
        except OSError as error:
            self._file = None
            return f"nothing more is written to {self.log}: {error.strerror}"
        return ""

    def close_log(self) -> None:
        """Close its log file."""
        if self._file:
            self._file.close()

    def start(
        self, environment: Mapping[str, str], guard: ProcessGuard, timeouts: StopTimeouts
    ) -> ChildProcess:
        """Start it; OSError if the system does not."""
        plan = self.plan
        start = Start(
            startable(plan.command),
            {**environment, **plan.environment},
            plan.directory,
            takes_input=plan.takes_input,
            takes_terminal=plan.takes_terminal,
            # else Ctrl-C while Python itself starts would print a traceback
            holds_interrupts=tuple(plan.command[: len(RUN)]) == RUN,
        )
        self.due = math.inf
        self.child = ChildProcess(start, guard, timeouts)
        self.code = None
        self.starts += 1
        self.started_at = time.monotonic()
        return self.child

    def has_just_ended(self) -> bool:
        """Return True once after the end of its own process."""
        if self.child is None or self.code is not None:
            return False
        self.code = self.child.code
        return self.code is not None

    def start_later(self, now: float) -> float:
        """Schedule a restart after some seconds, more if it keeps dying soon; return the delay."""
        self.short_lives = self.short_lives + 1 if now - self.started_at < _LONG_LIFE else 0
        slower = min(_SLOWEST, 0.5 * 2 ** (self.short_lives - 2)) if self.short_lives > 1 else 0.0
        delay = max(self.plan.respawn_delay, slower)
        self.due = now + delay
        return delay

    def end_text(self) -> str:
        """Return a text on the end of its last run."""
        if self.failure:
            return self.failure
        if self.code is None:
            return "not started"
        asked = " when asked to" if self.was_asked else ""
        if self.code < 0:
            return f"{'ended' if self.was_asked else 'died'} by {_signal_name(-self.code)}"
        if self.code == 0:
            return f"ended{asked}"
        return f"{'ended' if asked else 'died'} with exit code {self.code}{asked}"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
