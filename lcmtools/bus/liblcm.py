"""The lcm package, for buses that are not multicast groups, and its pitfalls.

The only module that imports it.

The binding's pitfalls, and how each is avoided:

- ``subscribe`` freezes the whole process for ten seconds if multicast does not work (mpudpm), and
  then returns None: the bus is checked first (``lcmtools.bus.preflight``).
- ``handle_timeout`` crashes with file descriptors of 1024 and above: these are refused first.
- On mpudpm, its thread may read once more from a socket that was just closed, and so from whatever
  gets the same descriptor next: the first thing to get one after the self-test is a socket that
  never blocks (``network_watch.member``), and channels are not unsubscribed.
- ``handle`` turns Ctrl-C into OSError: the caller waits in ``select`` instead.
- A tcpq connection that breaks is closed by the first thread that notices, and its subscriptions
  are lost: ``Connection`` makes a new instance and subscribes again.
- On tcpq, it writes notes to standard error: they are left out.
- Channel names are regular expressions, and a queue keeps the oldest messages. ``unsubscribe``
  crashes while another thread handles messages, and on tcpq, two threads that publish or subscribe
  at once mix up their bytes: see ``lcmtools.bus.lcm_bus``.
"""

import contextlib
import ctypes
import math
import os
import select
import socket
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path

from lcmtools.bus.base import outage_texts
from lcmtools.bus.kernel import drop_what_is_late, duplicate
from lcmtools.bus.network_watch import member, network_watch
from lcmtools.bus.preflight import check_bus
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, MissingExtra
from lcmtools.forks import free_in_child
from lcmtools.names import check_channel

try:
    import lcm
except ImportError as error:  # its wheel needs GLib, which not every server has
    raise MissingExtra(
        f"the Python package lcm cannot be loaded: {error.__context__ or error}",
        "it needs GLib: apt install libglib2.0-0 (Debian, Ubuntu), dnf install glib2 (Fedora)",
    ) from error

Instance = lcm.LCM
Subscription = lcm.LCMSubscription
QUEUE_CAPACITY = 10_000  # messages that liblcm may hold while Python is not running
_BATCH = 100  # messages handled at a time
_SELECT_LIMIT = 1024
_LATE = 1.0  # [s] that a server may leave sent data unacknowledged
_NOTES = (b"LCM tcpq:", b"lcm_tcpq ", b"_recv_fully:", b"_send_fully:")
_PIPE_BYTES = 1 << 16
_redirecting = threading.RLock()  # standard error is the process's; a signal handler may fork
free_in_child(_redirecting)
_FIRST_PAUSE, _LONGEST_PAUSE = 0.2, 2.0  # [s] before attempts to reconnect


class Connection:
    """An LCM instance; a lost one to a server (tcpq) is made again when the server is back.

    For use by one thread; any may publish, and hold ``using`` to use ``instance``.

    ``subscribe`` makes the subscriptions of an instance: of the first one and of each new one;
    ``on_outage`` is called when the connection is lost or restored, with a text and the current
    problem, "" for none.

    Raises:
        BusError: The bus cannot be reached.
    """

    def __init__(
        self,
        url: BusUrl,
        subscribe: Callable[[Instance], None],
        on_outage: Callable[[str, str], None],
    ) -> None:
        self._url = url
        self._subscribe = subscribe
        self._on_outage = on_outage
        self._pause = _FIRST_PAUSE
        self._due = math.inf  # time of the next attempt
        self._lost: Instance | None = None  # an instance whose connection broke, not yet freed
        self._broken: Instance | None = None  # one whose connection broke while sending
        self.using = threading.RLock()  # not Lock: a signal handler may publish too
        instance = open_lcm(url)
        self._member = member(url.host) if url.provider == "mpudpm" else None
        subscribe(instance)
        # None if the connection is lost, or a log has ended.
        self.instance: Instance | None = instance

    @property
    def is_lost(self) -> bool:
        """True while it tries to reconnect."""
        return self._due < math.inf

    @property
    def has_ended(self) -> bool:
        """True if the server closed the connection: if liblcm reads then, it writes to stderr."""
        if self._url.provider != "tcpq" or self.instance is None:
            return False
        try:
            with duplicate(self.instance.fileno()) as connection:
                return not connection.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT)
        except BlockingIOError:
            return False
        except OSError:
            return True

    def publish(self, channel: str, payload: bytes) -> None:
        """Send one message, on any thread.

        Raises:
            BusError: The connection is lost or closed.
            InvalidName: LCM cannot carry this channel name.
            OSError: It cannot be sent.
        """
        check_channel(channel)
        instance = self.instance
        if instance is None:
            lost = f"the connection to {self._url} is lost"
            raise BusError(lost if self.is_lost else "the bus is closed")
        try:
            with self.using:
                if self.has_ended:
                    raise ConnectionError(0, "the server has closed the connection")
                instance.publish(channel, payload)
        except OSError:
            if self._url.provider == "tcpq":
                self._broken = instance
            raise

    def receive(self, timeout: float | None, also: Sequence[int]) -> Collection[int]:
        """Handle what arrives, waiting up to ``timeout`` [s] for the first message, and reconnect.

        It also stops waiting when one of the descriptors ``also`` is readable; returns those. And
        when the network has changed, with that descriptor.
        """
        instance, left, readable = self.instance, self.left(), list[int]()
        if left is not None:
            timeout = left if timeout is None else min(left, timeout)
        try:
            own = [] if instance is None else [instance.fileno()]
            network = network_watch.descriptors if self._member else ()
            longest = network_watch.longest_wait(timeout) if self._member else timeout
            readable = select.select([*own, *also, *network], [], [], longest)[0]
            network_watch.look()
            works = self._broken is None or self._broken is not instance
            if own and own[0] in readable:
                works = works and not self.has_ended
                readable.remove(own[0])
                if works:
                    self.handle(_BATCH)
        except (OSError, ValueError):  # it has ended, or liblcm closed it when sending failed
            works = False
        if not works and instance is not None and self.instance is instance:
            self.lose()
        elif self.left() == 0.0:
            self.try_again()
        return readable

    def handle(self, most: int) -> int:
        """Handle waiting messages, ``most`` at most; return their number.

        Raises:
            OSError: The connection is broken, or the log has ended.
        """
        handled = 0
        try:
            while handled < most and self.instance and self.instance.handle_timeout(0):
                handled += 1
        except OSError:
            if not handled:  # else the next call tells
                raise
        return handled

    def left(self) -> float | None:
        """Return the time until the next attempt [s]; None if the connection is not lost."""
        return max(0.0, self._due - time.monotonic()) if self.is_lost else None

    def close(self) -> None:
        """Release the instance."""
        with _without_notes() if self._lost else contextlib.nullcontext():
            self.instance, self._lost, self._due = None, None, math.inf
        if self._member:
            self._member.close()

    def leave_to_parent(self) -> None:
        """Release the instance in a forked process, unfreed: freeing would wait for its thread."""
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(self.instance))
        self.instance = None

    def lose(self) -> None:
        """Release an instance whose connection broke or whose log has ended."""
        self._lost, self.instance = self.instance, None
        if self._url.provider == "tcpq":
            self._pause = _FIRST_PAUSE
            self._due = time.monotonic() + self._pause
            self._on_outage(*outage_texts(self._url, is_lost=True))

    def try_again(self) -> None:
        """Try to connect again; the pause before the next attempt doubles each time."""
        with _without_notes():  # to unsubscribe, the lost instance tries to connect again
            self._lost = None
        try:
            instance = open_lcm(self._url)
            self._subscribe(instance)
        except (BusError, OSError):
            self._pause = min(2 * self._pause, _LONGEST_PAUSE)
            self._due = time.monotonic() + self._pause
            return
        self.instance, self._due = instance, math.inf
        self._on_outage(*outage_texts(self._url, is_lost=False))


def open_lcm(url: BusUrl) -> Instance:
    """Make an LCM instance, after checking for conditions in which liblcm would hang or print.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
    """
    check_bus(url)
    _check_descriptors()
    if url.provider == "mpudpm":
        url = url.with_option("ttl", "0")
    try:
        with _without_notes() if url.provider == "tcpq" else contextlib.nullcontext():
            instance = lcm.LCM(str(url))
            instance.fileno()  # this creates the receiving sockets
        if url.provider == "tcpq":
            with duplicate(instance.fileno()) as connection:
                drop_what_is_late(connection, _LATE)
    except (RuntimeError, OSError) as error:
        raise BusError(f"LCM cannot open {url}") from error
    return instance


@contextlib.contextmanager
def _without_notes() -> Iterator[None]:
    """Leave out of standard error what liblcm notes about connecting; other threads' text stays."""
    errors = 2
    with _redirecting, contextlib.ExitStack() as closing:
        try:
            before = os.dup(errors)
        except OSError:  # it is closed
            yield
            return
        closing.callback(os.close, before)
        reader, writer = os.pipe()
        closing.callback(os.close, reader)
        os.set_blocking(reader, False)  # another program may have inherited the other end
        os.dup2(writer, errors)
        os.close(writer)
        try:
            yield
        finally:
            os.dup2(before, errors)
            with contextlib.suppress(BlockingIOError):
                for line in os.read(reader, _PIPE_BYTES).splitlines(keepends=True):
                    if not line.startswith(_NOTES):
                        os.write(errors, line)


def _check_descriptors() -> None:
    """Check that about ten file descriptors are left below 1024, the limit of ``select``."""
    with Path(os.devnull).open("rb") as lowest_free:
        if lowest_free.fileno() > _SELECT_LIMIT - 20:
            limit = f"liblcm cannot wait for a descriptor above {_SELECT_LIMIT}"
            raise BusError(f"this process has over {lowest_free.fileno()} open files, and {limit}")
