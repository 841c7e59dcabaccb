"""Runs a plan: starts its processes, passes on their lines, starts them again, ends them.

Belongs here: the order of things. It has one thread, and waits for signals, ends and lines at once.
Must not know how anything is printed: that is a ``Watcher``'s.
"""

import math
import signal
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from lcmtools.launch.logs import Journal
from lcmtools.launch.node_process import NodeProcess
from lcmtools.launch.plan import NodePlan, Output
from lcmtools.processes.child import StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.processes.signal_waiter import SignalWaiter

_LOOK_AGAIN = 0.02
"""Seconds between looks at a group whose first process has ended."""
_LONG_LIFE = 5.0
"""Seconds; a node that keeps dying sooner is started again after ever longer delays."""
_SLOWEST = 10.0
_TALK = ("[INFO] ", "[DEBUG] ")
"""The beginnings of log lines that are no errors, although they are in the error stream."""


class Watcher(Protocol):
    """Shows what happens; both methods that show raise BrokenPipeError when nothing reads."""

    def line(self, node: NodeProcess, text: str, *, is_error: bool) -> None:
        """Show a line that a node has written."""

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Show an event."""

    def stream(self, *, is_error: bool) -> int:
        """Return the descriptor for lines; events go where errors go."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The end of a node.

    Attributes:
        node: Its full name.
        code: The exit code of its last run, negative for a signal; None if it was not started.
        end: The same in words.
        has_failed: True if it failed, was not asked to end, and was not started again.
        restarts: Number of further starts.
        log: Its log file, or "".
    """

    node: str
    code: int | None
    end: str
    has_failed: bool
    restarts: int
    log: str


class Supervisor:
    """Runs processes until they have all ended, or are asked to end.

    Args:
        nodes: The nodes to run.
        environment: The variables of all of them.
        folder: For log files.
        watcher: Shows lines and events.
        timeouts: For the signals that end a process.
    """

    def __init__(
        self,
        nodes: Sequence[NodePlan],
        environment: Mapping[str, str],
        folder: Path,
        watcher: Watcher,
        timeouts: StopTimeouts,
    ) -> None:
        self._nodes = [NodeProcess(plan, i) for i, plan in enumerate(nodes, 1)]
        self._environment = environment
        self._watcher = watcher
        self._timeouts = timeouts
        self._journal = Journal(folder)
        self._signals = SignalWaiter()
        self._due: dict[NodeProcess, float] = {}  # times of further starts
        self._short_lives: dict[NodeProcess, int] = {}
        self._draining: set[NodeProcess] = set()  # ended, but perhaps not all of its group
        self._is_stopping = False
        self._is_watched = True

    def run(self) -> list[Outcome]:
        """Run everything; return the end of each node."""
        with self._signals, ProcessGuard() as guard, self._journal:
            for node in self._nodes:
                self._handle_signals()
                if self._is_stopping:
                    break
                self._start(node, guard)
            while self._due or self._draining or any(node.is_running for node in self._nodes):
                self._turn(guard)
        return [self._outcome(node) for node in self._nodes]

    def _turn(self, guard: ProcessGuard) -> None:
        """Wait until something happens, and handle it."""
        children = [(node, node.child) for node in self._nodes if node.child]
        of = {stream: (node, child) for node, child in children for stream in child.streams}
        for stream in self._signals.wait([*of], self._patience()):
            node, child = of[stream]
            self._take_lines(node, child.read(stream))
        self._handle_signals()
        now = time.monotonic()
        for node in self._nodes:
            if node.has_just_ended():
                self._ended(node, now)
            if node in self._draining:
                self._drain(node, now)
            if node.child and (number := node.child.tick(now)) is not None:
                self._tell(f"[{node.label}] does not end: {number.name} is sent", is_bad=True)
            if self._due.get(node, math.inf) <= now:
                self._start(node, guard)

    def _patience(self) -> float | None:
        """Return the seconds until something has to be done even if nothing happens."""
        if self._draining:
            return _LOOK_AGAIN
        steps = [node.child.next_step for node in self._nodes if node.child and node.is_running]
        first = min([*self._due.values(), *steps], default=math.inf)
        return None if math.isinf(first) else first - time.monotonic()

    def _start(self, node: NodeProcess, guard: ProcessGuard) -> None:
        self._due.pop(node, None)
        if error := self._journal.begin(node):
            self._tell(f"[{node.label}] {error}", is_bad=True)
        try:
            child = node.start(self._environment, guard, self._timeouts)
        except OSError as error:
            node.failure = f"cannot be started: {error.strerror}"
            self._tell(f"[{node.label}] {node.failure}", is_bad=True)
            self._stop()
            return
        again = " again" if node.starts > 1 else ""
        self._tell(f"[{node.label}] started{again}, pid {child.pid}")

    def _handle_signals(self) -> None:
        """The first signal asks all nodes to end, each further one to end sooner."""
        for number in self._signals.take():
            if self._is_stopping:
                self._ask_all()
                continue
            again = " (Ctrl-C again: at once)" if number == signal.SIGINT else ""
            self._tell(f"asking all nodes to end{again}")
            self._stop()

    def _stop(self) -> None:
        self._is_stopping = True
        self._due.clear()
        self._ask_all()

    def _ask_all(self) -> None:
        now = time.monotonic()
        for node in reversed(self._nodes):  # those that were started last go first
            if node.child and (node.is_running or node in self._draining):
                node.was_asked = node.was_asked or node.is_running
                node.child.ask_to_end(now)

    def _ended(self, node: NodeProcess, now: float) -> None:
        """A node's own process has ended; others of its group may be left."""
        child = node.child
        assert child is not None
        self._draining.add(node)
        for stream in child.streams:  # its last lines come before its end
            self._take_lines(node, child.read(stream))
        if node.was_asked:
            return
        if not child.group_is_gone():
            child.ask_to_end(now)
        log = self._journal.path(node) if node.code else ""
        text = f"[{node.label}] {node.end_text()}{f'; its log: {log}' if log else ''}"
        self._tell(text, is_bad=node.code != 0)
        if node.plan.is_required and not self._is_stopping:
            self._tell(f"[{node.label}] is required: asking all nodes to end")
            self._stop()

    def _drain(self, node: NodeProcess, now: float) -> None:
        """Wait for the end of a group."""
        child = node.child
        if child is None or not child.group_is_gone():
            return
        self._draining.discard(node)
        self._take_lines(node, child.rest())
        child.release()
        if node.was_asked:
            self._tell(f"[{node.label}] {node.end_text()}")
        elif node.plan.respawn and not self._is_stopping:
            self._due[node] = now + self._delay(node, now)

    def _delay(self, node: NodeProcess, now: float) -> float:
        """Return the seconds until a node is started again: more if it keeps dying young."""
        is_young = now - node.started_at < _LONG_LIFE
        young = self._short_lives.get(node, 0) + 1 if is_young else 0
        self._short_lives[node] = young
        slower = min(_SLOWEST, 0.5 * 2 ** (young - 2)) if young > 1 else 0.0
        delay = max(node.plan.respawn_delay, slower)
        if delay:
            self._tell(f"[{node.label}] starts again in {delay:g} s")
        return delay

    def _take_lines(self, node: NodeProcess, lines: Iterable[tuple[bool, str]]) -> None:
        for is_error, text in lines:
            if error := self._journal.write(node, text):
                self._tell(f"[{node.label}] {error}", is_bad=True)
            is_wrong = is_error and not text.startswith(_TALK)
            if is_wrong or node.plan.output is not Output.LOG:
                show = partial(self._watcher.line, node, text, is_error=is_error)
                self._show(show, is_error=is_error)

    def _tell(self, text: str, *, is_bad: bool = False) -> None:
        self._show(lambda: self._watcher.event(text, is_bad=is_bad), is_error=True)

    def _show(self, write: Callable[[], None], *, is_error: bool) -> None:
        """Show something, unless the screen takes nothing while the nodes are to end."""
        if not self._is_watched:
            return
        stream = self._watcher.stream(is_error=is_error)
        if not self._signals.wait_writable(stream, is_patient=not self._is_stopping):
            return
        try:
            write()
        except BrokenPipeError:  # nothing reads any more: end
            self._is_watched = False
            if not self._is_stopping:
                self._stop()

    def _outcome(self, node: NodeProcess) -> Outcome:
        died = node.code not in (0, None) and not node.was_asked
        return Outcome(
            node=node.plan.name,
            code=node.code,
            end=node.end_text(),
            has_failed=bool(node.failure) or (died and not node.plan.respawn),
            restarts=max(0, node.starts - 1),
            log=self._journal.path(node),
        )
