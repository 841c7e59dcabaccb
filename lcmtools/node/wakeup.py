"""Waking a thread that waits, from other threads and from signal handlers."""

import contextlib
import os
import select


class Wakeup:
    """A flag that one thread waits for.

    A pipe and not a threading.Event: an Event set by a signal handler can deadlock with the very
    thread that the signal interrupted while it waited.
    """

    def __init__(self) -> None:
        self._read, self._write = os.pipe()
        os.set_blocking(self._read, False)
        os.set_blocking(self._write, False)
        self._is_set = False

    def set(self) -> None:
        """Wake the waiting thread, or let its next wait return at once."""
        if not self._is_set:
            self._is_set = True
            with contextlib.suppress(BlockingIOError, OSError):  # full: it is awake; closed: gone
                os.write(self._write, b"\0")

    def wait(self, timeout: float | None) -> None:
        """Wait until set, or for ``timeout`` seconds; then clear it."""
        if select.select([self._read], [], [], timeout)[0]:
            with contextlib.suppress(BlockingIOError):
                os.read(self._read, 4096)
            # cleared after reading: whoever sets it in between has its work ready already, and
            # the waiting thread looks for work only after this
            self._is_set = False

    def close(self) -> None:
        """Free the pipe."""
        os.close(self._read)
        os.close(self._write)
