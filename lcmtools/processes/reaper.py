"""The reaper: a separate program that ends child processes if their parent was killed.

It reads the groups of processes from a pipe ("+123", "-123", one per line). The pipe ends with the
parent, however that ends; the remaining groups then get SIGINT and, each after a moment, SIGTERM
and SIGKILL. It imports nothing from lcmtools, so that it starts quickly.
"""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Iterator

MARK = "LCMTOOLS_GUARD"  # the environment variable of child processes with their parent's pid
_GRACE = 0.5  # [s] from one signal to the next: enough for a controller to stop its robot


def send(group: int, number: int) -> bool:
    """Send a signal to a group of processes; return True if the group exists."""
    if group <= 0:  # 0 would be this process's own group
        return False
    try:
        os.killpg(group, number)
    except (ProcessLookupError, PermissionError):  # another user's group, or on macOS an ended one
        return False
    return True


def serve(stream: int) -> tuple[set[int], bool]:
    """Read until the parent is gone; return the remaining groups, and True if one was starting."""
    groups: set[int] = set()
    rest = b""
    while piece := os.read(stream, 4096):
        *lines, rest = (rest + piece).split(b"\n")
        for line in lines:
            number = int(line[1:])
            (groups.add if line[:1] == b"+" else groups.discard)(number)
    return groups, bool(rest)


def is_gone(group: int) -> bool:
    """Return True if no process of a group is running.

    An ended process may stay in the group forever if the system's first process, which inherits it,
    never waits for it, as in many containers. Without /proc this cannot be detected.
    """
    if not send(group, 0):
        return True
    # after the name, which may contain spaces: state, parent, group (proc_pid_stat(5))
    rows = [text.rpartition(b")")[2].split() for _, text in _processes("stat")]
    return bool(rows) and not any(int(row[2]) == group and row[0] not in b"ZX" for row in rows)


def children(parent: str) -> Iterator[int]:
    """Return the processes with the mark of a parent, even one that it has not reported yet.

    Returns none without /proc.
    """
    mark = f"{MARK}={parent}".encode()
    return (pid for pid, text in _processes("environ") if mark in text.split(b"\0"))


def _processes(name: str) -> Iterator[tuple[int, bytes]]:
    """Yield the pid and text of each readable file of this name in /proc/PID (proc(5))."""
    with contextlib.suppress(OSError):
        for pid in filter(str.isdigit, os.listdir("/proc")):  # noqa: PTH208 - quick
            with contextlib.suppress(OSError), open(f"/proc/{pid}/{name}", "rb") as file:  # noqa: PTH123 - quick
                yield int(pid), file.read()


def end(groups: set[int]) -> None:
    """End groups of processes, including those that ignore signals."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        groups = {group for group in groups if send(group, number)}
        deadline = time.monotonic() + _GRACE
        while groups and number != signal.SIGKILL and time.monotonic() < deadline:
            time.sleep(0.02)
            groups = {group for group in groups if not is_gone(group)}


def main(parent: str) -> None:
    """Serve standard input."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    groups, is_starting = serve(sys.stdin.fileno())
    if is_starting:
        time.sleep(_GRACE)  # until the new process has its environment variables
        groups.update(children(parent))
    end(groups)


if __name__ == "__main__":
    main(sys.argv[1])
