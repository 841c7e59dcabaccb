"""Runs a plan: starts its processes, passes on what they write, starts them again, ends them.

Belongs here: what is done when. It has one thread, and waits for signals, ends and lines at once.
Must not know how anything is printed: a ``Watcher`` is told.
"""

import math
import signal
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from lcmtools.launch.journal import Journal
from lcmtools.launch.plan import NodePlan
from lcmtools.processes.process import Process, Times
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.processes.signals import Wakeup

_LOOK_AGAIN = 0.02
"""Seconds between looks at a group whose first process has ended."""
_LONG_LIFE = 5.0
"""Seconds; a node that lives shorter, again and again, is started again ever more slowly."""
_SLOWEST = 10.0
_TALK = ("[INFO] ", "[DEBUG] ")
"""How lines of a node's log begin that are no errors, although they are in the error stream."""


class Watcher(Protocol):
    """Whoever shows what happens.

    Both raise BrokenPipeError when nobody looks any more.
    """

    def line(self, process: Process, text: str, *, is_error: bool) -> None:
        """Show a line that a process has written."""

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Something has happened to the processes."""

    def stream(self, *, is_error: bool) -> int:
        """The descriptor that is written into; events go where errors go."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What has become of a node.

    Attributes:
        node: Its full name.
        code: The exit code of its last run, negative for a signal; None where it was not started.
        end: The same in words.
        has_failed: Whether it ended badly, without being asked to and without a new start.
        restarts: How often it was started again.
        log: Its log file, or "".
    """

    node: str
    code: int | None
    end: str
    has_failed: bool
    restarts: int
    log: str


def label(process: Process) -> str:
    """How a process is called where lines are shown: ``husky0/driver-1``."""
    return f"{process.plan.name.strip('/')}-{process.number}"


class Supervisor:
    """Runs processes until they have all ended, or are asked to.

    Args:
        nodes: What to run.
        environment: The variables of all of them.
        folder: For log files.
        watcher: Is told.
        times: How long signals are given.
    """

    def __init__(
        self,
        nodes: Sequence[NodePlan],
        environment: Mapping[str, str],
        folder: Path,
        watcher: Watcher,
        times: Times,
    ) -> None:
        self._processes = [Process(plan, i, times) for i, plan in enumerate(nodes, 1)]
        self._environment = environment
        self._watcher = watcher
        self._journal = Journal(folder)
        self._wakeup = Wakeup()
        self._due: dict[Process, float] = {}  # when those that wait are started again
        self._short_lives: dict[Process, int] = {}
        self._draining: set[Process] = set()
        self._failures: dict[Process, str] = {}
        self._is_stopping = False
        self._is_watched = True

    def run(self) -> list[Outcome]:
        """Run everything; what has become of each."""
        with self._wakeup, ProcessGuard() as keeper, self._journal:
            self._start_all(keeper)
            while self._due or self._draining or any(p.is_running for p in self._processes):
                self._turn(keeper)
        return [self._outcome(process) for process in self._processes]

    def _start_all(self, keeper: ProcessGuard) -> None:
        for process in self._processes:
            self._heed()
            if self._is_stopping:
                return
            self._start(process, keeper)

    def _turn(self, keeper: ProcessGuard) -> None:
        """Wait until something happens, and do what it takes."""
        of = {stream: process for process in self._processes for stream in process.streams()}
        for stream in self._wakeup.wait([*of], self._patience()):
            for is_error, text in of[stream].read(stream):
                self._take_line(of[stream], text, is_error=is_error)
        self._heed()
        now = time.monotonic()
        for process in self._processes:
            if process.poll():
                self._ended(process, now)
            if process in self._draining:
                self._drain(process, keeper, now)
            number = process.tick(now)
            if number is not None:
                self._tell(f"[{label(process)}] does not end: {number.name} is sent", is_bad=True)
            if self._due.get(process, math.inf) <= now:
                self._start(process, keeper)

    def _patience(self) -> float | None:
        """Seconds until something has to be done even if nothing happens."""
        if self._draining:
            return _LOOK_AGAIN
        times = [*self._due.values(), *(p.next_step for p in self._processes if p.is_running)]
        first = min(times, default=math.inf)
        return None if math.isinf(first) else first - time.monotonic()

    def _start(self, process: Process, keeper: ProcessGuard) -> None:
        self._due.pop(process, None)
        if failure := self._journal.begin(process):
            self._tell(f"[{label(process)}] {failure}", is_bad=True)
        try:
            process.start(self._environment, keeper.in_child(), time.monotonic())
        except OSError as error:
            self._failures[process] = f"cannot be started: {error.strerror}"
            self._tell(f"[{label(process)}] {self._failures[process]}", is_bad=True)
            self._stop()
            return
        again = " again" if process.starts > 1 else ""
        self._tell(f"[{label(process)}] started{again}, pid {process.pid}")

    def _heed(self) -> None:
        """Do what signals ask for: the first to end, each further one to end sooner."""
        for number in self._wakeup.take():
            if not self._is_stopping:
                again = " (Ctrl-C again: at once)" if number == signal.SIGINT else ""
                self._tell(f"asking all nodes to end{again}")
                self._stop()
            else:
                self._ask_all()

    def _stop(self) -> None:
        self._is_stopping = True
        self._due.clear()
        self._ask_all()

    def _ask_all(self) -> None:
        now = time.monotonic()
        for process in reversed(self._processes):  # those that were started last go first
            if process.is_running or process in self._draining:
                process.was_asked = process.was_asked or process.is_running
                process.ask_to_end(now)

    def _ended(self, process: Process, now: float) -> None:
        """A node's own process has ended; others of its group may be left."""
        self._draining.add(process)
        for stream in process.streams():  # its last words come before its end
            for is_error, text in process.read(stream):
                self._take_line(process, text, is_error=is_error)
        if not process.group_is_gone() and not process.was_asked:
            process.ask_to_end(now)
        if process.was_asked:
            return
        is_bad = process.code != 0
        self._tell(f"[{label(process)}] {end_text(process)}{self._hint(process)}", is_bad=is_bad)
        if process.plan.is_required and not self._is_stopping:
            self._tell(f"[{label(process)}] is required: asking all nodes to end")
            self._stop()

    def _drain(self, process: Process, keeper: ProcessGuard, now: float) -> None:
        """See to the end of a group."""
        if not process.group_is_gone():
            return
        self._draining.discard(process)
        process.settle()
        for is_error, text in process.rest():
            self._take_line(process, text, is_error=is_error)
        keeper.forget(process.pid)
        if process.was_asked:
            self._tell(f"[{label(process)}] {end_text(process)}")
        elif process.plan.respawn and not self._is_stopping:
            self._due[process] = now + self._delay(process, now)

    def _delay(self, process: Process, now: float) -> float:
        """Seconds until a node is started again: longer if it keeps dying young."""
        is_young = now - process.started_at < _LONG_LIFE
        young = self._short_lives.get(process, 0) + 1 if is_young else 0
        self._short_lives[process] = young
        slower = min(_SLOWEST, 0.5 * 2 ** (young - 2)) if young > 1 else 0.0
        delay = max(process.plan.respawn_delay, slower)
        if delay:
            self._tell(f"[{label(process)}] starts again in {delay:g} s")
        return delay

    def _take_line(self, process: Process, text: str, *, is_error: bool) -> None:
        failure = self._journal.write(process, text)
        if failure:
            self._tell(f"[{label(process)}] {failure}", is_bad=True)
        is_wrong = is_error and not text.startswith(_TALK)
        if is_wrong or self._journal.is_shown(process):
            self._show(
                lambda: self._watcher.line(process, text, is_error=is_error), is_error=is_error
            )

    def _tell(self, text: str, *, is_bad: bool = False) -> None:
        self._show(lambda: self._watcher.event(text, is_bad=is_bad), is_error=True)

    def _show(self, write: Callable[[], None], *, is_error: bool) -> None:
        """Show something, unless the screen takes nothing and there is something to do."""
        if not self._is_watched:
            return
        stream = self._watcher.stream(is_error=is_error)
        if self._wakeup.wait_writable(stream, is_patient=not self._is_stopping):
            try:
                write()
            except BrokenPipeError:
                self._leave()

    def _leave(self) -> None:
        """Nobody looks any more: end."""
        self._is_watched = False
        if not self._is_stopping:
            self._stop()

    def _hint(self, process: Process) -> str:
        log = self._journal.path(process)
        return f"; its log: {log}" if log and process.code else ""

    def _outcome(self, process: Process) -> Outcome:
        failure = self._failures.get(process, "")
        died = process.code not in (0, None) and not process.was_asked
        is_mended = process.plan.respawn  # or would have been, but for the end of all
        return Outcome(
            node=process.plan.name,
            code=process.code,
            end=failure or end_text(process),
            has_failed=bool(failure) or (died and not is_mended),
            restarts=max(0, process.starts - 1),
            log=self._journal.path(process),
        )


def end_text(process: Process) -> str:
    """How a process's last run has ended, in words."""
    if process.code is None:
        return "not started"
    asked = " when asked to" if process.was_asked else ""
    if process.code < 0:
        name = _signal_name(-process.code)
        return f"ended by {name}" if process.was_asked else f"died by {name}"
    if process.code == 0:
        return f"ended{asked}"
    verb = "ended" if process.was_asked else "died"
    return f"{verb} with exit code {process.code}{asked}"


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def base_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables of all nodes: Python's print comes at once, as it would on a terminal."""
    return {"PYTHONUNBUFFERED": "1", **environment}
