"""Observing all messages of a Zenoh bus; see ``observe.sources.Observer``."""

import contextlib
import select
from collections.abc import Callable, Mapping

from lcmtools.bounded import BoundedDict
from lcmtools.bus.url import BusUrl
from lcmtools.bus.zenoh.session import ZenohSession
from lcmtools.errors import BusError
from lcmtools.names import check_length
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence
from lcmtools.wire.stamp import Origin


class ZenohObserver(contextlib.AbstractContextManager["ZenohObserver"]):
    """An observer of a Zenoh bus: a subscription to everything, with the senders of messages.

    ``on_outage`` is that of ``ZenohSession``.

    Raises:
        BusError: The bus cannot be reached.
        MissingExtra: Zenoh is not installed.
    """

    port = 0
    is_live, is_log = True, False

    def __init__(
        self,
        url: BusUrl,
        on_outage: Callable[[str, str], None] = lambda _text, _trouble: None,
        *,
        is_relay: bool = False,
    ) -> None:
        self._session = ZenohSession(url, on_outage)
        # a relay reports what it drops: it does not count as lost
        self._session.sender.numbers_when_sent = is_relay
        self._session.sender.hears_itself = not is_relay
        self._closed = False
        # This observer as the sender of its own messages.
        self.sender = Sender(f"{self._session.id:016x}", 0)
        # Each sender's sequence numbers, which show its losses.
        self.numbered = BoundedDict[Sender, Sequence]()
        self._session.subscribe(None)

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._closed = True
        self._session.close()

    @property
    def dropped(self) -> int:
        """The number of messages that were not sent, because the network was too slow."""
        return self._session.sender.dropped

    @property
    def dropped_of(self) -> Mapping[str, int]:
        """The same for each channel."""
        return self._session.dropped_of()

    @property
    def is_awaiting(self) -> bool:
        """True while answers to a probe may still come."""
        return self._session.is_awaiting

    @property
    def has_strangers(self) -> bool:
        """True if programs that do not answer probes may publish."""
        return self._session.has_strangers

    def send(
        self, channel: str, payload: bytes, origin: Origin | None = None, *, latched: bool = False
    ) -> None:
        """Publish one message, with its original sender if it came from another bus.

        Raises:
            BusError: It cannot be sent.
        """
        check_length(channel)
        if self._closed:
            raise BusError("the bus is closed")
        self._session.publish(channel, payload, origin=origin, latched=latched)

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first.

        Raises:
            EOFError: The bus is closed.
        """
        if self._closed:
            raise EOFError
        select.select([self._session], [], [], max(0.0, timeout))
        packets = self._session.receive()
        for packet in packets:
            if packet.sender is not None and packet.seqno is not None:
                sequence = self.numbered.use(packet.sender)
                if sequence is None:
                    sequence = self.numbered[packet.sender] = Sequence()
                sequence.add(packet.seqno)
        return packets
