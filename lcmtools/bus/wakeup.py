"""An event that wakes a thread, set by other threads and by signal handlers."""

import contextlib
import os
import select
import sys
from collections.abc import Callable, Collection, Sequence
from io import FileIO

_ONE = (1).to_bytes(8, "little")  # any number but 0, in eight bytes as for eventfd(2)
_SELECT_LIMIT = 1024  # descriptors
_MUCH = 4096  # bytes: more than a pipe can contain


class WakeupEvent:
    """An event that one thread waits for.

    It uses a file descriptor, not a threading.Event: an Event set by a signal handler can deadlock
    with the thread that the signal interrupted while it waited. On Linux it is an eventfd(2): a
    reader of a pipe or socket is often woken on the writer's processor and runs only when that is
    free, which costs a fifth of a callback's latency.
    """

    def __init__(self) -> None:
        self._read, self._write = _ends()
        self.fileno: Callable[[], int] = self._read.fileno
        """Returns the descriptor, which is readable while the event is set."""
        self.is_set = False  # true from ``set`` until it is cleared

    def set(self) -> None:
        """Wake the waiting thread, or let its next wait return at once."""
        if not self.is_set:
            self.is_set = True
            with contextlib.suppress(OSError, ValueError):  # the event is closed
                self._write.write(_ONE)

    def wait(self, timeout: float | None) -> None:
        """Wait until set, ``timeout`` seconds at most, and clear it; return at once if closed."""
        with contextlib.suppress(OSError, ValueError):  # another thread is closing it
            if wait_readable([self._read.fileno()], timeout):
                self.clear()

    def clear(self) -> None:
        """Clear it for the next wait; the waiting thread looks for work only after this."""
        with contextlib.suppress(OSError, ValueError):
            self._read.read(_MUCH)
        # after reading: a thread that sets it in between has its work ready by now
        self.is_set = False

    def close(self) -> None:
        """Free the descriptors."""
        self._read.close()
        self._write.close()


def wait_readable(descriptors: Sequence[int], timeout: float | None) -> Collection[int]:
    """Wait until one is readable, ``timeout`` seconds at most; return those that are.

    Raises:
        OSError, ValueError: A descriptor is closed.
    """
    if max(descriptors) < _SELECT_LIMIT:
        return select.select(descriptors, (), (), timeout)[0]
    poll = select.poll()  # has no limit, but counts in milliseconds
    for descriptor in descriptors:
        poll.register(descriptor, select.POLLIN)
    return [found for found, _ in poll.poll(None if timeout is None else 1000 * timeout)]


def _ends() -> tuple[FileIO, FileIO]:
    """The ends to read and to write: as files, because closed descriptors may be reused."""
    if sys.platform == "linux" and hasattr(os, "eventfd"):
        with contextlib.suppress(OSError):  # a sandbox without this call
            both = FileIO(os.eventfd(0, os.EFD_CLOEXEC | os.EFD_NONBLOCK), "r+")
            return both, both
    read, write = os.pipe()
    for descriptor in (read, write):
        os.set_blocking(descriptor, False)
    return FileIO(read, "r"), FileIO(write, "w")
