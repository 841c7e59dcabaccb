"""Runs a plan: starts its processes, passes on their output, restarts and ends them.

Belongs here: the order of events. It has one thread, which waits for signals, ends and lines at
once. Must not know how anything is printed: that is up to a ``Watcher``.
"""

import signal
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import Protocol

from lcmtools.launch.node_process import NodeProcess
from lcmtools.launch.plan import NodePlan, Output
from lcmtools.processes.child import StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.processes.signal_waiter import SignalWaiter

_LOOK_AGAIN = 0.02  # seconds between checks of a process group whose first process has ended
_TALK = ("[INFO] ", "[DEBUG] ")
"""The prefixes of log lines that are not errors, although they are in the error stream."""


class Watcher(Protocol):
    """Shows lines and events; ``line`` and ``event`` raise BrokenPipeError if nothing reads."""

    def line(self, node: NodeProcess, text: str, *, is_error: bool) -> None:
        """Show a line that a node has written."""

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Show an event."""

    def stream(self, *, is_error: bool) -> int:
        """Return the descriptor for lines; events go to the same one as errors."""


class Supervisor:
    """Runs processes until they have all ended, or are asked to; ``folder`` is for log files."""

    def __init__(
        self,
        nodes: Sequence[NodePlan],
        environment: Mapping[str, str],
        folder: Path,
        watcher: Watcher,
        timeouts: StopTimeouts,
    ) -> None:
        self._nodes = [NodeProcess(plan, i, folder) for i, plan in enumerate(nodes, 1)]
        self._environment, self._watcher, self._timeouts = environment, watcher, timeouts
        self._signals = SignalWaiter()
        self._is_stopping, self._is_watched = False, True

    def run(self) -> Sequence[NodeProcess]:
        """Run everything; return the nodes after they have ended."""
        with self._signals, ProcessGuard() as guard, ExitStack() as logs:
            for node in self._nodes:
                logs.callback(node.close_log)
                self._handle_signals()
                if self._is_stopping:
                    break
                self._start(node, guard)
            while any(n.is_running or n.is_draining or isfinite(n.due) for n in self._nodes):
                self._turn(guard)
        return self._nodes

    def _turn(self, guard: ProcessGuard) -> None:
        children = [(node, node.child) for node in self._nodes if node.child]
        of = {stream: (node, child) for node, child in children for stream in child.streams}
        for stream in self._signals.wait([*of], self._patience()):
            node, child = of[stream]
            self._pass_on_lines(node, child.read(stream))
        self._handle_signals()
        now = time.monotonic()
        for node in self._nodes:
            if node.has_just_ended():
                self._ended(node, now)
            if node.is_draining:
                self._drain(node, now)
            if node.child and (number := node.child.tick(now)) is not None:
                self._notify(f"[{node.label}] does not end: sending {number.name}", is_bad=True)
            if node.due <= now:
                self._start(node, guard)

    def _patience(self) -> float | None:
        """Return the seconds until work is due even if nothing happens."""
        if any(node.is_draining for node in self._nodes):
            return _LOOK_AGAIN
        steps = [node.child.next_step for node in self._nodes if node.child and node.is_running]
        first = min(steps + [node.due for node in self._nodes])
        return first - time.monotonic() if isfinite(first) else None

    def _start(self, node: NodeProcess, guard: ProcessGuard) -> None:
        if error := node.open_log():
            self._notify(f"[{node.label}] {error}", is_bad=True)
        try:
            child = node.start(self._environment, guard, self._timeouts)
        except OSError as error:
            node.failure = f"cannot be started: {error.strerror}"
            self._notify(f"[{node.label}] {node.failure}", is_bad=True)
            self._stop()
            return
        again = " again" if node.starts > 1 else ""
        self._notify(f"[{node.label}] started{again}, pid {child.pid}")

    def _handle_signals(self) -> None:
        """Handle signals: the first asks all nodes to end, each further one to end sooner."""
        for number in self._signals.pop():
            if self._is_stopping:
                self._ask_all()
                continue
            again = " (Ctrl-C again: at once)" if number == signal.SIGINT else ""
            self._notify(f"asking all nodes to end{again}")
            self._stop()

    def _stop(self) -> None:
        self._is_stopping = True
        for node in self._nodes:
            node.due = inf
        self._ask_all()

    def _ask_all(self) -> None:
        now = time.monotonic()
        for node in reversed(self._nodes):  # in reverse order of their starts
            if node.child and (node.is_running or node.is_draining):
                node.was_asked = node.was_asked or node.is_running
                node.child.ask_to_end(now)

    def _ended(self, node: NodeProcess, now: float) -> None:
        """Handle the end of a node's own process; others of its group may be left."""
        child = node.child
        assert child is not None
        node.is_draining = True
        for stream in child.streams:  # its last lines are shown before its end
            self._pass_on_lines(node, child.read(stream))
        if node.was_asked:
            return
        if not child.group_is_gone():
            child.ask_to_end(now)
        log = node.log if node.code else ""
        text = f"[{node.label}] {node.end_text()}{f'; its log: {log}' if log else ''}"
        self._notify(text, is_bad=node.code != 0)
        if node.plan.is_required and not self._is_stopping:
            self._notify(f"[{node.label}] is required: asking all nodes to end")
            self._stop()

    def _drain(self, node: NodeProcess, now: float) -> None:
        child = node.child
        if child is None or not child.group_is_gone():
            return
        node.is_draining = False
        self._pass_on_lines(node, child.rest())
        child.release()
        if node.was_asked:
            self._notify(f"[{node.label}] {node.end_text()}")
        elif node.plan.respawn and not self._is_stopping:
            delay = node.start_later(now)
            if delay:
                self._notify(f"[{node.label}] starts again in {delay:g} s")

    def _pass_on_lines(self, node: NodeProcess, lines: Iterable[tuple[bool, str]]) -> None:
        for is_error, text in lines:
            if error := node.write(text):
                self._notify(f"[{node.label}] {error}", is_bad=True)
            is_wrong = is_error and not text.startswith(_TALK)
            if is_wrong or node.plan.output is not Output.LOG:
                show = partial(self._watcher.line, node, text, is_error=is_error)
                self._show(show, is_error=is_error)

    def _notify(self, text: str, *, is_bad: bool = False) -> None:
        self._show(lambda: self._watcher.event(text, is_bad=is_bad), is_error=True)

    def _show(self, write: Callable[[], None], *, is_error: bool) -> None:
        """Show something, unless the screen accepts nothing while the nodes are being ended."""
        if not self._is_watched:
            return
        stream = self._watcher.stream(is_error=is_error)
        if not self._signals.wait_writable(stream, is_patient=not self._is_stopping):
            return
        try:
            write()
        except BrokenPipeError:  # nothing reads the output any more: end
            self._is_watched = False
            if not self._is_stopping:
                self._stop()
