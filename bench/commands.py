"""Parts of the benchmarks of whole commands: running them, and watching those that go on.

Belongs here: processes as a shell would start them, their output and their processor time. Must not
know whose commands they are.
"""

import os
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import nan
from pathlib import Path
from signal import SIGINT, SIGKILL, SIGTERM
from statistics import median
from typing import TypeVar

from common import bus, processor_time

TOOL = str(Path(sys.executable).parent / "lcmtools")
_SETTLING = 1.0  # [s] for the talker and the listener to start, or a command to find its rhythm
_PATIENCE = 20.0  # [s] for a command to print something, or to end
_FOREIGN = ("PYTHON", "LCM_", "LCMTOOLS_", "ROS_")

Environment = Mapping[str, str]
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Run:
    """One run of a command: wall and processor time [s], exit code, and what it printed."""

    wall: float
    processor: float
    code: int
    output: str = ""


@dataclass(frozen=True, slots=True)
class Flow:
    """The work of a command that goes on, in a while.

    Attributes:
        messages: How many it printed.
        processor: Processor time that it used [s].
        wall: How long the while was [s].
        output: All that it has printed since its start.
    """

    messages: int
    processor: float
    wall: float
    output: str

    @property
    def rate(self) -> float:
        """Messages printed a second [Hz]."""
        return self.messages / self.wall

    @property
    def share(self) -> float:
        """Processor time used, in percent of one core."""
        return 100 * self.processor / self.wall

    @property
    def cost(self) -> float:
        """Processor time for one message [us]."""
        return 1e6 * self.processor / self.messages if self.messages else nan


def child_environment(cache: str, port: int = 7792) -> dict[str, str]:
    """The environment of a user's shell: Python keeps its bytecode, in a folder of our own."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(_FOREIGN)}
    return {**kept, "PYTHONPYCACHEPREFIX": cache, "LCM_DEFAULT_URL": bus(port)}


def start(command: Sequence[str], environment: Environment, output: str = os.devnull) -> int:
    """Start a command, its output in a file, its complaints thrown away; return its pid."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    files = [
        (os.POSIX_SPAWN_OPEN, 1, output, flags, 0o600),
        (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
    ]
    return os.posix_spawn(command[0], list(command), environment, file_actions=files)


def run(command: Sequence[str], environment: Environment) -> Run:
    """Run a command to its end."""
    with tempfile.NamedTemporaryFile() as output:
        begin = time.perf_counter()
        _, status, usage = os.wait4(start(command, environment, output.name), 0)
        wall = time.perf_counter() - begin
        text = output.read().decode(errors="replace")
    return Run(wall, usage.ru_utime + usage.ru_stime, os.waitstatus_to_exitcode(status), text)


def watch(
    command: Sequence[str], environment: Environment, mark: str, seconds: float, ready: str = ""
) -> Flow:
    """Watch a command that goes on, from when it runs smoothly.

    Args:
        command: What to start; it is ended with Ctrl-C.
        environment: Its environment variables.
        mark: A pattern that matches once in each message printed, at a line's start.
        seconds: How long to watch it.
        ready: A pattern in the output from which on it runs; "" for the mark.
    """
    pattern, begun = (re.compile(text.encode(), re.MULTILINE) for text in (mark, ready or mark))
    with tempfile.NamedTemporaryFile() as output:
        pid = start(command, environment, output.name)
        try:
            _await(lambda: begun.search(_content(output.name)) is not None, " ".join(command))
            time.sleep(_SETTLING / 2)
            before = time.perf_counter(), processor_time(pid), Path(output.name).stat().st_size
            time.sleep(seconds)
            after = time.perf_counter(), processor_time(pid), Path(output.name).stat().st_size
        finally:
            end(pid, SIGINT)
        text = _content(output.name)
    count = len(pattern.findall(text[before[2] : after[2]]))
    return Flow(count, after[1] - before[1], after[0] - before[0], text.decode(errors="replace"))


def end(pid: int, number: int = SIGTERM) -> None:
    """End a command with a signal; with SIGKILL where it does not."""
    os.kill(pid, number)
    deadline = time.monotonic() + _PATIENCE
    while os.waitpid(pid, os.WNOHANG)[0] == 0:
        time.sleep(0.02)
        if time.monotonic() > deadline:
            os.kill(pid, SIGKILL)


@contextmanager
def running(commands: Sequence[Sequence[str]], environment: Environment) -> Iterator[None]:
    """Commands in the background, while the block runs."""
    pids = [start(command, environment) for command in commands]
    try:
        time.sleep(_SETTLING)
        yield
    finally:
        for pid in pids:
            end(pid)


@contextmanager
def talking(environment: Environment) -> Iterator[None]:
    """A talker and a listener, while the block runs."""
    with running([[TOOL, "run", name] for name in ("talker", "listener")], environment):
        yield


def in_turn(sides: Mapping[str, Callable[[], Result]], rounds: int) -> dict[str, list[Result]]:
    """The results of each side, round after round; the first round warms up and does not count."""
    found: dict[str, list[Result]] = {label: [] for label in sides}
    for _ in range(1 + rounds):
        for label, measure in sides.items():
            found[label].append(measure())
    return {label: results[1:] for label, results in found.items()}


def middle(results: Sequence[Result], value: Callable[[Result], float]) -> float:
    """The median of one value of all results."""
    return median(value(result) for result in results)


def _await(is_so: Callable[[], bool], whom: str) -> None:
    """Wait until a command has made something so.

    Raises:
        TimeoutError: It never is.
    """
    deadline = time.monotonic() + _PATIENCE
    while not is_so():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{whom}: it does not print what it should")
        time.sleep(0.02)


def _content(path: str) -> bytes:
    return Path(path).read_bytes()
