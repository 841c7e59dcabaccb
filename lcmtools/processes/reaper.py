"""The warden: a program of its own that ends a launch's processes when the launcher was killed.

It reads the groups of processes that there are from a pipe ("+123", "-123", a line each). When the
launcher ends, however it ends, the pipe does too; whatever is left then gets SIGINT where the
kernel has not sent it, SIGTERM after a moment, and SIGKILL. It imports nothing of lcmtools, so that
it starts in a moment.
"""

import contextlib
import os
import signal
import sys
import time

_GRACE = 0.5
"""Seconds from one signal to the next: a controller lets its robot stand within that."""


def serve(stream: int) -> set[int]:
    """Read until the launcher is gone; the groups that are left."""
    groups: set[int] = set()
    rest = b""
    while piece := os.read(stream, 4096):
        *lines, rest = (rest + piece).split(b"\n")
        for line in lines:
            number = int(line[1:])
            (groups.add if line[:1] == b"+" else groups.discard)(number)
    return groups


def end(groups: set[int], *, is_asked: bool) -> None:
    """End groups of processes, those that ignore it too."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        groups = {group for group in groups if _send(group, 0)}
        if not (is_asked and number == signal.SIGINT):
            groups = {group for group in groups if _send(group, number)}
        deadline = time.monotonic() + _GRACE
        while groups and number != signal.SIGKILL and time.monotonic() < deadline:
            time.sleep(0.02)
            groups = {group for group in groups if _send(group, 0)}


def _send(group: int, number: int) -> bool:
    """Send a signal; whether there was anybody."""
    with contextlib.suppress(ProcessLookupError):
        try:
            os.killpg(group, number)
        except PermissionError:  # some of them are somebody else's
            return False
        return True
    return False


def main() -> None:
    """Wait on standard input."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    # where there is prctl, the kernel has sent SIGINT to the nodes themselves
    end(serve(sys.stdin.fileno()), is_asked=sys.platform == "linux")


if __name__ == "__main__":
    main()
