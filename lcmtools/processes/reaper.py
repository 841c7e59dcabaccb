"""The reaper: a program of its own that ends child processes when their parent was killed.

It reads the groups of processes from a pipe ("+123", "-123", a line each). The pipe ends with the
parent, however that ends; the groups that are left then get SIGINT where the kernel has not sent
it, SIGTERM after a moment, and SIGKILL. It imports nothing of lcmtools, so that it starts quickly.
"""

import contextlib
import os
import signal
import sys
import time

_GRACE = 0.5
"""Seconds from one signal to the next: enough for a controller to stop its robot."""


def serve(stream: int) -> set[int]:
    """Read until the parent is gone; return the groups that are left."""
    groups: set[int] = set()
    rest = b""
    while piece := os.read(stream, 4096):
        *lines, rest = (rest + piece).split(b"\n")
        for line in lines:
            number = int(line[1:])
            (groups.add if line[:1] == b"+" else groups.discard)(number)
    return groups


def end(groups: set[int], *, is_asked: bool) -> None:
    """End groups of processes, including those that ignore signals."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        groups = {group for group in groups if _send(group, 0)}
        if not (is_asked and number == signal.SIGINT):
            groups = {group for group in groups if _send(group, number)}
        deadline = time.monotonic() + _GRACE
        while groups and number != signal.SIGKILL and time.monotonic() < deadline:
            time.sleep(0.02)
            groups = {group for group in groups if _send(group, 0)}


def _send(group: int, number: int) -> bool:
    """Send a signal; return True if the group exists."""
    with contextlib.suppress(ProcessLookupError):
        try:
            os.killpg(group, number)
        except PermissionError:  # some of them belong to another user
            return False
        return True
    return False


def main() -> None:
    """Serve standard input."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    # where there is prctl, the kernel has sent SIGINT to the processes themselves
    end(serve(sys.stdin.fileno()), is_asked=sys.platform == "linux")


if __name__ == "__main__":
    main()
