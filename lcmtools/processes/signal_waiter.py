"""Signals as events to wait for, together with descriptors and a timeout.

Belongs here: the signal handlers used while child processes run. Must not know what a signal means.
"""

import contextlib
import select
import signal
import socket
from collections.abc import Sequence
from types import FrameType

from lcmtools.signals import Doubles, ending_signals


class SignalWaiter:
    """A context in which SIGINT, SIGTERM, SIGHUP and the ends of children are events.

    Under nohup, SIGHUP is not one. Signals belong to the whole process: inside the context its
    handlers for these four, and its wake-up descriptor, are replaced; afterwards they are restored.
    Only the main thread may enter it.
    """

    def __init__(self) -> None:
        self._receiver, self._sender = socket.socketpair()
        self._asked: list[int] = []
        self._doubles = Doubles()
        self._is_late = False  # True if an event happened that ``wait`` has not reported yet

    def __enter__(self) -> "SignalWaiter":
        """Install the handlers."""
        for end in (self._receiver, self._sender):
            end.setblocking(False)  # noqa: FBT003 - socket's signature
        self._before = {number: signal.signal(number, self._note) for number in ending_signals()}
        # only a signal with a Python handler wakes up the waiting thread
        self._before[signal.SIGCHLD] = signal.signal(signal.SIGCHLD, lambda *_: None)
        self._previous = signal.set_wakeup_fd(self._sender.fileno(), warn_on_full_buffer=False)
        return self

    def __exit__(self, *_: object) -> None:
        """Restore the previous handlers."""
        signal.set_wakeup_fd(self._previous)
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._receiver.close()
        self._sender.close()

    def pop(self) -> list[int]:
        """Return the signals since the last call that request an end."""
        asked, self._asked = self._asked, []
        return asked

    def wait(self, streams: Sequence[int], timeout: float | None) -> list[int]:
        """Wait for a signal, a child's end, a descriptor or a timeout; return ready descriptors."""
        poll = select.poll()
        for stream in (self._receiver.fileno(), *streams):
            poll.register(stream, select.POLLIN)
        if self._is_late:
            timeout, self._is_late = 0.0, False
        ready = poll.poll(None if timeout is None else max(0.0, timeout) * 1000)
        self._drain()
        return [stream for stream, _ in ready if stream != self._receiver.fileno()]

    def wait_writable(self, stream: int, *, is_patient: bool) -> bool:
        """Wait until a descriptor is writable; return False if a signal requests an end first.

        Ctrl-S may have stopped a terminal. Without ``is_patient``, return at once.
        """
        poll = select.poll()
        poll.register(self._receiver.fileno(), select.POLLIN)
        poll.register(stream, select.POLLOUT)
        while True:
            ready = dict(poll.poll(None if is_patient else 0))
            if stream in ready:
                return True
            if not is_patient or self._asked:
                return False
            self._drain()
            self._is_late = True

    def _drain(self) -> None:
        with contextlib.suppress(BlockingIOError):
            while self._receiver.recv(4096):
                pass

    def _note(self, number: int, _frame: FrameType | None) -> None:
        if not self._doubles.is_double():
            self._asked.append(number)
