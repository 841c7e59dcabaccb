"""The tap: a passive observer of a multicast group's datagrams.

It joins the group beside its members and sees every sender, a program without lcmtools too. It
decodes nothing, and no datagram makes it fail.

By default it takes the heads of large messages only: their first datagram has channel, type, size
and number, and on Linux a filter in the kernel drops the others, so that a bus full of images costs
next to nothing to watch.
"""

import contextlib
import socket
import time
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import itemgetter
from typing import TYPE_CHECKING

from lcmtools.bus.kernel import ANCILLARY_BYTES, arrival, attach, dropped
from lcmtools.bus.multicast import check_multicast, sending_socket
from lcmtools.bus.receivers import Receivers
from lcmtools.bus.socket_filter import heads_only
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as
from lcmtools.names import check_length
from lcmtools.wire.datagram import datagrams
from lcmtools.wire.packet import Datagram, Packet, Sender
from lcmtools.wire.reader import PROTOCOL_PREFIX, Reader
from lcmtools.wire.sequence import Sequence

if TYPE_CHECKING:
    from lcmtools.bus.channel_socket import ChannelSocket
    from lcmtools.bus.datagram_batch import DatagramBatch

_MAX_DATAGRAM = 65536
_BATCH = 2048  # datagrams taken in one turn
_STREAM, _STREAM_GAP, _NAP = 8, 0.005, 0.01
"""After so many turns that waited for less than so many seconds, a turn begins with a nap [s]."""
_OF_A_NAP = _BATCH // 2  # messages that may come meanwhile
_FILLED, _LITTLE = 0.5, 0.01  # the part of the kernel's buffer that they may take; a small part
LONG_NAP = 0.1  # a nap of who counts messages [s]: the kernel notes their times
_DEAF_NAP = 0.04  # [s]: longer ones end with a request of who looks for nodes, and waits 0.05 s

_AT_FIRST = 1_000_000  # bytes of a large message for which there is room before the first one comes
_TIME: Callable[[Datagram], int] = itemgetter(2)


class Tap(contextlib.AbstractContextManager["Tap"]):
    """An observer of one multicast group.

    Args:
        url: The bus.
        whole: Put large messages together; else their heads come (``Packet.whole_bytes``).
        in_kernel: Let the kernel drop other fragments, where it can; the results are the same
            without.
        always_whole: Channels that begin so come whole nevertheless.
        spread: Receive with several sockets where large messages would not fit into the buffer of
            one (see ``Receivers``); for who wants all of them.

    Attributes:
        longest_nap: The time [s] that messages of a stream may wait, to be read together.
        malformed, sequences, ttls: As of ``Reader``.

    Raises:
        BusError: Multicast does not work here, with what to type.
    """

    is_live, is_log, is_awaiting, has_strangers = True, False, False, False

    def __init__(
        self,
        url: BusUrl,
        *,
        whole: bool = False,
        in_kernel: bool = True,
        always_whole: tuple[str, ...] = (),
        spread: bool = False,
    ) -> None:
        check_multicast(url)
        self._address = (url.host, url.port)
        self._receivers = Receivers(url)
        self._is_spread = spread
        if spread:
            self._receivers.make_room(_AT_FIRST)
        self._sender = sending_socket(url)
        self._seqno = 0
        self.longest_nap = 0.0 if whole else _NAP
        self._nap = _NAP
        self._wants_whole = whole or bool(always_whole)
        self._passing = 0  # bytes of the messages of which the filter lets all fragments pass
        first = self._receivers.sockets[0]
        self._filtered = not whole and in_kernel and attach(first, heads_only())
        self._reader = Reader(whole=whole, always_whole=(PROTOCOL_PREFIX, *always_whole))
        self.malformed: Mapping[Sender, str] = self._reader.malformed
        self.sequences: Mapping[Sender, Sequence] = self._reader.sequences
        self.ttls: Mapping[Sender, int] = self._reader.ttls
        self._buffer = memoryview(bytearray(_MAX_DATAGRAM))
        self._batches: dict[socket.socket, DatagramBatch] = {}
        self._turns = 0
        self._url = url
        self._requests: ChannelSocket | None = None
        self._held: list[Datagram] = []

    def __exit__(self, *_: object) -> None:
        """Leave the group."""
        self.close()

    def close(self) -> None:
        """Leave the group."""
        self._receivers.close()
        self._sender.close()
        if self._requests:
            self._requests.close()

    @property
    def port(self) -> int:
        """The UDP port that ``send`` sends from; 0 before the first."""
        return int(self._sender.getsockname()[1])

    @property
    def numbered(self) -> dict[Sender, Sequence]:
        """The sequences that show loss: not those of ports that several programs share.

        Programs in Java do, and their numbers are mixed.
        """
        return {
            sender: sequence
            for sender, sequence in tuple(self.sequences.items())  # one may be added meanwhile
            if sender.port != self._address[1] and not sequence.is_shared
        }

    def want_whole(self, channels: tuple[str, ...]) -> None:
        """Let the large messages of other channels come whole, as ``always_whole``."""
        self._reader.want_whole((PROTOCOL_PREFIX, *channels))

    def bind(self) -> None:
        """Take the port that ``send`` sends from now, before the first message."""
        self._sender.bind(("", 0))

    def drops(self) -> int | None:
        """Return the number of datagrams lost here because they were not read fast enough.

        None where it is unknown, or counts those that the filter drops.
        """
        sockets = self._receivers.sockets
        return None if self._filtered or len(sockets) > 1 else dropped(sockets[0])

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message, as an LCM instance of its own.

        Raises:
            BusError: The system does not send it.
            InvalidName: LCM cannot carry this channel name.
        """
        check_length(channel)
        self._seqno += 1
        with os_errors_as(f"cannot send to {self._address[0]}", kind=BusError):
            for datagram in datagrams(self._seqno, channel, payload):
                self._sender.sendto(datagram, self._address)

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first."""
        timeout = max(0.0, timeout)
        # waking up for each message costs more than reading it
        packets = self._read_after_nap(timeout) if self._is_streaming() else []
        if not packets:
            start = time.monotonic()
            has_any = bool(self._receivers.ready(0.0 if self._held else timeout))
            is_soon = time.monotonic() - start < _STREAM_GAP
            self._turns = self._turns + has_any if is_soon else 0
            packets = self._read() if has_any or self._held else []
        self._attend_large()
        return packets

    def _read_after_nap(self, longest: float) -> list[Packet]:
        self._sleep(min(self._nap, longest))
        packets = self._read()
        if packets:
            much = max(len(packets) / _OF_A_NAP, self._receivers.filled_by(packets) / _FILLED)
            self._nap = min(self.longest_nap, self._nap / max(much, _LITTLE))
        return packets

    def _sleep(self, seconds: float) -> None:
        """Take a nap; a long one ends when somebody requests nodes to announce themselves."""
        if seconds > _DEAF_NAP and self._requests is None:
            from lcmtools.bus.channel_socket import ChannelSocket
            from lcmtools.graph.protocol import PROBE_CHANNEL

            try:
                self._requests = ChannelSocket(self._url, PROBE_CHANNEL)
            except BusError:  # this system has no filters
                self.longest_nap = seconds = _DEAF_NAP
        if self._requests is None:
            time.sleep(seconds)
        elif self._requests.wait(seconds):
            self._requests.take()  # the request comes to the tap's own socket, too

    def _read(self) -> list[Packet]:
        """Return what has arrived, from several sockets in the order of its arrival.

        What arrives while they are read stays for the next turn: before it, something may have
        come to a socket that was read already.
        """
        receivers = self._receivers
        if len(receivers.sockets) == 1:
            return self._reader.read_all(self._datagrams(receivers.sockets[0]))
        now, arrived = time.time_ns(), self._held
        until = now
        for one in receivers.ready(0.0):
            found = list(self._datagrams(one))
            if len(found) >= _BATCH:
                until = min(until, _TIME(found[-1]))
            arrived += found
        arrived.sort(key=_TIME)
        first = bisect_left(arrived, receivers.since, key=_TIME)
        last = bisect_right(arrived, until, key=_TIME)
        self._held = arrived[last:]
        if until == now:  # nothing of before is left; the clock may be set back later
            receivers.since = 0
        return self._reader.read_all(arrived[first:last])

    def _attend_large(self) -> None:
        """Let the next large messages, as large as those that came, pass and have room."""
        needed = self._reader.largest_whole
        if self._filtered and needed > self._passing:
            self._passing = needed
            self._filtered = attach(self._receivers.sockets[0], heads_only(but_up_to=needed))
        if self._is_spread:
            self._receivers.make_room(needed)

    def _datagrams(self, receiver: socket.socket) -> Iterable[Datagram]:
        """Take what has arrived."""
        batch = self._batches.get(receiver)
        is_short = receiver in self._receivers.short  # large ones fit no cache together
        if is_short and not batch and self._turns >= _STREAM and self._receivers.has_times:
            from lcmtools.bus import datagram_batch  # most commands end before they need it

            if datagram_batch.IS_POSSIBLE:
                batch = self._batches[receiver] = datagram_batch.DatagramBatch(receiver)
        return batch.take(_BATCH) if batch else self._one_by_one(receiver)

    def _one_by_one(self, receiver: socket.socket) -> Iterator[Datagram]:
        receive, buffer = receiver.recvmsg_into, self._buffer
        with contextlib.suppress(BlockingIOError):
            for _ in range(_BATCH):
                size, ancillary, _, address = receive([buffer], ANCILLARY_BYTES)
                yield bytes(buffer[:size]), Sender(*address), *arrival(ancillary)

    def _is_streaming(self) -> bool:
        """Return whether turns follow each other at once, so that a nap pays.

        Never with large messages that are wanted whole and would fill the kernel's buffer, nor
        where a message's receive time is that of its reading.
        """
        receivers = self._receivers
        is_tight = self._wants_whole and self._reader.largest_whole > 0 and not receivers.has_room
        is_useful = self.longest_nap and receivers.has_times and not is_tight
        return self._turns >= _STREAM and bool(is_useful)
