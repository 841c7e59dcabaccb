"""The tap: a passive observer of a multicast group's datagrams.

It joins the group beside its members and sees every sender, a program without lcmtools too. It
decodes nothing, and no datagram makes it fail.

By default it takes the heads of large messages only: their first datagram has channel, type, size
and number, and on Linux a filter in the kernel drops the others, so that a bus full of images costs
next to nothing to watch.
"""

import contextlib
import select
import time
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from lcmtools.bus.kernel import ANCILLARY_BYTES, arrival, attach, dropped, request_arrival
from lcmtools.bus.multicast import (
    SELF_TEST_CHANNEL,
    check_multicast,
    receiving_socket,
    sending_socket,
)
from lcmtools.bus.socket_filter import heads_only
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as
from lcmtools.names import check_length
from lcmtools.wire.datagram import datagrams
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.reader import PROTOCOL_PREFIX, Reader
from lcmtools.wire.sequence import Sequence

if TYPE_CHECKING:
    from lcmtools.bus.datagram_batch import DatagramBatch

_MAX_DATAGRAM = 65536
_BATCH = 256  # datagrams taken in one turn
_STREAM, _STREAM_GAP, _NAP = 8, 0.005, 0.01
"""After so many turns that waited for less than so many seconds, a turn begins with a nap [s]."""
_OF_A_NAP = 128
"""Messages that may come meanwhile: half of what a usual buffer holds of small ones."""


class Tap(contextlib.AbstractContextManager["Tap"]):
    """An observer of one multicast group.

    Args:
        url: The bus.
        whole: Put large messages together; else their heads come (``Packet.whole_bytes``).
        in_kernel: Let the kernel drop other fragments, where it can; the results are the same
            without.
        always_whole: Channels that begin so come whole nevertheless.

    Attributes:
        longest_nap: The time [s] that messages of a stream may wait, to be read together.
        malformed, sequences, ttls: As of ``Reader``.

    Raises:
        BusError: Multicast does not work here, with what to type.
    """

    is_live, is_log = True, False

    def __init__(
        self,
        url: BusUrl,
        *,
        whole: bool = False,
        in_kernel: bool = True,
        always_whole: tuple[str, ...] = (),
    ) -> None:
        check_multicast(url)
        self._address = (url.host, url.port)
        self._receiver = receiving_socket(url)
        self._receiver.settimeout(0.0)
        self._sender = sending_socket(url)
        self._seqno = 0
        self.longest_nap = 0.0 if whole else _NAP
        self._nap = _NAP
        self._wants_whole = whole or bool(always_whole)
        self._passing = 0  # bytes of the messages of which the filter lets all fragments pass
        self._filtered = not whole and in_kernel and attach(self._receiver, heads_only())
        self._reader = Reader(whole=whole, always_whole=(PROTOCOL_PREFIX, *always_whole))
        self.malformed: Mapping[Sender, str] = self._reader.malformed
        self.sequences: Mapping[Sender, Sequence] = self._reader.sequences
        self.ttls: Mapping[Sender, int] = self._reader.ttls
        self._buffer = memoryview(bytearray(_MAX_DATAGRAM))
        self._batch: DatagramBatch | None = None
        self._turns = 0
        self._has_times = request_arrival(self._receiver)

    def __exit__(self, *_: object) -> None:
        """Leave the group."""
        self.close()

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()
        self._sender.close()

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
            for sender, sequence in self.sequences.items()
            if sender.port != self._address[1] and not sequence.is_shared
        }

    def drops(self) -> int | None:
        """Return the number of datagrams lost here because they were not read fast enough.

        None where it is unknown, or counts those that the filter drops.
        """
        return None if self._filtered else dropped(self._receiver)

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
        is_streaming = self._is_streaming()
        if is_streaming:  # waking up for each message costs more than reading it
            time.sleep(min(self._nap, timeout))
        start = time.monotonic()
        has_any = bool(select.select([self._receiver], [], [], timeout)[0])
        is_soon = time.monotonic() - start < _STREAM_GAP
        self._turns = self._turns + has_any if is_soon else 0
        if not has_any:
            return []
        packets: list[Packet] = []
        read = self._reader.read
        for data, sender, received, ttl in self._datagrams():
            packet = read(data, sender, received, ttl)
            if packet is not None:
                packets.append(packet)
                if packet.channel == SELF_TEST_CHANNEL:  # it stays here even if others do not
                    self._reader.ttls.pop(sender, None)
        if is_streaming:
            self._nap = min(self.longest_nap, self._nap * _OF_A_NAP / max(1, len(packets)))
        needed = self._reader.largest_whole
        if self._filtered and needed > self._passing:  # for the next messages of their kind
            self._passing = needed
            self._filtered = attach(self._receiver, heads_only(but_up_to=needed))
        return packets

    def _datagrams(self) -> Iterator[tuple[bytes, Sender, int, int | None]]:
        """Take what has arrived: data, sender, time, time to live."""
        if self._batch is None and self._turns >= _STREAM and self._has_times:
            from lcmtools.bus import datagram_batch  # most commands end before they need it

            if datagram_batch.IS_POSSIBLE:
                self._batch = datagram_batch.DatagramBatch(self._receiver)
        if self._batch:
            yield from self._batch.take(_BATCH)
            return
        receive, buffer = self._receiver.recvmsg_into, self._buffer
        with contextlib.suppress(BlockingIOError):
            for _ in range(_BATCH):
                size, ancillary, _, address = receive([buffer], ANCILLARY_BYTES)
                yield bytes(buffer[:size]), Sender(*address), *arrival(ancillary)

    def _is_streaming(self) -> bool:
        """Return whether turns follow each other at once, so that a nap pays.

        Never with large messages, which would fill the kernel's buffer meanwhile, where they are
        wanted whole, nor where a message's receive time is that of its reading.
        """
        has_large = self._wants_whole and self._reader.largest_whole > 0
        is_useful = self.longest_nap and self._has_times and not has_large
        return self._turns >= _STREAM and bool(is_useful)
