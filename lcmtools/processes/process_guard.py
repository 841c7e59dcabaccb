"""The guard that ends all child processes with this one, even if this one is killed."""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from threading import Lock
from typing import IO, TypeAlias

from lcmtools.processes import reaper

Stream: TypeAlias = "int | IO[bytes] | None"


class ProcessGuard:
    """Starts child processes, and runs the reaper, which knows their groups."""

    def __init__(self) -> None:
        self._lock = Lock()
        # -I -S: it needs no installed packages, and its imports must not be shadowed
        self._reaper = subprocess.Popen(  # noqa: S603 - lcmtools' own program
            [sys.executable, "-I", "-S", str(Path(reaper.__file__)), str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            bufsize=0,
        )
        assert self._reaper.stdin is not None
        self._pipe = self._reaper.stdin

    def __enter__(self) -> "ProcessGuard":
        """Return the guard; the reaper runs."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let the reaper end; it first ends the groups that have not been forgotten."""
        with contextlib.suppress(OSError):
            self._pipe.close()
        self._reaper.wait()

    def start(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        directory: str,
        streams: tuple[Stream, Stream, Stream],
        *,
        holds_interrupts: bool = False,
    ) -> "subprocess.Popen[bytes]":
        """Start a process in its own session and group, with these streams; OSError on failure.

        One that ``holds_interrupts`` begins with SIGINT blocked.
        """
        stdin, stdout, stderr = streams
        group = 0
        with self._lock, _interrupts_blocked() if holds_interrupts else contextlib.nullcontext():
            self._tell("+")  # this process may be killed between the start and its report
            try:
                popen = subprocess.Popen(  # noqa: S603 - the user's own program
                    command,
                    env={**environment, reaper.MARK: str(os.getpid())},
                    cwd=directory or None,
                    stdin=stdin,
                    stdout=stdout,
                    stderr=stderr,
                    start_new_session=True,
                )
                group = popen.pid
                return popen
            finally:
                self._tell(f"{group}\n")

    def forget(self, group: int) -> None:
        """Tell the reaper that a group of processes is gone."""
        with self._lock:
            self._tell(f"-{group}\n")

    def _tell(self, text: str) -> None:
        with contextlib.suppress(OSError, ValueError):  # the reaper was killed, or has ended
            os.write(self._pipe.fileno(), text.encode())


@contextlib.contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block SIGINT in this thread, and in the processes that it starts meanwhile."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
