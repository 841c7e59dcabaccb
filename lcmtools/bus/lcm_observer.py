"""Observing all messages of a bus without multicast; see ``observe.sources.Observer``."""

import contextlib
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from lcmtools.bus.liblcm import QUEUE_CAPACITY, Connection, Instance
from lcmtools.bus.line_buffer import Addresses, LineBuffers
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire import sequence
from lcmtools.wire.packet import Packet, Sender

_SLOW = 0.01  # [s]: a message that took longer to send had to wait for the network


class LcmObserver(contextlib.AbstractContextManager["LcmObserver"]):
    """An observer of a bus that is not a multicast group: an ordinary subscription to everything.

    It has the tap's interface but less information: no senders and no sequence numbers. Programs
    that do not answer probes are therefore known only by their messages.

    Raises:
        BusError: The bus cannot be reached.
    """

    port = 0
    is_live, is_awaiting = True, False
    numbered: Mapping[Sender, sequence.Sequence] = MappingProxyType({})

    def __init__(
        self, url: BusUrl, on_outage: Callable[[str, str], None] = lambda _text, _trouble: None
    ) -> None:
        self._url = url
        self.is_log = url.provider == "file"
        self.has_strangers = url.provider in ("tcpq", "mpudpm")
        self._packets: list[Packet] = []
        self._lines = LineBuffers()
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
        start = time.monotonic()
        try:
            self._connection.publish(channel, payload)
        except OSError as error:
            raise BusError(f"cannot publish on {channel}") from error
        if (end := time.monotonic()) - start > _SLOW:
            self._lines.adjust(end)

    @property
    def own_address(self) -> str:
        """The address of this end of a connection to a server, "HOST:PORT"; "" for none."""
        instance = self._connection.instance
        with contextlib.suppress(OSError):
            if instance is not None and self._url.provider == "tcpq":
                return "{}:{}".format(*Addresses.of(instance.fileno()).own)
        return ""

    def receive(self, timeout: float, also: Sequence[socket.socket] = ()) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first.

        It also stops waiting when one of the sockets ``also`` is readable.

        Raises:
            EOFError: The log has ended, or the bus is closed.
        """
        if self._connection.instance is None and not self._connection.is_lost:
            raise EOFError
        self._connection.receive(max(0.0, timeout), [one.fileno() for one in also])
        packets, self._packets = self._packets, []
        return packets

    def _subscribe(self, instance: Instance) -> None:
        if self._url.provider == "tcpq":
            self._lines.follow([Addresses.of(instance.fileno())])

        def collect(channel: str, payload: bytes) -> None:
            self._packets.append(Packet(channel, payload, time.time_ns()))

        instance.subscribe(".*", collect).set_queue_capacity(QUEUE_CAPACITY)
