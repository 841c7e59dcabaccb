"""An event that wakes a thread, set by other threads and by signal handlers."""

import contextlib
import os
import select
import sys
from collections.abc import Callable
from io import FileIO

_ONE = (1).to_bytes(8, "little")  # any number but 0, in eight bytes, as eventfd(2) wants it
_MUCH = 4096  # bytes: all that a pipe can have taken meanwhile, and more


class WakeupEvent:
    """An event that one thread waits for.

    A file descriptor and not a threading.Event: an Event set by a signal handler can deadlock with
    the very thread that the signal interrupted while it waited. On Linux it is an eventfd(2): a
    reader of a pipe or socket is often woken on the writer's processor, and runs only when that is
    free, which costs a fifth of a callback's latency.
    """

    def __init__(self) -> None:
        self._read, self._write = _ends()
        self.fileno: Callable[[], int] = self._read.fileno
        """Returns the descriptor that can be read while it is set."""
        self.is_set = False  # true from ``set`` until it is cleared

    def set(self) -> None:
        """Wake the waiting thread, or let its next wait return at once."""
        if not self.is_set:
            self.is_set = True
            with contextlib.suppress(OSError, ValueError):  # closed: gone
                self._write.write(_ONE)

    def wait(self, timeout: float | None) -> None:
        """Wait until set, or for ``timeout`` seconds, and clear it; not at all when closed."""
        with contextlib.suppress(OSError, ValueError):  # another thread closes it just now
            if select.select([self._read], [], [], timeout)[0]:
                self.clear()

    def clear(self) -> None:
        """Make ready for the next wait; the waiting thread looks for work only after this."""
        with contextlib.suppress(OSError, ValueError):
            self._read.read(_MUCH)
        # after reading: a thread that sets it in between has its work ready
        self.is_set = False

    def close(self) -> None:
        """Free the descriptors."""
        self._read.close()
        self._write.close()


def _ends() -> tuple[FileIO, FileIO]:
    """The ends to read and to write; as files, since a closed one is never another's."""
    if sys.platform == "linux" and hasattr(os, "eventfd"):
        both = FileIO(os.eventfd(0, os.EFD_CLOEXEC | os.EFD_NONBLOCK), "r+")
        return both, both
    read, write = os.pipe()
    for descriptor in (read, write):
        os.set_blocking(descriptor, False)
    return FileIO(read, "r"), FileIO(write, "w")
