"""Parts of all benchmarks: a network of their own, child processes, and tables.

A benchmark asserts nothing: it measures two ways of doing the same thing side by side in one run
and prints the ratio, so that a busy computer disturbs both alike.
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import isnan, nan
from multiprocessing import get_context
from multiprocessing.connection import Connection

GROUP = "239.255.76.67"
_ISOLATED = "LCMTOOLS_BENCH_ISOLATED"
_LOOPBACK = (
    "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo"
    ' && exec "$@"'
)
_FEW = 3  # rounds
_PATIENCE = 30.0  # [s] for a child to get ready or to report


def parser(docstring: str | None) -> argparse.ArgumentParser:
    """A command line parser whose ``--help`` is the script's docstring."""
    return argparse.ArgumentParser(
        description=docstring, formatter_class=argparse.RawDescriptionHelpFormatter
    )


def rounds_asked(docstring: str | None, usual: int) -> int:
    """The number of rounds: ``--rounds N``, or ``--quick`` for a few."""
    options = parser(docstring)
    options.add_argument("--rounds", type=int, default=usual, help="default: %(default)s")
    options.add_argument("--quick", action="store_true", help="a few rounds: rough figures")
    arguments = options.parse_args()
    rounds: int = arguments.rounds
    return min(_FEW, rounds) if arguments.quick else rounds


def bus(port: int, **options: int) -> str:
    """The URL of a bus that stays on this computer."""
    extra = "".join(f"&{key}={value}" for key, value in options.items())
    return f"udpm://{GROUP}:{port}?ttl=0{extra}"


def isolate() -> bool:
    """Start this script again in a network namespace of its own, if the system permits it.

    Returns:
        Whether the network is the script's own; False (with a word about it) where the system
        does not permit it, and the loopback of this computer has to do.
    """
    if _ISOLATED in os.environ:
        return True
    for flags in ("-n", "-rn"):  # as root; as a user, where that is allowed
        command = ["unshare", flags, "sh", "-c", _LOOPBACK, "sh"]
        if _succeeds([*command, "true"]):
            sys.stdout.flush()
            os.environ[_ISOLATED] = "1"
            os.execvp("unshare", [*command, sys.executable, *sys.argv])  # noqa: S606, S607
    print("(no network namespace permitted: on this computer's loopback, at modest rates)")
    return False


def _succeeds(command: Sequence[str]) -> bool:
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


@dataclass(frozen=True, slots=True)
class Child:
    """A function that runs in a process of its own, at the other end of ``connection``."""

    connection: Connection
    pid: int

    def wait(self) -> object:
        """The child's next message: that it is ready, or its result.

        Raises:
            TimeoutError: Nothing comes.
        """
        if not self.connection.poll(_PATIENCE):
            raise TimeoutError("a child process does not answer")
        return self.connection.recv()

    def processor_time(self) -> float:
        """Processor time that it has used so far, all threads together [s]."""
        return processor_time(self.pid)


@contextmanager
def child(role: Callable[..., None], *arguments: object) -> Iterator[Child]:
    """Run ``role(connection, *arguments)`` in a fresh Python process while the block runs.

    The child is asked to end by SIGTERM, which makes ``lcmtools.spin`` return.

    Raises:
        RuntimeError: It failed, so that what was measured beside it is worth nothing.
    """
    context = get_context("spawn")  # liblcm's threads do not survive a fork
    here, there = context.Pipe()
    process = context.Process(target=role, args=(there, *arguments))
    process.start()
    there.close()
    assert process.pid is not None
    try:
        yield Child(here, process.pid)
    finally:
        process.terminate()
        process.join(5.0)
        process.kill()
        process.join()
    if process.exitcode and process.exitcode > 0:
        raise RuntimeError(f"the child process {role.__name__} failed")


def processor_time(pid: int) -> float:
    """Processor time that a process has used so far, all threads together [s]."""
    return time.clock_gettime(~pid << 3 | 2)  # as clock_getcpuclockid(3) makes it


def every(period: float, seconds: float) -> Iterator[int]:
    """Count up at a fixed rate, without drift, for some time."""
    start = time.monotonic()
    for count in range(round(seconds / period)):
        time.sleep(max(0.0, start + count * period - time.monotonic()))
        yield count


def quantile(values: Sequence[float], share: float) -> float:
    """The value that this share of the values does not exceed; nan when there are none."""
    if not values:
        return nan
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def show(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table: the first column to the left, numbers to the right."""
    lines = [list(columns), *map(cells, rows)]
    widths = [max(len(row[column]) for row in lines) for column in range(len(columns))]
    print(title)
    for row in lines:
        first, *others = (cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        print("  ".join([row[0].ljust(len(first)), *others]).rstrip())
    print(flush=True)


def cells(row: Sequence[object]) -> list[str]:
    """A table's row as text."""
    return [_text(cell) for cell in row]


def _text(cell: object) -> str:
    """A number with three digits that count; "-" for nan."""
    if not isinstance(cell, float):
        return str(cell)
    if isnan(cell):
        return "-"
    places = 0 if abs(cell) >= 100 else 1 if abs(cell) >= 10 else 2  # noqa: PLR2004
    return f"{cell:.{places}f}"
