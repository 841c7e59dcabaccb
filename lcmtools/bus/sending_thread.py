"""A thread that sends messages one after another, so that their publishers need not wait."""

import threading
from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from lcmtools.bus.base import start_thread

MessageT = TypeVar("MessageT")

_FLUSH_TIMEOUT = 0.5  # [s] that closing waits for queued messages


class SendingThread(ABC, Generic[MessageT]):
    """A queue of messages and the thread that sends them, which starts with the first one.

    The methods to implement are called by that thread. The queue is used only with ``_changed``.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._changed = threading.Condition()
        self._closed = False
        self._thread: threading.Thread | None = None

    @abstractmethod
    def _next(self) -> MessageT | None:
        """Return the message to send next, None if none waits; with ``_changed``."""

    @abstractmethod
    def _send_now(self, message: MessageT) -> None:
        """Send a message; this may take long, and must not raise."""

    @abstractmethod
    def _note_sent(self, message: MessageT) -> None:
        """Update the queue after a message was sent; with ``_changed``."""

    def close(self) -> None:
        """Send the waiting messages, for half a second at most."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join(_FLUSH_TIMEOUT)

    def _start(self) -> None:
        """Start the thread for the first message; with ``_changed``.

        Raises:
            BusError: The system gives no more threads.
        """
        if self._thread is None and not self._closed:
            self._thread = start_thread(self._run, self._name)

    def _run(self) -> None:
        while (message := self._await_next()) is not None:
            self._send_now(message)
            with self._changed:
                self._note_sent(message)
                self._changed.notify_all()

    def _await_next(self) -> MessageT | None:
        """Return the message to send next; None if it is closed and all were sent."""
        with self._changed:
            while (message := self._next()) is None and not self._closed:
                self._changed.wait()
            return message
