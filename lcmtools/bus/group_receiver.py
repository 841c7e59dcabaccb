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
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import suppress
from operator import itemgetter
from typing import TYPE_CHECKING

from lcmtools.bus.kernel import (
    ANCILLARY_BYTES,
    ANNOUNCED,
    IS_LINUX,
    SELECTIVE,
    SUBSCRIBED,
    UNFILTERED,
    arrival,
    attach,
    buffer,
    detach,
    mark,
    request_arrival,
)
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.socket_filter import (
    ENDING_BYTES,
    ChannelTest,
    FilterProgram,
    but_from,
    everything,
    heads_only,
    large_only,
    nothing,
    short_only,
    these_channels,
    these_endings,
    wanted,
)
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import FRAGMENT_MAX, MalformedDatagram, ShortMessage, parse
from lcmtools.wire.packet import Datagram, Sender
from lcmtools.wire.reassembly import UnwantedMessages

if TYPE_CHECKING:
    from lcmtools.bus.datagram_batch import DatagramBatch

MAX_DATAGRAM = 65536  # bytes
_FRAGMENT_ROOM = 70_000  # bytes of a buffer that a whole fragment takes, with the kernel's overhead
_MOST_SHARES = 8
_MOST_AT_ONCE = 4096  # messages of one channel: a flood must not keep the reader busy
_SHORT_SHARES, _SMALL = 4, 1 << 20  # sockets for short messages if a buffer has fewer bytes
_MOST_COMPARED = 50  # channels, or endings of their names, that a filter compares with
_OBSERVERS_LARGEST, _NODES_LARGEST = 32, 3
"""Number of the largest messages for which there should be room, in observers and in nodes."""
_NEEDED = 2  # largest messages for which there must be room
_MOST_OVERHEAD, _MOST_GROWTH = 900, 2
"""The most that a datagram takes of a buffer: bytes, and the factor of its size."""
_DATA: Callable[[Datagram], bytes] = itemgetter(0)
_TIME: Callable[[Datagram], int] = itemgetter(2)


class GroupReceiver:
    """The sockets of one receiver of a group, initially one.

    Without ``channels`` it is an observer, which receives all channels: then short messages are
    divided too, and fragments always have sockets of their own. What comes while its sockets are
    divided may come twice, and what came before not at all: it is left out.

    Args:
        url: The bus.
        channels: Only these pass, and if they are many, some others; on Linux, where the filter
            drops the rest in the kernel. Without it, the receiving thread would wake for each
            datagram of the bus: for a node that sends at a high rate, a third of the cost.
        heads: Of messages in several fragments, only the first fragment passes.
        own_port: If not 0, nothing that this computer sends from this port passes a filter.

    Attributes:
        all: The sockets.
        short: Those for short messages, at first the one for all.
        since: The time of dividing the sockets [ns], 0 if nothing from before is left.
        is_filtered: True if the system drops what is not wanted.
        held: Datagrams that were read, and that ``read`` has not returned yet.
        has_times: True if the system gives each datagram's receive time.
        is_stream: Set to read many short messages with one call from now on.
        has_room: True if two messages as large as the largest so far fit into the buffers together.
        unwanted: Large messages that are received without being wanted.
    """

    def __init__(  # noqa: PLR0915 - its attributes
        self,
        url: BusUrl,
        channels: Collection[str] | None = None,
        *,
        heads: bool = False,
        own_port: int = 0,
    ) -> None:
        self._url, self._heads, self._own_port = url, heads, own_port
        self._is_observer = channels is None
        self._largest = _OBSERVERS_LARGEST if channels is None else _NODES_LARGEST
        self._tests: dict[ChannelTest, Collection[bytes]] = {everything: ()}
        """The tests of channels, the strictest first, and the endings that each compares."""
        self._test: ChannelTest = everything  # the one that is used
        self._endings: Collection[bytes] = ()
        self._up_to = 0  # bytes of messages of which all fragments pass although ``heads``
        self.unwanted = UnwantedMessages()
        self.shares = self._message_bytes = 0
        self._is_divisible = IS_LINUX and not heads
        self.since = 0
        self.all = [receiving_socket(url, None if channels is None else nothing())]
        self.has_times = request_arrival(self.all[0], ttl=self._is_observer)
        self.granted = self.all[0].getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        self._room = max(1, self.granted // _FRAGMENT_ROOM)  # fragments in a socket's buffer
        self.short = self.all[:]
        self.overflows = 0  # as of ``count_overflows``
        self._dropped: dict[socket.socket, int] = {}  # when they were looked at last
        self._freed: Counter[socket.socket] = Counter()  # bytes of their buffers since then
        self.held: list[Datagram] = []
        self._batches: dict[socket.socket, DatagramBatch | None] = {}
        self.is_stream = self.has_room = self.is_filtered = False
        self._poll = select.poll()
        for descriptor in (self.all[0].fileno(), *network_watch.descriptors):
            self._poll.register(descriptor, select.POLLIN)
        if channels:
            self.let_pass(channels)
        elif heads:
            self.is_filtered = self._attach_to_shorts()
        else:
            mark(self.all[0], ANNOUNCED)

    @property
    def _filtered_mark(self) -> int:
        if self._is_observer:
            return ANNOUNCED if self._heads else SELECTIVE
        return SELECTIVE if self._heads else SUBSCRIBED

    @property
    def is_strict(self) -> bool:
        """True if nothing but the given channels passes."""
        return self.is_filtered and self._test is next(iter(self._tests))

    def passes(self, channel: str) -> bool:
        """Return whether a channel passes already: a fleet has thousands with the same ending."""
        return _ending(channel) in self._endings

    def let_pass(self, channels: Collection[str]) -> None:
        """Let only these channels pass; if they are many, also some others."""
        self._tests = {}
        endings = {_ending(channel) for channel in channels}
        if len(channels) <= _MOST_COMPARED:
            self._tests[these_channels(channels)] = ()
        if len(endings) <= _MOST_COMPARED and all(len(one) == ENDING_BYTES for one in endings):
            self._tests[these_endings(endings)] = endings
        self._tests[everything] = ()
        self.unwanted.clear()
        self.attach_filters()

    def attach_filters(self) -> None:
        """Drop what is unwanted now, with the strictest filter for which the system has memory."""
        for test, endings in self._tests.items():
            self._test, self._endings = test, endings
            if (not self.shares or self._attach_to_fragments()) and self._attach_to_shorts():
                self.is_filtered = True
                if test is everything and len(self._tests) > 1:
                    for one in self.all:
                        mark(one, UNFILTERED)
                return
        self.is_filtered = False
        if self.shares:
            self._unite()

    def want(self, port: int, message_bytes: int) -> None:
        """Receive large messages of this size that are sent from this port."""
        if self.unwanted.want(port):
            self.attach_filters()
        self.make_room(message_bytes)

    def note_unwanted(self, port: int, message_bytes: int, now: int) -> None:
        """Count a fragment of a message that is not wanted [ns]; drop them if they are many."""
        if self.unwanted.note(port, message_bytes, now):
            self.attach_filters()

    def pass_large(self, up_to: int) -> None:
        """Let nothing but fragments pass, of messages up to a size [byte]."""
        self.is_filtered = self._attach(self.all[0], large_only(up_to))

    def pass_whole(self, up_to: int) -> None:
        """Let messages of up to this size [byte] pass whole although ``heads``."""
        if self._heads and self.is_filtered and up_to > self._up_to:
            self._up_to = up_to
            self.is_filtered = self._attach_to_shorts()

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
        """Wait up to ``timeout`` [s] for a datagram; return the sockets that have one.

        Returns early if the network has changed.
        """
        found = {number for number, _ in self._poll.poll(timeout * 1000)}
        return [one for one in self.all if one.fileno() in found] if found else []

    def read(self, most: int) -> Iterable[Datagram]:
        """Return what has arrived, about ``most`` datagrams of each socket, in order of arrival.

        Datagrams that arrive while several sockets are read wait for the next turn: an earlier one
        may have arrived at a socket that was read already.
        """
        if len(self.all) == 1 and not self.held:
            return self.datagrams(self.all[0], most)
        now, arrived = time.time_ns(), self.held
        # what was held once waits no longer: a clock that was set back may need hours
        until = max(now, _TIME(arrived[-1])) if arrived else now
        is_full = False
        for one in self.ready(0.0):
            found = list(self.datagrams(one, most))
            if self._is_observer:
                sizes = map(len, map(_DATA, found))
                self._freed[one] += _MOST_OVERHEAD * len(found) + _MOST_GROWTH * sum(sizes)
            if len(found) >= most:
                until, is_full = min(until, _TIME(found[-1])), True
            arrived += found
        if self.since and not self._is_observer:
            arrived = [*dict.fromkeys(arrived)]
        arrived.sort(key=_TIME)
        first = bisect_left(arrived, self.since, key=_TIME) if self._is_observer else 0
        last = bisect_right(arrived, until, key=_TIME)
        self.held = arrived[last:]
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
        while shares * self._room < self._largest * fragments and shares < _MOST_SHARES:
            shares *= 2
        if self._is_divisible and shares > self.shares and (shares > 1 or self._is_observer):
            self._is_divisible = self._divide(shares)
        self.has_room = max(1, self.shares) * self._room >= _NEEDED * fragments

    def _short_program(self, share: int, shares: int) -> FilterProgram:
        """Return the filter of a socket for short messages; at first also for fragments."""
        if self._is_observer:
            return heads_only(self._up_to) if self._heads else short_only(share, shares)
        fragments = None if self.shares else (0, 1)
        denied = self.unwanted.denied
        return wanted(self._test, denied, share=fragments, heads=self._heads)

    def _fragment_program(self, share: int, shares: int) -> FilterProgram:
        """Return the filter of a socket for fragments."""
        return wanted(self._test, self.unwanted.denied, shorts=False, share=(share, shares))

    def _divide(self, shares: int) -> bool:
        """Divide the fragments into shares; the first time, also the short messages.

        Without a filter, each socket would receive everything: if the system refuses one, a single
        socket is left, and the result is False.
        """
        shorts = _SHORT_SHARES if self._is_observer and self.granted < _SMALL else 1
        with suppress(BusError):  # no more sockets are permitted
            while len(self.all) < shorts + shares:  # new ones receive nothing yet
                receiver = receiving_socket(self._url, nothing())
                request_arrival(receiver, ttl=self._is_observer)
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
        if self._is_observer:
            detach(self.all[0])
        else:
            self._attach_to_shorts()

    def _attach_to_fragments(self) -> bool:
        # in this order fragments may come twice, but never a whole message
        shares = reversed([*enumerate(self.all[len(self.short) :])])
        return all(self._attach(r, self._fragment_program(s, self.shares)) for s, r in shares)

    def _attach_to_shorts(self) -> bool:
        shares = [*enumerate(self.short)]
        return all(self._attach(r, self._short_program(s, len(shares))) for s, r in shares)

    def _attach(self, receiver: socket.socket, program: FilterProgram) -> bool:
        whole = but_from(self._own_port, program) if self._own_port else program
        is_filtered = attach(receiver, whole)
        mark(receiver, self._filtered_mark if is_filtered else UNFILTERED)
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


class ChannelSocket:
    """A socket that receives one channel, whose messages wait in the kernel until they are read.

    Waking up for each message costs far more than reading many at once. Meant for small messages
    that may be read a little later, by one thread at a time: if the socket's buffer fills up
    between two reads, the newest are lost.

    Attributes:
        has_large: True once a message came in several fragments, which are not received here.

    Raises:
        BusError: The group cannot be joined, or this system has no such filter.
    """

    def __init__(self, url: BusUrl, channel: str) -> None:
        self._channel = channel
        self.has_large = False
        self._receiver = GroupReceiver(url, [channel], heads=True)
        if not self._receiver.is_strict:
            self.close()
            raise BusError("this system cannot filter datagrams")

    def receive(self) -> list[tuple[bytes, int]]:
        """Return waiting payloads with their receive times [ns since 1970]; never blocks."""
        received: list[tuple[bytes, int]] = []
        with suppress(OSError):
            for data, _, arrived, _ in self._receiver.read(_MOST_AT_ONCE):
                found = parse(data)
                # compared again: datagrams from before the filter was attached may be any
                if isinstance(found, MalformedDatagram) or found.channel != self._channel:
                    continue
                if isinstance(found, ShortMessage):
                    received.append((found.payload, arrived))
                else:
                    self.has_large = True
        return received

    def wait(self, seconds: float) -> bool:
        """Wait for a message, ``seconds`` at most; return False if none came."""
        return bool(self._receiver.ready(seconds))

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()


def _ending(channel: str) -> bytes:
    return channel.encode()[-ENDING_BYTES:]
