"""The ends of a relay: connections to a bus that receive all messages except their own."""

import math
import socket
import time
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Protocol

from lcmtools.bus.processes import is_local
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, UsageError, os_errors_as
from lcmtools.graph.protocol import PROTOCOL_CHANNELS
from lcmtools.names import check_channel
from lcmtools.observe.reading.losses import Loss, losses
from lcmtools.relay.bulk_connection import BULK_BYTES, BulkConnection
from lcmtools.relay.echo import EchoFilter
from lcmtools.relay.fair_queue import LineMessage
from lcmtools.wire.packet import Packet, Sender

_NAP = 0.0002  # [s] that messages of a stream wait to be read together
_PATIENCE = 10  # [s]
_LOOPBACK = "127."
_MOST_HOPS = 16  # most relays that a message may pass


class BusEnd(Protocol):
    """A connection to a bus: one thread receives, another sends."""

    # UDP ports that it sends from, 0 on Zenoh; empty if the bus does not identify senders.
    ports: tuple[int, ...]
    takes_origin: bool  # True if the bus carries a message's origin with it
    is_quick: bool  # True if sending a short message never blocks
    trouble: str  # the reason why the bus cannot be reached; "" for none

    @property
    def dropped(self) -> int:
        """The number of messages that were not sent, because the bus was too slow."""

    @property
    def dropped_of(self) -> Mapping[str, int]:
        """The same for each channel."""

    def receive(self, timeout: float) -> list[Packet]:
        """Return what others have sent, waiting up to ``timeout`` [s] for the first."""

    def send(self, message: LineMessage, /) -> None:
        """Send a message, even if that takes time; with its origin, if the bus carries it.

        Raises:
            BusError: It cannot be sent.
        """

    def losses(self) -> Mapping[Sender, Loss]:
        """Return the messages that did not arrive here."""

    def close(self) -> None:
        """Leave the bus."""


class _UdpmEnd:  # an end at a multicast group
    takes_origin, is_quick, dropped = False, True, 0
    dropped_of: Mapping[str, int] = MappingProxyType({})

    def __init__(self, url: BusUrl) -> None:
        self._url = url
        self._tap = Tap(url, whole=True, spread=True, hears_itself=False)
        self._tap.longest_nap = _NAP
        self.ports: tuple[int, ...] = (self._tap.port,)
        self._own: set[Sender] = set()
        self.trouble = ""

    def receive(self, timeout: float) -> list[Packet]:
        packets, own, ports = self._tap.receive(timeout), self._is_own, self.ports
        return [p for p in packets if not (p.sender and p.sender.port in ports and own(p.sender))]

    def send(self, message: LineMessage) -> None:
        try:
            with os_errors_as(f"cannot send to {self._url.host}", kind=BusError):
                self._tap.sender.send(message.channel, message.payload)
        except BusError as error:
            self.trouble = str(error)
            raise
        self.trouble = ""

    def losses(self) -> Mapping[Sender, Loss]:
        numbered = {k: v for k, v in self._tap.numbered.items() if not self._is_own(k)}
        return losses(numbered)

    def close(self) -> None:
        self._tap.close()

    def _is_own(self, sender: Sender) -> bool:
        if sender not in self._own and sender.port in self.ports and is_local(sender.address):
            self._own.add(sender)
        return sender in self._own


class _ZenohEnd:  # an end at a Zenoh bus, which carries each message's origin with it
    ports: tuple[int, ...] = (0,)
    takes_origin, is_quick = True, False

    def __init__(self, url: BusUrl) -> None:
        from lcmtools.bus.zenoh.observer import ZenohObserver

        self.trouble = ""
        # longer than for local programs: a lossy long-distance line can stall for seconds
        patient = url.with_option("patience", str(_PATIENCE))
        self._observer = ZenohObserver(patient, self._note, is_relay=True)

    @property
    def dropped(self) -> int:
        return self._observer.dropped

    @property
    def dropped_of(self) -> Mapping[str, int]:
        return self._observer.dropped_of

    def receive(self, timeout: float) -> list[Packet]:
        try:
            packets = self._observer.receive(timeout)
        except EOFError:  # it is closing
            return []
        own = self._observer.sender
        others = (packet for packet in packets if packet.sender != own)
        return [one for one in others if one.origin is None or one.origin.hops < _MOST_HOPS]

    def send(self, message: LineMessage) -> None:
        is_state = message.due == math.inf
        self._observer.send(message.channel, message.payload, message.origin, latched=is_state)

    def losses(self) -> Mapping[Sender, Loss]:
        return losses(self._observer.numbered)

    def close(self) -> None:
        self._observer.close()

    def _note(self, _text: str, trouble: str) -> None:
        self.trouble = trouble


class _TcpqEnd:  # an end at a server, which sends everything back
    ports: tuple[int, ...] = ()
    takes_origin = is_quick = False

    def __init__(self, url: BusUrl) -> None:
        from lcmtools.bus.lcm_observer import LcmObserver

        self.trouble = ""
        self._echo = EchoFilter()
        self._observer = LcmObserver(url, self._note)
        self._bulk = BulkConnection(url, self._note_sending)
        self._bulk_channels: set[str] = set()

    @property
    def dropped(self) -> int:
        return self._bulk.failed + self._bulk.queue.waiting.dropped

    @property
    def dropped_of(self) -> Mapping[str, int]:
        return self._bulk.queue.waiting.dropped_of

    def receive(self, timeout: float) -> list[Packet]:
        try:
            self._bulk.attend(self._observer.own_address)
            packets = self._observer.receive(timeout, self._bulk.sockets)
        except EOFError:  # it is closing
            time.sleep(timeout)
            return []
        packets += self._bulk.receive()
        is_echo = self._echo.is_echo
        return [packet for packet in packets if not is_echo(packet.channel, packet.payload)]

    def send(self, message: LineMessage) -> None:
        check_channel(message.channel)
        is_large = len(message.payload) > BULK_BYTES and message.channel not in PROTOCOL_CHANNELS
        if is_large and self._bulk.sockets:
            self._bulk_channels.add(message.channel)
        if message.channel in self._bulk_channels:
            self._bulk.queue.add([message])
            return
        self._note_sending(message)
        self._observer.send(message.channel, message.payload)

    def losses(self) -> Mapping[Sender, Loss]:
        return {}

    def close(self) -> None:
        self._bulk.close()
        self._observer.close()

    def _note_sending(self, message: LineMessage) -> None:
        self._echo.sends(message.channel, message.payload)

    def _note(self, _text: str, trouble: str) -> None:
        self.trouble = trouble
        self._echo.clear()


_KINDS: Mapping[str, Callable[[BusUrl], BusEnd]] = {
    "udpm": _UdpmEnd,
    "tcpq": _TcpqEnd,
    "zenoh": _ZenohEnd,
}


def check_end(url: BusUrl) -> None:
    """Raise UsageError for a URL that a relay cannot join: a log, or an unsupported bus."""
    if url.provider not in _KINDS:
        kinds = ", ".join(f"{kind}://" for kind in _KINDS)
        raise UsageError(f"{url} cannot be joined by a relay", f"it joins buses of {kinds}")


def open_end(url: BusUrl) -> BusEnd:
    """Return an end at a bus; BusError if it cannot be reached, which says what to type."""
    return _KINDS[url.provider](url)


def bus_name(url: BusUrl) -> str:
    """Return a name for a bus that is meaningful to people on other computers."""
    name = f"{url.provider}://{url.host}:{url.port}" if url.host else str(url).partition("?")[0]
    is_here = url.host.startswith(_LOOPBACK) or (url.is_multicast and not url.ttl)
    return f"{name} on {socket.gethostname()}" if is_here else name
