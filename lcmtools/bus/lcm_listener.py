"""Hearing everything on a bus that is no multicast group, by liblcm; see ``watch.Observer``."""

import select
import time
from collections.abc import Callable

from lcmtools.bus.liblcm import QUEUE_CAPACITY, Instance, open_lcm
from lcmtools.bus.reconnect import ReconnectBackoff
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet


class LcmListener:
    """An observer of a bus that is no multicast group: an ordinary subscription to everything.

    It has the tap's interface and knows less: neither senders nor sequence numbers. A connection to
    a server (tcpq) that is lost is made again when the server is back.

    Args:
        url: The bus.
        on_outage: Told that the connection is lost or back, and what is wrong now, "" for nothing.

    Raises:
        BusError: The bus cannot be reached.
    """

    def __init__(
        self, url: BusUrl, on_outage: Callable[[str, str], None] = lambda _text, _trouble: None
    ) -> None:
        self._url = url
        self._on_outage = on_outage
        self._backoff = ReconnectBackoff()
        self._packets: list[Packet] = []
        self._lcm: Instance | None = self._open()

    def __enter__(self) -> "LcmListener":
        """Use the listener as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._lcm = None
        self._backoff.end()

    port = 0

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message; on a log that is being read this does nothing.

        Raises:
            BusError: It cannot be sent.
        """
        if self._url.provider == "file":
            return
        if self._lcm is None:
            raise BusError(
                f"the connection to {self._url} is lost"
                if self._backoff.is_on
                else "the bus is closed"
            )
        try:
            self._lcm.publish(channel, payload)
        except OSError as error:
            raise BusError(f"cannot publish on {channel}") from error

    def receive(self, timeout: float) -> list[Packet]:
        """The messages that have arrived, waiting up to ``timeout`` seconds for the first.

        Raises:
            EOFError: The log has ended, or the bus is closed.
        """
        if self._backoff.is_on:
            self._try_again(timeout)
            return []
        if self._lcm is None:
            raise EOFError
        try:
            if select.select([self._lcm.fileno()], [], [], max(0.0, timeout))[0]:
                self._lcm.handle_timeout(0)
        except (OSError, ValueError):  # at its end, or closed by liblcm when sending failed
            self._lose()
        packets, self._packets = self._packets, []
        return packets

    def _open(self) -> Instance:
        instance = open_lcm(self._url)
        instance.subscribe(".*", self._collect).set_queue_capacity(QUEUE_CAPACITY)
        return instance

    def _lose(self) -> None:
        """Let go of a connection that broke, or of a log that has ended."""
        self._lcm = None
        if self._url.provider == "tcpq":
            self._backoff.begin(time.monotonic())
            text = f"the connection to {self._url} is lost; it is tried again until it is back"
            self._on_outage(text, text)

    def _try_again(self, timeout: float) -> None:
        """Wait for the next attempt, or for the timeout; make the attempt where it is due."""
        left = self._backoff.left(time.monotonic()) or 0.0
        time.sleep(max(0.0, min(left, timeout)))
        if left > timeout:
            return
        try:
            self._lcm = self._open()
        except (BusError, OSError):
            self._backoff.put_off(time.monotonic())
            return
        self._backoff.end()
        self._on_outage(f"the connection to {self._url} is back", "")

    def _collect(self, channel: str, payload: bytes) -> None:
        self._packets.append(Packet(channel, payload, time.time_ns()))
