"""The sockets that receive a multicast group's datagrams, and reading them in order of arrival.

Linux grants a socket 208 KiB and counts twice that, which six fragments of a large message fill,
but liblcm sends all fragments at once. A receiver that must lose nothing uses several sockets, each
with its own buffer: filters in the kernel give some a share of the short messages each, and the
others a share of the fragments each. Each datagram costs its sender a little for each socket, so
there are no more than necessary.
"""

import select
import socket
import time
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from operator import itemgetter
from typing import TYPE_CHECKING

from lcmtools.bus.kernel import (
    ANCILLARY_BYTES,
    ANNOUNCED,
    IS_LINUX,
    SELECTIVE,
    arrival,
    attach,
    buffer,
    mark,
    request_arrival,
)
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.socket_filter import (
    FilterProgram,
    but_from,
    everything,
    nothing,
    short_only,
    wanted,
)
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import FRAGMENT_MAX
from lcmtools.wire.packet import Datagram, Sender

if TYPE_CHECKING:
    from lcmtools.bus.datagram_batch import DatagramBatch

MAX_DATAGRAM = 65536  # bytes
_FRAGMENT_ROOM = 70_000  # bytes of a buffer that a whole fragment takes, with the kernel's overhead
_MOST_SHARES = 8
_SHORT_SHARES, _SMALL = 4, 1 << 20  # sockets for short messages if a buffer has fewer bytes
_NEEDED = 2  # largest messages for which there must be room
_MOST_OVERHEAD, _MOST_GROWTH = 900, 2
"""The most that a datagram takes of a buffer: bytes, and the factor of its size."""
_DATA: Callable[[Datagram], bytes] = itemgetter(0)
_TIME: Callable[[Datagram], int] = itemgetter(2)


class GroupReceiver:
    """The sockets of one receiver, initially one with ``program`` as its filter.

    Attributes:
        all: The sockets.
        short: Those for short messages, at first the one for all.
        since: The time of dividing the sockets [ns], 0 if nothing from before is left.
        has_times: True if the system gives each datagram's receive time.
        is_stream: Set to read many short messages with one call from now on.
        has_room: True if two messages as large as the largest so far fit into the buffers together.
    """

    largest_together = 32
    """Number of the largest messages for which there should be room."""
    mark = SELECTIVE
    """The mark of sockets with filters."""
    own_port = 0
    """If not 0, nothing is received that this computer sends from this port, once it divides."""
    is_observer = True
    """If so, short messages have several sockets too, and fragments always have some of their own.

    What came while it divided its sockets may have come twice, and before it not at all: an
    observer ignores it."""

    def __init__(self, url: BusUrl, program: FilterProgram | None = None) -> None:
        self._url = url
        self.all = [receiving_socket(url, program)]
        self.has_times = request_arrival(self.all[0])
        self.granted = self.all[0].getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        self._room = max(1, self.granted // _FRAGMENT_ROOM)  # fragments in a socket's buffer
        self.short = self.all[:]
        self.shares = self._message_bytes = 0
        self._is_divisible = IS_LINUX
        self.since = 0
        self.overflows = 0  # as of ``count_overflows``
        self._dropped: dict[socket.socket, int] = {}  # when they were looked at last
        self._freed: Counter[socket.socket] = Counter()  # bytes of their buffers since then
        self._held: list[Datagram] = []
        self._batches: dict[socket.socket, DatagramBatch | None] = {}
        self.is_stream = False
        self.has_room = False
        self._poll = select.poll()
        self._poll.register(self.all[0], select.POLLIN)

    def count_overflows(self) -> None:
        """Count what the kernel dropped since the last call, if a buffer is at least half full.

        For an observer, also if one may have been, before ``read`` read from it.
        """
        for receiver in self.all:
            if found := buffer(receiver):
                if 2 * (found.used + self._freed.pop(receiver, 0)) >= found.limit:
                    self.overflows += found.dropped - self._dropped.get(receiver, 0)
                self._dropped[receiver] = found.dropped

    def close(self) -> None:
        """Leave the group."""
        for receiver in self.all:
            receiver.close()

    def ready(self, timeout: float) -> list[socket.socket]:
        """Wait up to ``timeout`` [s] for a datagram; return the sockets that have one."""
        found = {number for number, _ in self._poll.poll(timeout * 1000)}
        return [one for one in self.all if one.fileno() in found] if found else []

    @property
    def has_more(self) -> bool:
        """True if datagrams were read that ``read`` has not returned yet."""
        return bool(self._held)

    def read(self, most: int) -> Iterable[Datagram]:
        """Return what has arrived, about ``most`` datagrams of each socket, in order of arrival.

        Datagrams that arrive while several sockets are read wait for the next turn: an earlier one
        may have arrived at a socket that was read already.
        """
        if len(self.all) == 1 and not self._held:
            return self.datagrams(self.all[0], most)
        now, arrived = time.time_ns(), self._held
        # what was held once waits no longer: a clock that was set back may need hours
        until = max(now, _TIME(arrived[-1])) if arrived else now
        is_full = False
        for one in self.ready(0.0):
            found = list(self.datagrams(one, most))
            if self.is_observer:
                sizes = map(len, map(_DATA, found))
                self._freed[one] += _MOST_OVERHEAD * len(found) + _MOST_GROWTH * sum(sizes)
            if len(found) >= most:
                until, is_full = min(until, _TIME(found[-1])), True
            arrived += found
        if self.since and not self.is_observer:
            arrived = [*dict.fromkeys(arrived)]
        arrived.sort(key=_TIME)
        first = bisect_left(arrived, self.since, key=_TIME) if self.is_observer else 0
        last = bisect_right(arrived, until, key=_TIME)
        self._held = arrived[last:]
        if not is_full:  # nothing older is left; the clock may be set back later
            self.since = 0
        return arrived[first:last]

    def datagrams(self, receiver: socket.socket, most: int) -> Iterable[Datagram]:
        """Read the datagrams that have arrived at a socket, about ``most`` at most."""
        if self.is_stream:
            self.prepare(receiver)
        if batch := self._batches.get(receiver):
            try:
                return batch.receive(most)
            except OSError:  # a sandbox without this call
                self._batches[receiver] = None
        return one_by_one(receiver, most)

    def prepare(self, receiver: socket.socket) -> None:
        """Prepare to read many short messages from a socket with one call."""
        # a batch of large ones fits no cache
        if receiver in self._batches or receiver not in self.short or not self.has_times:
            return
        from lcmtools.bus import datagram_batch  # late: most commands end before they need it

        self._batches[receiver] = datagram_batch.batch_of(receiver)

    def make_room(self, message_bytes: int) -> None:
        """Make room for messages of this size, as far as the system grants sockets and filters.

        Sockets that are no longer needed are kept.
        """
        if message_bytes <= self._message_bytes:
            return
        self._message_bytes = message_bytes
        fragments, shares = -(-message_bytes // FRAGMENT_MAX), 1
        while shares * self._room < self.largest_together * fragments and shares < _MOST_SHARES:
            shares *= 2
        if self._is_divisible and shares > self.shares and (shares > 1 or self.is_observer):
            self._is_divisible = self._divide(shares)
        self.has_room = max(1, self.shares) * self._room >= _NEEDED * fragments

    def short_program(self, share: int, shares: int) -> FilterProgram:
        """Return the filter of a socket for short messages, beside others for fragments."""
        return short_only(share, shares)

    def fragment_program(self, share: int, shares: int) -> FilterProgram:
        """Return the filter of a socket for fragments."""
        return wanted(everything, shorts=False, share=(share, shares))

    def _divide(self, shares: int) -> bool:
        """Divide the fragments into shares; the first time, also the short messages.

        Without a filter, each socket would receive everything: if the system refuses one, a single
        socket is left, and the result is False.
        """
        shorts = _SHORT_SHARES if self.is_observer and self.granted < _SMALL else 1
        with suppress(BusError):  # no more sockets are permitted
            while len(self.all) < shorts + shares:  # new ones receive nothing yet
                receiver = receiving_socket(self._url, nothing())
                self.all.append(receiver)
                self._poll.register(receiver, select.POLLIN)
        is_first = not self.shares
        if len(self.all) == shorts + shares:
            self.short, self.shares = self.all[:shorts], shares
            if self._attach_to_fragments() and (not is_first or self._attach_to_shorts()):
                if is_first:
                    self.since = time.time_ns()
                return True
        self._unite()
        return False

    def _unite(self) -> None:
        """Receive everything with the first socket again."""
        for receiver in self.all[1:]:
            self._poll.unregister(receiver)
            self._batches.pop(receiver, None)
            receiver.close()
        del self.all[1:]
        self.short, self.shares, self.since = self.all[:], 0, 0
        self._attach_to_shorts()

    def _attach_to_fragments(self) -> bool:
        # in this order fragments may come twice, but never a whole message
        shares = reversed([*enumerate(self.all[len(self.short) :])])
        return all(self._attach(r, self.fragment_program(s, self.shares)) for s, r in shares)

    def _attach_to_shorts(self) -> bool:
        shares = [*enumerate(self.short)]
        return all(self._attach(r, self.short_program(s, len(shares))) for s, r in shares)

    def _attach(self, receiver: socket.socket, program: FilterProgram) -> bool:
        whole = but_from(self.own_port, program) if self.own_port else program
        is_filtered = attach(receiver, whole)
        mark(receiver, self.mark if is_filtered else ANNOUNCED)
        if not is_filtered and self.shares:  # each of several receives everything until it has one
            self.since = time.time_ns()
        return is_filtered


def one_by_one(receiver: socket.socket, most: int) -> Iterator[Datagram]:
    """Yield the datagrams that have arrived at a socket, ``most`` at most."""
    receive, flags = receiver.recvmsg, socket.MSG_DONTWAIT
    with suppress(BlockingIOError):
        for _ in range(most):
            data, ancillary, _, address = receive(MAX_DATAGRAM, ANCILLARY_BYTES, flags)
            yield data, Sender(*address), *arrival(ancillary)
