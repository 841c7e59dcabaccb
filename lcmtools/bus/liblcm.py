"""The lcm package and its pitfalls. The only module that imports it.

The binding's pitfalls, and how each is avoided:

- ``subscribe`` freezes the whole process for ten seconds if multicast does not work, and then
  returns None: the bus is checked first (``lcmtools.bus.preflight``).
- A datagram that ends within its channel's name makes liblcm read another message's bytes from the
  same buffer, and the process may die: on Linux a filter in the kernel drops malformed datagrams.
- ``.*`` on udpm can crash on a malformed datagram: never used on udpm, the tap is used instead.
- ``handle_timeout`` crashes with file descriptors of 1024 and above: these are refused first.
- ``handle`` turns Ctrl-C into OSError: the caller waits in ``select`` instead.
- A tcpq connection that breaks is closed by the first thread that notices, and its subscriptions
  are lost: ``Connection`` makes a new instance and subscribes again.
- Channel names are regular expressions, and a queue keeps the oldest messages. ``unsubscribe``
  crashes while another thread handles messages, and on tcpq, two threads that publish or subscribe
  at once mix up their bytes: see ``lcmtools.bus.lcm_bus``.
"""

import contextlib
import ctypes
import math
import os
import socket
import stat
import time
from collections.abc import Callable, Iterator

from lcmtools.bus.base import outage_texts
from lcmtools.bus.channel_filter import ChannelFilter
from lcmtools.bus.kernel import drop_what_is_late, open_descriptors, receive_buffer_bytes
from lcmtools.bus.preflight import check_bus
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, MissingExtra

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
_LATE = 1.0  # [s] that a server may leave sent data unacknowledged
_FIRST_PAUSE, _LONGEST_PAUSE = 0.2, 2.0  # [s] before attempts to reconnect


class Connection:
    """An LCM instance; a lost one to a server (tcpq) is made again when the server is back.

    For use by one thread, but ``instance`` may be read by any.

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
        instance, self.filter = open_lcm(url)  # the filter on its sockets
        subscribe(instance)
        # None if the connection is lost, or a log has ended.
        self.instance: Instance | None = instance

    @property
    def is_lost(self) -> bool:
        """True while it tries to reconnect."""
        return self._due < math.inf

    def left(self) -> float | None:
        """Return the time until the next attempt [s]; None if the connection is not lost."""
        return max(0.0, self._due - time.monotonic()) if self.is_lost else None

    def close(self) -> None:
        """Release the instance."""
        self.instance, self._due = None, math.inf
        self.filter.close()

    def leave_to_parent(self) -> None:
        """Release the instance in a forked process, unfreed: freeing would wait for its thread."""
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(self.instance))
        self.instance = None

    def lose(self) -> None:
        """Release an instance whose connection broke or whose log has ended."""
        self.instance = None
        if self._url.provider == "tcpq":
            self._pause = _FIRST_PAUSE
            self._due = time.monotonic() + self._pause
            self._on_outage(*outage_texts(self._url, is_lost=True))

    def try_again(self) -> None:
        """Try to connect again; the pause before the next attempt doubles each time."""
        try:
            instance, self.filter = open_lcm(self._url)
            self._subscribe(instance)
        except (BusError, OSError):
            self._pause = min(2 * self._pause, _LONGEST_PAUSE)
            self._due = time.monotonic() + self._pause
            return
        self.instance, self._due = instance, math.inf
        self._on_outage(*outage_texts(self._url, is_lost=False))


def open_lcm(url: BusUrl) -> tuple[Instance, ChannelFilter]:
    """Make an LCM instance, after checking for conditions in which liblcm would hang or print.

    Also returns the filter on its receiving sockets.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
    """
    check_bus(url)
    if url.provider in ("udpm", "mpudpm"):
        url = url.with_option("ttl", "0")
    if url.is_multicast:
        url = url.with_option("recv_buf_size", str(receive_buffer_bytes()))
    known = open_descriptors()
    try:
        instance = lcm.LCM(str(url))
        instance.fileno()  # this creates the receiving sockets
        if url.provider == "tcpq":
            with socket.socket(fileno=os.dup(instance.fileno())) as connection:
                drop_what_is_late(connection, _LATE)
    except (RuntimeError, OSError) as error:
        raise BusError(f"LCM cannot open {url}") from error
    descriptors = open_descriptors() - known if url.is_multicast else set()
    return instance, ChannelFilter(_listeners(url, descriptors))


def _listeners(url: BusUrl, descriptors: set[int]) -> Iterator[socket.socket]:
    """Yield duplicates of the descriptors that listen to the bus."""
    # listed first: a duplicate may get the number of a descriptor that is closed meanwhile
    for descriptor in [one for one in descriptors if _is_socket(one)]:
        with contextlib.suppress(OSError):  # closed meanwhile
            # a duplicate, because closing the Python object must not close liblcm's socket
            listener = socket.socket(fileno=os.dup(descriptor))
            if listener.getsockname() == (url.host, url.port):
                yield listener
            else:
                listener.close()


def _is_socket(descriptor: int) -> bool:
    try:
        return stat.S_ISSOCK(os.fstat(descriptor).st_mode)
    except OSError:
        return False
