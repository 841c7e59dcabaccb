"""The tap: a passive observer of a multicast group's datagrams.

It joins the group like its members and sees every sender, including programs without lcmtools. It
decodes nothing, and no datagram makes it fail.

By default it reads only the heads of large messages: the first datagram has channel, type, size and
number, and on Linux a filter in the kernel drops the others, so that watching a bus full of images
costs almost nothing.
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
from lcmtools.bus.observer_sockets import ObserverSockets
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
_BATCH = 2048  # datagrams read in one turn
_STREAM, _STREAM_GAP, _NAP = 8, 0.005, 0.01
"""After this many turns that waited less than this time [s], turns begin with a nap [s]."""
_OF_A_NAP = _BATCH // 2  # messages that may come during a nap
_FILLED, _LITTLE = 0.5, 0.01  # part of the kernel's buffer that they may fill; the least counted
LONG_NAP = 0.1  # a nap for counting messages [s]: the kernel notes their times
_DEAF_NAP = 0.04  # [s]: a longer nap ends with a probe, whose sender waits 0.05 s for nodes

_AT_FIRST = 1_000_000  # bytes of a large message that has room even before the first one comes
_TIME: Callable[[Datagram], int] = itemgetter(2)


class Tap(contextlib.AbstractContextManager["Tap"]):
    """An observer of one multicast group.

    Args:
        url: The bus.
        whole: Assemble large messages; else only their heads are read (``Packet.whole_bytes``).
        always_whole: Prefixes of channels whose messages are assembled anyway.
        spread: Receive with several sockets if large messages would not fit into the buffer of one
            (see ``ObserverSockets``); for observers that need all of them.

    Attributes:
        longest_nap: The time [s] that messages of a stream may wait, to be read together.
        malformed, sequences, ttls: As in ``Reader``.

    Raises:
        BusError: Multicast does not work here; the error says what to type.
    """

    is_live, is_log, is_awaiting, has_strangers = True, False, False, False

    def __init__(
        self,
        url: BusUrl,
        *,
        whole: bool = False,
        always_whole: tuple[str, ...] = (),
        spread: bool = False,
    ) -> None:
        check_multicast(url)
        self._address = (url.host, url.port)
        self._sockets = ObserverSockets(url)
        self._is_spread = spread
        if spread:
            self._sockets.make_room(_AT_FIRST)
        self._sender = sending_socket(url)
        self._seqno = 0
        self.longest_nap = 0.0 if whole else _NAP
        self._nap = _NAP
        self._wants_whole = whole or bool(always_whole)
        self._passing = 0  # size of messages up to which the filter lets all fragments pass [byte]
        first = self._sockets.all[0]
        self._filtered = not whole and attach(first, heads_only())
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
        self._sockets.close()
        self._sender.close()
        if self._requests:
            self._requests.close()

    @property
    def port(self) -> int:
        """The UDP port that ``send`` sends from; 0 before the first message."""
        return int(self._sender.getsockname()[1])

    @property
    def numbered(self) -> dict[Sender, Sequence]:
        """The sequences that show losses; not those of ports that several programs share.

        Programs in Java share ports, and their numbers are mixed.
        """
        known = tuple(self.sequences.items())  # may grow meanwhile
        return {s: one for s, one in known if s.port != self._address[1] and not one.is_shared}

    def want_whole(self, channels: tuple[str, ...]) -> None:
        """Assemble the large messages of these channels instead, as ``always_whole``."""
        self._reader.want_whole((PROTOCOL_PREFIX, *channels))

    def bind(self) -> None:
        """Bind the port that ``send`` sends from, before the first message."""
        self._sender.bind(("", 0))

    def drops(self) -> int | None:
        """Return the number of datagrams lost here because they were not read fast enough.

        None if it is unknown, or includes datagrams that the filter drops.
        """
        sockets = self._sockets.all
        return None if self._filtered or len(sockets) > 1 else dropped(sockets[0])

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message, like a separate LCM instance.

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
            has_any = bool(self._sockets.ready(0.0 if self._held else timeout))
            is_soon = time.monotonic() - start < _STREAM_GAP
            self._turns = self._turns + has_any if is_soon else 0
            packets = self._read() if has_any or self._held else []
        self._attend_large()
        return packets

    def _read_after_nap(self, longest: float) -> list[Packet]:
        self._sleep(min(self._nap, longest))
        packets = self._read()
        if packets:
            much = max(len(packets) / _OF_A_NAP, self._sockets.filled_by(packets) / _FILLED)
            self._nap = min(self.longest_nap, self._nap / max(much, _LITTLE))
        return packets

    def _sleep(self, seconds: float) -> None:
        """Take a nap; a long one ends when a program requests nodes to announce themselves."""
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
            self._requests.receive()  # the request also arrives at the tap's own socket

    def _read(self) -> list[Packet]:
        """Return what has arrived; from several sockets, in order of arrival.

        Datagrams that arrive while sockets are read wait for the next turn: an earlier one may have
        arrived at a socket that was read already.
        """
        sockets = self._sockets
        if len(sockets.all) == 1:
            return self._reader.read_all(self._datagrams(sockets.all[0]))
        now, arrived = time.time_ns(), self._held
        until = now
        for one in sockets.ready(0.0):
            found = list(self._datagrams(one))
            if len(found) >= _BATCH:
                until = min(until, _TIME(found[-1]))
            arrived += found
        arrived.sort(key=_TIME)
        first = bisect_left(arrived, sockets.since, key=_TIME)
        last = bisect_right(arrived, until, key=_TIME)
        self._held = arrived[last:]
        if until == now:  # nothing older is left; the clock may be set back later
            sockets.since = 0
        return self._reader.read_all(arrived[first:last])

    def _attend_large(self) -> None:
        """Let further messages as large as the largest so far pass the filter, and make room."""
        needed = self._reader.largest_whole
        if self._filtered and needed > self._passing:
            self._passing = needed
            self._filtered = attach(self._sockets.all[0], heads_only(but_up_to=needed))
        if self._is_spread:
            self._sockets.make_room(needed)

    def _datagrams(self, receiver: socket.socket) -> Iterable[Datagram]:
        """Read the datagrams that have arrived."""
        batch = self._batches.get(receiver)
        is_short = receiver in self._sockets.short  # a batch of large ones fits no cache
        if is_short and not batch and self._turns >= _STREAM and self._sockets.has_times:
            from lcmtools.bus import datagram_batch  # late: most commands end before they need it

            if datagram_batch.IS_POSSIBLE:
                batch = self._batches[receiver] = datagram_batch.DatagramBatch(receiver)
        return batch.receive(_BATCH) if batch else self._one_by_one(receiver)

    def _one_by_one(self, receiver: socket.socket) -> Iterator[Datagram]:
        receive, buffer = receiver.recvmsg_into, self._buffer
        with contextlib.suppress(BlockingIOError):
            for _ in range(_BATCH):
                size, ancillary, _, address = receive([buffer], ANCILLARY_BYTES)
                yield bytes(buffer[:size]), Sender(*address), *arrival(ancillary)

    def _is_streaming(self) -> bool:
        """Return whether turns follow each other so closely that a nap pays.

        Never if large messages are assembled and would fill the kernel's buffer, or if a message's
        receive time is the time of reading it.
        """
        sockets = self._sockets
        is_tight = self._wants_whole and self._reader.largest_whole > 0 and not sockets.has_room
        is_useful = self.longest_nap and sockets.has_times and not is_tight
        return self._turns >= _STREAM and bool(is_useful)
