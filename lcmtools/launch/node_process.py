"""A node of a plan with the process that runs it: its runs so far, and its end in words."""

import signal
import time
from collections.abc import Mapping

from lcmtools.launch.executables import startable
from lcmtools.launch.plan import NodePlan
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard


class NodeProcess:
    """A node that runs, or has run.

    Attributes:
        plan: Its plan.
        number: Its place among the nodes, from 1.
        child: The process of its last run; None before the first.
        code: The exit code of its last run, negative for a signal; None while it runs.
        starts: Number of starts.
        started_at: Monotonic time of the last start.
        was_asked: True if it was asked to end.
        failure: The reason why it could not be started, or "".
    """

    def __init__(self, plan: NodePlan, number: int) -> None:
        self.plan = plan
        self.number = number
        self.child: ChildProcess | None = None
        self.code: int | None = None
        self.starts = 0
        self.started_at = 0.0
        self.was_asked = False
        self.failure = ""

    @property
    def label(self) -> str:
        """Its name where lines are shown: ``husky0/driver-1``."""
        return f"{self.plan.name.strip('/')}-{self.number}"

    @property
    def is_running(self) -> bool:
        """True while its own process runs."""
        return self.child is not None and self.code is None

    def start(
        self, environment: Mapping[str, str], guard: ProcessGuard, timeouts: StopTimeouts
    ) -> ChildProcess:
        """Start it.

        Raises:
            OSError: The system does not start it.
        """
        plan = self.plan
        start = Start(
            startable(plan.command),
            {**environment, **plan.environment},
            plan.directory,
            takes_input=plan.takes_input,
            takes_terminal=plan.takes_terminal,
        )
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

    def end_text(self) -> str:
        """Return the end of its last run in words."""
        if self.failure:
            return self.failure
        if self.code is None:
            return "not started"
        asked = " when asked to" if self.was_asked else ""
        if self.code < 0:
            name = _signal_name(-self.code)
            return f"ended by {name}" if self.was_asked else f"died by {name}"
        if self.code == 0:
            return f"ended{asked}"
        return f"{'ended' if asked else 'died'} with exit code {self.code}{asked}"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
