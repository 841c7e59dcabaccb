"""Waking a thread that waits, from other threads and from signal handlers."""

import contextlib
import select
import socket


class Wakeup:
    """A flag that one thread waits for.

    A pair of sockets and not a threading.Event: an Event set by a signal handler can deadlock with
    the very thread that the signal interrupted while it waited.
    """

    def __init__(self) -> None:
        self._read, self._write = socket.socketpair()
        self._read.settimeout(0.0)
        self._write.settimeout(0.0)
        self._is_set = False

    def set(self) -> None:
        """Wake the waiting thread, or let its next wait return at once."""
        if not self._is_set:
            self._is_set = True
            with contextlib.suppress(OSError):  # full: it is awake; closed: gone
                self._write.send(b"\0")

    def wait(self, timeout: float | None) -> None:
        """Wait until set, or for ``timeout`` seconds, and clear it; not at all when closed."""
        with contextlib.suppress(OSError, ValueError):  # another thread closes it just now
            if select.select([self._read], [], [], timeout)[0]:
                self._read.recv(4096)
                # cleared after reading: whoever sets it in between has its work ready already,
                # and the waiting thread looks for work only after this
                self._is_set = False

    def close(self) -> None:
        """Free the sockets."""
        self._read.close()
        self._write.close()
