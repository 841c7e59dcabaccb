"""The interface of a bus for nodes, and the threads of its implementations."""

import contextlib
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Generic, TypeVar

from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError, BusOfParent

LOCKSTEP = "LCMTOOLS_LOCKSTEP"
"""The environment variable of programs that a recording is played to in lock-step; its value is the
time at the start [ns]."""

MessageT = TypeVar("MessageT")

_MOST_FAULTS = 20  # different ones that are reported
_FLUSH_TIMEOUT = 0.5  # [s] that closing waits for queued messages

Handler = Callable[[bytes, int], None]
"""Called with a payload and its time of arrival [ns since 1970]; must be quick, unless it is called
by ``Bus.wait`` of a bus that ``runs_callbacks``."""


Shortcut = Callable[[bytes], bool]
"""Sends a payload; returns False if ``Bus.publish`` must do it. Raises OSError."""


class Bus(ABC):
    """A connection to a bus."""

    runs_callbacks = False
    """True if handlers that ``wait`` calls may take their time: another thread takes over."""
    overflows = 0
    """The most datagrams that a full receive buffer can have lost; 0 if it is unknown."""

    def __init__(self) -> None:
        self.ports: list[int] = []
        """The UDP ports that messages are sent from."""
        self.on_outage: Callable[[str], None] = lambda _: None
        """Called when the connection is lost or restored, or a thread outlives a fault."""
        self.on_received: Callable[[], None] = lambda: None
        """Called after handlers have run, unless on the only thread that calls ``wait``."""

    def lost(self, _channel: str) -> int:
        """Return the number of messages on a channel that are known to have been lost."""
        return 0

    def dropped(self) -> tuple[str, Mapping[str, int]]:
        """Return the address at the other end of a line that is full, "" if none is known.

        Also the number of messages of each channel that were never sent because of such lines.
        """
        return "", {}

    @abstractmethod
    def publish(
        self, channel: str, payload: bytes, type_name: str = "", *, latched: bool = False
    ) -> None:
        """Send one message. Safe from any thread.

        Args:
            channel: The channel.
            payload: Fingerprint and encoded struct, or any other bytes.
            type_name: The type "package/Name", for a bus whose keys contain it; "" if unknown.
            latched: It is state, which may arrive late; on Zenoh, other late messages are dropped.

        Raises:
            BusError: It cannot be sent.
            InvalidName: LCM cannot carry this channel name.
        """

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send those of these messages that cost less if sent together, perhaps in another order.

        Returns the indices of the others, which must be sent one by one. Safe from any thread.
        """
        return range(len(messages))

    def shortcut(self, _channel: str) -> Shortcut:
        """Return the shortest way to publish on a channel."""
        return lambda _: False

    def keep_order(self) -> None:  # noqa: B027 - most keep it anyway
        """Send messages in the order of ``publish`` from now on, also behind large ones."""

    @abstractmethod
    def subscribe(self, channel: str, handler: Handler, *, is_large: bool = False) -> None:
        """Call ``handler``, on the receiving thread, for each message on the channel.

        ``is_large`` means that messages of over 100 kB are to be expected from the first one on.
        Raises BusError and InvalidName as ``publish``.
        """

    @abstractmethod
    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""

    @abstractmethod
    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Wait at most ``timeout`` seconds for an event or messages; clear the event.

        The calling thread may receive meanwhile; it should come back soon, or call ``hand_over``.
        Returns now and then although nothing has come.
        """

    def hand_over(self) -> None:  # noqa: B027
        """Receive without the threads that called ``wait``, because they will be busy for long."""

    @abstractmethod
    def close(self) -> None:
        """Send waiting messages and leave the bus."""

    @abstractmethod
    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process, which has no receiving thread; free nothing."""


def start_thread(run: Callable[[], None], name: str) -> threading.Thread:
    """Start a thread that does not keep the program alive.

    Raises:
        BusError: The system gives no more threads.
    """
    thread = threading.Thread(target=run, name=name, daemon=True)
    try:
        thread.start()
    except RuntimeError as error:
        hint = "end others; see ulimit -u and -v"
        raise BusError("the system gives no more threads", hint) from error
    return thread


class Faults:
    """The exceptions that a thread outlives: each is reported once, and the report may fail too."""

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report
        self._known: set[str] = set()

    def note(self, what: str, error: Exception) -> None:
        """Report an exception, unless it is known: "WHAT failed: TypeError: ..."."""
        text = f"{what} failed: {type(error).__name__}: {error}"
        if text not in self._known and len(self._known) < _MOST_FAULTS:
            self._known.add(text)
            with contextlib.suppress(Exception):
                self._report(text)


def refusal(*, is_of_parent: bool) -> BusError:
    """Return the error for a bus that is closed, or that belongs to a forked process's parent."""
    if is_of_parent:
        remedy = "call lcmtools.init() in the forked process and make its nodes there"
        return BusOfParent("the bus belongs to the parent process", remedy)
    return BusError("the bus is closed")


def outage_texts(url: BusUrl, *, is_lost: bool) -> tuple[str, str]:
    """Return the message of a lost or restored connection, and the current problem, "" for none."""
    if is_lost:
        text = f"the connection to {url} is lost; it is tried again until it is back"
        return text, text
    return f"the connection to {url} is back", ""


class SendingThread(ABC, Generic[MessageT]):
    """A queue of messages, and the thread that sends them so that publishers need not wait.

    It starts with the first one.

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
