"""Signals as something to wait for, instead of something that interrupts.

Belongs here: the handlers while processes are looked after. What a signal means is not known here.
"""

import contextlib
import select
import signal
import socket
from collections.abc import Sequence
from types import FrameType

_ASKING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Wakeup:
    """As a context, takes Ctrl-C, SIGTERM, SIGHUP and children's ends as events."""

    def __init__(self) -> None:
        self._receiver, self._sender = socket.socketpair()
        self._asked: list[int] = []
        self._is_late = False  # something has happened that nobody has waited for yet

    def __enter__(self) -> "Wakeup":
        """Put the handlers in place."""
        for end in (self._receiver, self._sender):
            end.setblocking(False)  # noqa: FBT003 - socket's own
        self._before = {number: signal.signal(number, self._note) for number in _ASKING}
        # a handler has to be there for a signal to wake anybody up
        self._before[signal.SIGCHLD] = signal.signal(signal.SIGCHLD, _nothing)
        self._previous = signal.set_wakeup_fd(self._sender.fileno(), warn_on_full_buffer=False)
        return self

    def __exit__(self, *_: object) -> None:
        """Put back what was there."""
        signal.set_wakeup_fd(self._previous)
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._receiver.close()
        self._sender.close()

    def take(self) -> list[int]:
        """The signals that have asked to end since the last time."""
        asked, self._asked = self._asked, []
        return asked

    def wait(self, streams: Sequence[int], timeout: float | None) -> list[int]:
        """Wait for a signal, a child's end, a descriptor or the time; the descriptors."""
        poll = select.poll()
        for stream in (self._receiver.fileno(), *streams):
            poll.register(stream, select.POLLIN)
        if self._is_late:
            timeout, self._is_late = 0.0, False
        ready = poll.poll(None if timeout is None else max(0.0, timeout) * 1000)
        self._drain()
        return [stream for stream, _ in ready if stream != self._receiver.fileno()]

    def wait_writable(self, stream: int, *, is_patient: bool) -> bool:
        """Wait until a descriptor can be written into; False if a signal asks to end before.

        Args:
            stream: The descriptor, which may be a terminal that somebody has stopped by Ctrl-S.
            is_patient: Wait at all.
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
        self._asked.append(number)


def _nothing(_number: int, _frame: FrameType | None) -> None:
    """Only wakes up."""
