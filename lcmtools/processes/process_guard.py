"""What makes sure that no process outlives its launcher, even one that is killed.

Belongs here: the warden's start, and what is done in a new process before it becomes a node.
"""

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

_PR_SET_PDEATHSIG = 1


class ProcessGuard:
    """Tells the warden which groups of processes there are."""

    def __init__(self) -> None:
        script = str(Path(__file__).with_name("warden.py"))
        # -I -S: it needs nothing that is installed, and nobody's folder may stand in its way
        self._warden = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, "-I", "-S", script],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            bufsize=0,
        )
        self._prctl = _find_prctl()

    def __enter__(self) -> "ProcessGuard":
        """It runs already."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let the warden go; it ends whatever has not been forgotten."""
        assert self._warden.stdin is not None
        with contextlib.suppress(OSError):
            self._warden.stdin.close()
        self._warden.wait()

    def in_child(self) -> Callable[[], None]:
        """What a new process, alone in its group, does before it becomes a node."""
        launcher = os.getpid()

        def bind() -> None:
            if self._prctl is not None:
                self._prctl(_PR_SET_PDEATHSIG, int(signal.SIGINT), 0, 0, 0)
            self._tell(f"+{os.getpid()}\n")
            if os.getppid() != launcher:  # it died before the kernel was asked to tell
                os._exit(1)

        return bind

    def forget(self, group: int) -> None:
        """A group of processes is gone."""
        self._tell(f"-{group}\n")

    def _tell(self, line: str) -> None:
        assert self._warden.stdin is not None
        with contextlib.suppress(OSError):  # somebody has killed it
            os.write(self._warden.stdin.fileno(), line.encode())


def _find_prctl() -> "Callable[..., int] | None":
    if sys.platform != "linux":
        return None
    try:
        return ctypes.CDLL(None).prctl
    except (OSError, AttributeError):
        return None
