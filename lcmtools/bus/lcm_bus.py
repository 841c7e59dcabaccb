"""The lcm package, and its sharp edges. The only module that imports it.

What the binding does not forgive, and is therefore kept here:

- ``subscribe`` freezes the whole process for ten seconds where multicast does not work, and then
  returns None: the bus is checked before (``lcmtools.bus.preflight``).
- Channel names are regular expressions there: they are escaped.
- Malformed datagrams can crash it: a filter keeps them out (``lcmtools.bus.datagram_filter``).
- ``.*`` on udpm can crash on a malformed datagram: never used there (the tap is).
- ``unsubscribe`` while another thread handles crashes: both happen on the receiving thread only.
- ``handle_timeout`` crashes with file descriptors from 1024 on: refused before.
- A subscription's queue keeps the oldest messages: it is drained at once, into queues that keep
  the newest.
- On tcpq, two threads that publish or subscribe at once mix up their bytes: a lock keeps them
  apart.
- A tcpq connection that breaks is closed by the first thread that notices, and its subscriptions
  are gone: the receiving thread makes a new instance, and subscribes again.
- ``handle`` turns Ctrl-C into OSError: the thread waits in ``select`` instead.
"""

import contextlib
import os
import queue
import re
import select
import threading
import time
from collections.abc import Callable

import lcm

from lcmtools.bus.base import Handler
from lcmtools.bus.datagram_filter import open_descriptors, protect
from lcmtools.bus.multicast import receive_buffer_bytes
from lcmtools.bus.paced import PACED_ABOVE_BYTES, PacedSender
from lcmtools.bus.preflight import check_bus
from lcmtools.bus.reconnect import ReconnectBackoff
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.names import check_channel

Instance = lcm.LCM
"""For the types of those who must not import the package."""
QUEUE_CAPACITY = 10_000
"""Messages that liblcm may hold while Python does not get to run."""
_BATCH = 100  # messages handled before a request to subscribe is served
_LOOK_PERIOD = 0.5  # [s] between looks whether a connection broke while something was sent
_REQUEST_TIMEOUT = 15.0  # [s]; above liblcm's own ten seconds


class LcmBus:
    """One LCM instance with one receiving thread.

    Publishing is safe from any thread. Handlers run on the receiving thread and must be quick. A
    connection to a server (tcpq) that is lost is made again when the server is back.

    Args:
        url: The bus.

    Raises:
        BusError: It cannot be reached, with what to type.
    """

    def __init__(self, url: BusUrl) -> None:
        self.url = url
        self.on_outage: Callable[[str], None] = lambda _: None
        self._lcm: lcm.LCM | None = open_lcm(url)
        self._can_come_back = url.provider == "tcpq"
        self._backoff = ReconnectBackoff()
        self._is_broken = False  # as somebody found who tried to send
        self._paced = PacedSender(url) if url.is_multicast else None
        self._handlers: dict[str, list[Handler]] = {}
        self._subscriptions: dict[str, lcm.LCMSubscription] = {}
        self._requests: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._wake_read, self._wake_write = os.pipe()
        self._asking = threading.Lock()
        self._sending = threading.RLock()  # not Lock: a signal handler may publish too
        self._closed = False
        self._thread = threading.Thread(target=self._run, name="lcm receiver", daemon=True)
        self._thread.start()

    @property
    def ports(self) -> list[int]:
        """UDP ports that this instance sends from besides LCM's own (for large messages)."""
        return [self._paced.port] if self._paced else []

    def publish(self, channel: str, payload: bytes) -> None:
        """Send one message; a large one goes out as paced fragments, behind the caller's back.

        Raises:
            BusError: It cannot be sent.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        instance = self._instance()
        is_large = len(payload) > PACED_ABOVE_BYTES
        if self._paced and (is_large or self._paced.has_waiting(channel)):
            self._paced.send(channel, payload)
            return
        try:
            with self._sending:
                instance.publish(channel, payload)
        except OSError as error:
            self._is_broken = instance is self._lcm
            raise BusError(f"cannot publish on {channel}: {error.strerror or error}") from error

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Have ``handler`` called for each message on exactly this channel.

        Raises:
            BusError: The subscription cannot be made.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        self._on_receiver(lambda: self._subscribe(channel, handler))

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        with contextlib.suppress(BusError):  # a closed bus delivers nothing any more
            self._on_receiver(lambda: self._unsubscribe(channel, handler))

    def close(self) -> None:
        """Send what waits, stop the receiving thread and leave the bus."""
        with self._asking:
            if self._closed:
                return
            self._closed = True
        if self._paced:
            self._paced.close()
        self._wake()
        self._thread.join(timeout=2.0)
        os.close(self._wake_read)
        os.close(self._wake_write)
        self._subscriptions.clear()
        self._lcm = None  # a thread that publishes at this moment keeps it a moment longer

    def _instance(self) -> "lcm.LCM":
        instance = self._lcm
        if self._closed:
            raise BusError("the bus is closed")
        if instance is None:
            raise BusError(f"the connection to {self.url} is lost")
        return instance

    def _wake(self) -> None:
        os.write(self._wake_write, b"\0")

    def _on_receiver(self, work: Callable[[], None]) -> None:
        """Run ``work`` on the receiving thread and wait for it; raise here what it raises."""
        if threading.current_thread() is self._thread:
            work()
            return
        done: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()

        def run() -> None:
            try:
                work()
                done.put(None)
            except Exception as error:  # noqa: BLE001 - raised where it was asked for
                done.put(error)

        with self._asking:
            if self._closed:
                raise BusError("the bus is closed")
            self._requests.put(run)
            self._wake()
        try:
            error = done.get(timeout=_REQUEST_TIMEOUT)
        except queue.Empty:
            raise BusError("the receiving thread is stuck in a handler") from None
        if error is not None:
            raise error

    def _subscribe(self, channel: str, handler: Handler) -> None:
        if channel not in self._subscriptions and not self._backoff.is_on:
            self._listen_to(channel)
        self._handlers.setdefault(channel, []).append(handler)

    def _listen_to(self, channel: str) -> None:
        with self._sending:
            subscription = self._instance().subscribe(re.escape(channel), self._dispatch)
        if subscription is None:
            raise BusError(f"LCM refuses to subscribe to '{channel}'")
        subscription.set_queue_capacity(QUEUE_CAPACITY)
        self._subscriptions[channel] = subscription

    def _unsubscribe(self, channel: str, handler: Handler) -> None:
        handlers = self._handlers.get(channel, [])
        if handler in handlers:
            handlers.remove(handler)
        if not handlers and channel in self._subscriptions:
            with self._sending:
                self._instance().unsubscribe(self._subscriptions.pop(channel))

    def _dispatch(self, channel: str, payload: bytes) -> None:
        now = time.time_ns()
        for handler in tuple(self._handlers.get(channel, ())):
            handler(payload, now)

    def _run(self) -> None:
        """The receiving thread: wait, drain the library, do what was asked."""
        instance = self._lcm
        descriptor = None if instance is None else int(instance.fileno())
        del instance  # it is let go of where the connection breaks
        while not self._closed:
            descriptor = self._turn(descriptor)
        self._do_requests()  # what was asked while it closed

    def _turn(self, descriptor: int | None) -> int | None:
        """Wait, and do what there is to do; None where nothing comes, for good or for now."""
        works, readable = self._wait(descriptor)
        if self._wake_read in readable:
            os.read(self._wake_read, 4096)
            self._do_requests()
        if descriptor is not None:
            if works and descriptor in readable:
                works = self._handle()
            if works and not (self._is_broken and self._can_come_back):
                return descriptor
            if self._can_come_back and not self._closed:
                self._lose()
            return None  # requests are served still
        if self._backoff.left(time.monotonic()) == 0.0:
            return self._reconnect()
        return None

    def _wait(self, descriptor: int | None) -> tuple[bool, list[int]]:
        """Wait for messages, requests and attempts; whether that works, and what can be read."""
        sources = [self._wake_read, *([] if descriptor is None else [descriptor])]
        is_watched = self._can_come_back and descriptor is not None
        longest = _LOOK_PERIOD if is_watched else self._backoff.left(time.monotonic())
        try:
            return True, select.select(sources, [], [], longest)[0]
        except OSError:  # a connection that broke was closed by the publishing thread
            return False, []

    def _lose(self) -> None:
        """Let go of a connection that broke."""
        self._backoff.begin(time.monotonic())
        with self._sending:
            self._subscriptions.clear()
            self._lcm = None
        self.on_outage(f"the connection to {self.url} is lost; it is tried again until it is back")

    def _reconnect(self) -> int | None:
        """Try to make the connection again; what to wait for, None where it is not back."""
        try:
            instance = open_lcm(self.url)
            with self._sending:
                self._lcm, self._is_broken = instance, False
                for channel in (name for name, handlers in self._handlers.items() if handlers):
                    self._listen_to(channel)
        except (BusError, OSError):
            self._subscriptions.clear()
            self._lcm = None
            self._backoff.put_off(time.monotonic())
            return None
        self._backoff.end()
        self.on_outage(f"the connection to {self.url} is back")
        return int(instance.fileno())

    def _do_requests(self) -> None:
        while not self._requests.empty():
            self._requests.get()()

    def _handle(self) -> bool:
        """Hand on messages that wait; False at the end of a log or a connection."""
        instance = self._lcm
        if instance is None:
            return False
        try:
            for _ in range(_BATCH):
                if self._closed or not instance.handle_timeout(0):
                    break
        except OSError:
            return False
        return True


def open_lcm(url: BusUrl) -> "lcm.LCM":
    """Make an LCM instance, after checking what would make liblcm hang or print.

    Raises:
        BusError: The bus cannot be reached, with what to do.
    """
    check_bus(url)
    if url.provider in ("udpm", "mpudpm"):
        url = url.with_option("ttl", "0")
    if url.is_multicast:
        url = url.with_option("recv_buf_size", str(receive_buffer_bytes()))
    known = open_descriptors()
    try:
        instance = lcm.LCM(str(url))
        instance.fileno()  # only now are the receiving sockets made
    except (RuntimeError, OSError) as error:
        raise BusError(f"LCM cannot open {url}") from error
    if url.is_multicast:
        protect(url, known)
    return instance
