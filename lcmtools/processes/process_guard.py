"""The guard that lets no child process outlive this one, even if this one is killed."""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

_REAPER = str(Path(__file__).with_name("reaper.py"))


class ProcessGuard:
    """Runs the reaper, which knows the groups of the child processes.

    Attributes:
        stream: The descriptor into which a new process writes its group ("+123", a line).
    """

    def __init__(self) -> None:
        # -I -S: it needs nothing that is installed, and no other module may take its imports' place
        self._reaper = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, "-I", "-S", _REAPER],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            bufsize=0,
        )
        assert self._reaper.stdin is not None
        self._pipe = self._reaper.stdin
        self.stream = self._pipe.fileno()

    def __enter__(self) -> "ProcessGuard":
        """Return it; the reaper runs."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let the reaper end; it ends the groups that have not been forgotten."""
        with contextlib.suppress(OSError):
            self._pipe.close()
        self._reaper.wait()

    def forget(self, group: int) -> None:
        """Tell the reaper that a group of processes is gone."""
        with contextlib.suppress(OSError, ValueError):  # the reaper has been killed, or has ended
            os.write(self._pipe.fileno(), f"-{group}\n".encode())
