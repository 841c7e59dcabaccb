"""Observing all messages of a bus without multicast; see ``observe.sources.Observer``."""

import contextlib
import select
import time
from collections.abc import Callable, Mapping
from types import MappingProxyType

from lcmtools.bus.liblcm import QUEUE_CAPACITY, Connection, Instance
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence


class LcmObserver(contextlib.AbstractContextManager["LcmObserver"]):
    """An observer of a bus that is not a multicast group: an ordinary subscription to everything.

    It has the tap's interface but less information: no senders and no sequence numbers. Programs
    that do not answer probes are therefore known only by their messages.

    Raises:
        BusError: The bus cannot be reached.
    """

    port = 0
    is_live, is_awaiting = True, False
    numbered: Mapping[Sender, Sequence] = MappingProxyType({})

    def __init__(
        self, url: BusUrl, on_outage: Callable[[str, str], None] = lambda _text, _trouble: None
    ) -> None:
        self._url = url
        self.is_log = url.provider == "file"
        self.has_strangers = url.provider in ("tcpq", "mpudpm")
        self._packets: list[Packet] = []
        self._connection = Connection(url, self._subscribe, on_outage)

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._connection.close()

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message; on a log that is being read this does nothing.

        Raises:
            BusError: It cannot be sent.
        """
        if self.is_log:
            return
        instance, is_lost = self._connection.instance, self._connection.is_lost
        if instance is None:
            lost = f"the connection to {self._url} is lost"
            raise BusError(lost if is_lost else "the bus is closed")
        try:
            instance.publish(channel, payload)
        except OSError as error:
            raise BusError(f"cannot publish on {channel}") from error

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first.

        Raises:
            EOFError: The log has ended, or the bus is closed.
        """
        connection = self._connection
        if (left := connection.left()) is not None:
            time.sleep(max(0.0, min(left, timeout)))
            if left <= timeout:
                connection.try_again()
            return []
        if connection.instance is None:
            raise EOFError
        try:
            if select.select([connection.instance.fileno()], [], [], max(0.0, timeout))[0]:
                connection.instance.handle_timeout(0)
        except (OSError, ValueError):  # it has ended, or liblcm closed it when sending failed
            connection.lose()
        packets, self._packets = self._packets, []
        return packets

    def _subscribe(self, instance: Instance) -> None:
        def collect(channel: str, payload: bytes) -> None:
            self._packets.append(Packet(channel, payload, time.time_ns()))

        instance.subscribe(".*", collect).set_queue_capacity(QUEUE_CAPACITY)
