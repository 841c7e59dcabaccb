"""The sockets with which an observer receives a multicast group's datagrams.

Linux grants a socket 208 KiB and counts twice that, which six fragments of a large message fill,
but liblcm sends all fragments at once. An observer that must lose nothing uses several sockets,
each with its own buffer: filters in the kernel give some a share of the short messages each, and
the others a share of the fragments each. Each datagram costs its sender a little for each socket,
so there are no more than necessary.
"""

import select
import socket
import time
from collections.abc import Callable, Sequence
from operator import itemgetter

from lcmtools.bus.kernel import IS_LINUX, SELECTIVE, attach, mark, request_arrival
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.socket_filter import fragments_only, nothing, short_only
from lcmtools.bus.url import BusUrl
from lcmtools.wire.datagram import FRAGMENT_MAX, SHORT_MESSAGE_MAX
from lcmtools.wire.packet import Packet

_FRAGMENT_ROOM = 70_000  # bytes of a buffer that a whole fragment takes, with the kernel's overhead
_SHORT_ROOM, _MOST_GROWTH = 900, 1.5
"""A short message's overhead, and the factor of its size, which is rounded to powers of two."""
_PAYLOAD: Callable[[Packet], bytes] = itemgetter(1)
_MOST_SHARES = 8
_SHORT_SHARES, _SMALL = 4, 1 << 20  # sockets for short messages if a buffer has fewer bytes
_WANTED, _NEEDED = 32, 2  # largest messages for which there should be, and must be, room


class ObserverSockets:
    """The sockets of one observer, initially one."""

    def __init__(self, url: BusUrl) -> None:
        self._url = url
        self.all = [receiving_socket(url)]
        self.all[0].settimeout(0.0)
        # true if the system gives each datagram's receive time
        self.has_times = request_arrival(self.all[0])
        self._granted = self.all[0].getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        self._room = max(1, self._granted // _FRAGMENT_ROOM)  # fragments in a socket's buffer
        self.short = self.all[:]  # sockets for short messages, at first the one for all
        self._shares = self._message_bytes = 0
        # messages from before this time are ignored: they may have come twice, or not at all
        self.since = 0
        # true if two messages as large as the largest so far fit into the buffers together
        self.has_room = False
        self._poll = select.poll()
        self._poll.register(self.all[0], select.POLLIN)

    def close(self) -> None:
        """Leave the group."""
        for receiver in self.all:
            receiver.close()

    def ready(self, timeout: float) -> list[socket.socket]:
        """Wait up to ``timeout`` [s] for a datagram; return the sockets that have one."""
        found = {number for number, _ in self._poll.poll(timeout * 1000)}
        return [one for one in self.all if one.fileno() in found] if found else []

    def filled_by(self, packets: Sequence[Packet]) -> float:
        """Return roughly which part of a socket's buffer the short messages among these take."""
        short = sum(map(len, map(_PAYLOAD, packets)))
        if short > SHORT_MESSAGE_MAX:
            sizes = map(len, map(_PAYLOAD, packets))
            short = sum(size for size in sizes if size <= SHORT_MESSAGE_MAX)
        taken = _SHORT_ROOM * len(packets) + _MOST_GROWTH * short
        return taken / (self._granted * len(self.short))

    def make_room(self, message_bytes: int) -> None:
        """Make room for messages of this size; sockets that are no longer needed are kept.

        Raises:
            BusError: A socket cannot be created.
        """
        if message_bytes <= self._message_bytes:
            return
        self._message_bytes = message_bytes
        fragments, shares = -(-message_bytes // FRAGMENT_MAX), 1
        while shares * self._room < _WANTED * fragments and shares < _MOST_SHARES:
            shares *= 2
        if shares > self._shares:
            self._divide(shares)
        self.has_room = self._shares * self._room >= _NEEDED * fragments

    def _divide(self, shares: int) -> None:
        """Divide the fragments into shares; the first time, also the short messages."""
        if not IS_LINUX:
            return
        shorts = _SHORT_SHARES if self._granted < _SMALL else 1
        while len(self.all) < shorts + shares:  # new ones receive nothing yet
            receiver = receiving_socket(self._url, nothing())
            receiver.settimeout(0.0)
            self.all.append(receiver)
            self._poll.register(receiver, select.POLLIN)
        self.short, large = self.all[:shorts], self.all[shorts:]
        # in this order fragments may come twice, but never a whole message
        for share, receiver in reversed([*enumerate(large)]):
            attach(receiver, fragments_only(share, shares))
        if not self._shares:
            for share, receiver in enumerate(self.short):
                attach(receiver, short_only(share, shorts))
            mark(self.all[0], SELECTIVE)
            self.since = time.time_ns()
        self._shares = shares
