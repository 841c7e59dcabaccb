"""Sending on a Zenoh session: each message with a stamp, small ones before bulk ones.

A message is sent at once, or waits for room: later ones wait in a ``KeepLastSender``.
"""

import contextlib
import itertools
import time
from collections import Counter

from lcmtools.bus.line_buffer import Addresses, LineBuffers
from lcmtools.bus.zenoh.keep_last_sender import (
    CLOCK,
    MOST_WAITING_BYTES,
    KeepLastSender,
    Outgoing,
)
from lcmtools.bus.zenoh.opening import direct, zenoh
from lcmtools.bus.zenoh.url import locator_address
from lcmtools.graph.protocol import PROTOCOL_CHANNELS
from lcmtools.wire.stamp import Origin, encode_stamp

_BULK_BYTES = 4000  # larger messages give way to the small ones of other topics
_MOST_PUBLISHERS = 1000  # that are kept
_SLOW = 0.01  # [s]: a message that took longer to send had to wait for the network


class ZenohSender:
    """Sends the messages of a session, whose id is ``identifier``.

    Attributes:
        numbers_when_sent: True if dropped messages shall not count as lost.
        hears_itself: False if the session must not receive what it sends.
    """

    def __init__(self, session: zenoh.Session, identifier: int) -> None:
        self._session, self._id = session, identifier
        self.numbers_when_sent = False
        self.hears_itself = True
        self._numbers = itertools.count(1)
        self._publishers: dict[tuple[str, bool], zenoh.Publisher] = {}
        self._bulk_keys: set[str] = set()
        self._large_keys: set[str] = set()
        self._is_slow = False  # True if small messages have to wait for the network
        self._small = KeepLastSender(self._put_quietly)
        self._bulk = KeepLastSender(self._put_bulk)
        self._lines = LineBuffers()
        session.info.declare_link_events_listener(direct(self._note_link))
        self._follow_lines()

    @property
    def dropped(self) -> int:
        """The number of messages that were dropped because the network was too slow."""
        return self._small.dropped + self._bulk.dropped

    def dropped_of(self) -> Counter[str]:
        """Return the same for each key."""
        return Counter(dict(self._small.dropped_of)) + Counter(dict(self._bulk.dropped_of))

    def full_lines(self) -> list[str]:
        """Return the addresses at the other ends of lines that were full in the last seconds."""
        return self._lines.full(time.monotonic())

    def send(
        self, channel: str, key: str, payload: bytes, origin: Origin | None, *, may_be_late: bool
    ) -> None:
        """Send one message of a channel, or queue it; raise ZError if the session is closed."""
        message = self._outgoing(channel, key, payload, origin, may_be_late=may_be_late)
        if message.is_bulk:
            self._bulk.add(message)
        elif self._is_slow or self._small.has_waiting(key):
            self._small.add(message)
        else:
            self._put(message)

    def close(self) -> None:
        """Send waiting messages, for half a second at most."""
        self._small.close()
        self._bulk.close()

    def _note_link(self, _event: zenoh.LinkEvent) -> None:
        self._follow_lines()

    def _follow_lines(self) -> None:
        """Let the kernel buffer little of what is sent to other computers."""
        ends = (
            tuple(map(_socket_address, (link.src, link.dst))) for link in self._session.info.links()
        )
        self._lines.follow(Addresses(own, other) for own, other in ends if own and other)

    def _outgoing(
        self, channel: str, key: str, payload: bytes, origin: Origin | None, *, may_be_late: bool
    ) -> Outgoing:
        """Return a message with its class: all messages of a topic keep the one of the largest."""
        if len(payload) > MOST_WAITING_BYTES:
            self._large_keys.add(key)
        if len(payload) > _BULK_BYTES and channel not in PROTOCOL_CHANNELS:
            self._bulk_keys.add(key)
        is_large = key in self._large_keys  # only the newest of these waits, so none is outdated
        now = 0 if may_be_late or is_large else time.clock_gettime_ns(CLOCK)
        number = 0 if self.numbers_when_sent else next(self._numbers)
        return Outgoing(key, payload, number, now, origin, is_large or key in self._bulk_keys)

    def _put(self, message: Outgoing) -> None:
        """Send a message: a small one waits for room; later ones then wait in a queue."""
        publisher = self._publishers.get((message.key, message.is_bulk))
        if publisher is None:
            if len(self._publishers) >= _MOST_PUBLISHERS:  # a new channel for each call has no end
                for known in (self._publishers, self._bulk_keys, self._large_keys):
                    known.clear()
            publisher = self._publishers[message.key, message.is_bulk] = self._declare(message)
        number = message.number or next(self._numbers)
        stamp = encode_stamp(self._id, number, message.time, message.origin)
        start = time.monotonic()
        publisher.put(message.payload, attachment=stamp)
        end = time.monotonic()
        if not message.is_bulk:
            self._is_slow = end - start > _SLOW
        if end - start > _SLOW:
            self._lines.adjust(end)

    def _put_bulk(self, message: Outgoing) -> None:
        """Send a bulk message after the small ones of its topic that still wait."""
        self._small.await_sent(message.key)
        self._put_quietly(message)

    def _put_quietly(self, message: Outgoing) -> None:
        with contextlib.suppress(zenoh.ZError):  # the session is closed
            self._put(message)

    def _declare(self, message: Outgoing) -> zenoh.Publisher:
        """Return a publisher; small messages may overtake bulk ones of other topics."""
        priority = zenoh.Priority.DATA_LOW if message.is_bulk else zenoh.Priority.DATA
        anywhere, elsewhere = zenoh.Locality.ANY, zenoh.Locality.REMOTE
        return self._session.declare_publisher(
            message.key,
            congestion_control=zenoh.CongestionControl.BLOCK,
            priority=priority,
            allowed_destination=anywhere if self.hears_itself else elsewhere,
        )


def _socket_address(locator: str) -> tuple[str, int] | None:
    address = locator_address(locator)
    return (address.host.strip("[]"), address.port) if address else None
