"""How long commands take from the shell, beside Python itself.

Each command runs in turn, round after round, on a bus with a talker at 10 Hz and a listener;
shown are medians of wall time and of processor time (user and system), and their ratios to
``python -c pass``. Bytecode is compiled before, as it is for every user after the first run.
``list``, ``info`` and ``type`` wait deliberately for nodes to answer, ``echo -n 1`` for a message.
"""

import os
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from signal import SIGTERM
from statistics import median

from common import bus, isolate, parser, show

_TOOL = str(Path(sys.executable).parent / "lcmtools")
_COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "python -c 'import click'": [sys.executable, "-c", "import click"],
    "lcmtools --help": [_TOOL, "--help"],
    "lcmtools msg show": [_TOOL, "msg", "show", "geometry_msgs/Twist"],
    "lcmtools list": [_TOOL, "list"],
    "lcmtools node list": [_TOOL, "node", "list"],
    "lcmtools info": [_TOOL, "info", "/chatter"],
    "lcmtools type": [_TOOL, "type", "/chatter"],
    "lcmtools pub -1": [_TOOL, "pub", "-1", "/chatter", "std_msgs/String", "data: hello"],
    "lcmtools echo -n 1": [_TOOL, "echo", "-n", "1", "/chatter"],
}
_SETTLING = 1.0  # [s] for the talker and the listener to start


@dataclass(frozen=True, slots=True)
class Run:
    """One run of a command: wall and processor time [s], and its exit code."""

    wall: float
    processor: float
    code: int


def start(command: list[str], environment: Mapping[str, str]) -> int:
    """Start a command, its output thrown away; return its pid."""
    quiet = [(os.POSIX_SPAWN_OPEN, descriptor, os.devnull, os.O_WRONLY, 0) for descriptor in (1, 2)]
    return os.posix_spawn(command[0], command, environment, file_actions=quiet)


def run(command: list[str], environment: Mapping[str, str]) -> Run:
    """Run a command to its end."""
    begin = time.perf_counter()
    _, status, usage = os.wait4(start(command, environment), 0)
    wall = time.perf_counter() - begin
    return Run(wall, usage.ru_utime + usage.ru_stime, os.waitstatus_to_exitcode(status))


def child_environment(cache: str) -> dict[str, str]:
    """What a user's shell has: Python keeps its bytecode (here: in a folder of our own)."""
    foreign = ("PYTHON", "LCM_", "LCMTOOLS_")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(foreign)}
    return {**kept, "PYTHONPYCACHEPREFIX": cache, "LCM_DEFAULT_URL": bus(7792)}


@contextmanager
def talking(environment: Mapping[str, str]) -> Iterator[None]:
    """A talker and a listener, while the block runs."""
    pids = [start([_TOOL, "run", name], environment) for name in ("talker", "listener")]
    try:
        time.sleep(_SETTLING)
        yield
    finally:
        for pid in pids:
            os.kill(pid, SIGTERM)
            os.waitpid(pid, 0)


def measure(rounds: int) -> dict[str, list[Run]]:
    """Every command, round after round; the first round compiles and does not count."""
    runs: dict[str, list[Run]] = {label: [] for label in _COMMANDS}
    with tempfile.TemporaryDirectory() as cache:
        environment = child_environment(cache)
        with talking(environment):
            for _ in range(1 + rounds):
                for label, command in _COMMANDS.items():
                    runs[label].append(run(command, environment))
    return {label: found[1:] for label, found in runs.items()}


def rows(runs: Mapping[str, Sequence[Run]]) -> list[list[object]]:
    """The table: times in milliseconds, ratios to the first line."""
    table: list[list[object]] = []
    for label, found in runs.items():
        wall = median(one.wall for one in found) * 1000
        processor = median(one.processor for one in found) * 1000
        bare = table[0] if table else [label, wall, 1, processor]
        failures = sum(one.code != 0 for one in found)
        ratios = wall / float(str(bare[1])), processor / float(str(bare[3]))
        table.append([label, wall, ratios[0], processor, ratios[1], failures])
    return table


def main() -> None:
    """Measure and print."""
    options = parser(__doc__)
    options.add_argument("--rounds", type=int, default=21)
    rounds = options.parse_args().rounds
    isolate()
    show(
        f"From the shell, medians of {rounds} runs",
        ["command", "wall ms", "ratio", "CPU ms", "ratio", "failed"],
        rows(measure(rounds)),
    )


if __name__ == "__main__":
    main()
