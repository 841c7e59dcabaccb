"""Hearing everything on a bus that is no multicast group, by liblcm; see ``watch.Observer``."""

import select
import time

from lcmtools.bus.liblcm import QUEUE_CAPACITY, Instance, open_lcm
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet


class LcmListener:
    """An observer of a bus that is no multicast group: an ordinary subscription to everything.

    It has the tap's interface and knows less: neither senders nor sequence numbers.

    Raises:
        BusError: The bus cannot be reached.
    """

    def __init__(self, url: BusUrl) -> None:
        instance = open_lcm(url)
        instance.subscribe(".*", self._collect).set_queue_capacity(QUEUE_CAPACITY)
        self._lcm: Instance | None = instance
        self._is_log = url.provider == "file"
        self._packets: list[Packet] = []

    def __enter__(self) -> "LcmListener":
        """Use the listener as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._lcm = None

    port = 0

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message; on a log that is being read this does nothing.

        Raises:
            BusError: It cannot be sent.
        """
        if self._is_log:
            return
        if self._lcm is None:
            raise BusError("the bus is closed")
        try:
            self._lcm.publish(channel, payload)
        except OSError as error:
            raise BusError(f"cannot publish on {channel}") from error

    def receive(self, timeout: float) -> list[Packet]:
        """The messages that have arrived, waiting up to ``timeout`` seconds for the first.

        Raises:
            EOFError: The log has ended, or the connection is closed.
        """
        if self._lcm is None:
            raise EOFError
        try:
            if select.select([self._lcm.fileno()], [], [], max(0.0, timeout))[0]:
                self._lcm.handle_timeout(0)
        except (OSError, ValueError):  # at its end, or closed by liblcm when sending failed
            self._lcm = None
        packets, self._packets = self._packets, []
        return packets

    def _collect(self, channel: str, payload: bytes) -> None:
        self._packets.append(Packet(channel, payload, time.time_ns()))
